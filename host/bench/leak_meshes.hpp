// Closed meshes, and rays from inside at their edges and vertices: a ray that hits nothing has leaked through.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/base/vec.hpp"
#include "host/scene/flat_scene.hpp"
#include "shared/bvh_types.h"

namespace hemiray::bench {

/// The surface of a cube from -1 to 1, each face `cells` x `cells` cells of two triangles, all vertices shared; `round`
/// puts them on the unit sphere. Moved by `offset` [m], rounded once. 12 cells^2 triangles, fronts outward.
FlatScene closed_mesh(std::uint32_t cells, bool round, Vec3 offset);

/// Which points of a mesh rays are aimed at.
enum class LeakTarget { edges, vertices };
std::string to_string(LeakTarget target);

struct LeakMesh {
  std::string name;
  FlatScene flat;
  Vec3 center{0.0F};
  std::uint32_t cells = 1;  ///< of its closed_mesh()
};

inline constexpr std::uint32_t kLeakCells = 144;       ///< 248,832 triangles
inline constexpr std::uint32_t kLeakRays = 1U << 20U;  ///< a mesh and target

/// sphere, sphere moved by 100, box, box moved by 100 (of a cube's 12 cells^2 triangles each).
std::vector<LeakMesh> leak_meshes(std::uint32_t cells = kLeakCells);

/// `count` rays from near the centre (within 0.4 on each axis) at random vertices, or at random points of random edges;
/// their interval is open to infinity. As packets want it, 64 consecutive rays start at one point and are aimed at one
/// patch of a face, of up to 4, 16 or 64 cells on a side.
std::vector<shared::QueryRay> leak_rays(const LeakMesh& mesh, LeakTarget target, std::uint32_t count,
                                        std::uint32_t seed);

/// Rays that hit nothing.
std::size_t count_leaks(std::span<const shared::QueryHit> hits);
std::size_t count_leaks(std::span<const std::uint32_t> occlusions);

}  // namespace hemiray::bench

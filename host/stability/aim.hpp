// Rays aimed where it hurts: at vertices, edges, corners and planes of boxes, give or take a few ulps.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "host/bench/flat_mesh.hpp"
#include "host/scene/flat_scene.hpp"
#include "shared/bvh_types.h"

namespace hemiray::stability {

inline constexpr std::uint32_t kRaysFromOnePoint = 64;  ///< consecutive ones, so that packets trace them together

struct Rays {
  std::vector<shared::QueryRay> rays;
  std::vector<unsigned char> inside;  ///< for each ray: it starts inside a closed mesh, and must meet something
};

/// Makes `count` rays (a multiple of kRaysFromOnePoint), by a seed.
using RayMaker = std::function<Rays(std::uint32_t count, std::uint32_t seed)>;

/// Where rays start: within `least` to `most` [m] of the centre (all around), or with least = 0 in the cube of half
/// side `most` about it.
struct Origins {
  Vec3 center{0.0F};
  float least = 0.0F, most = 1.0F;
  bool inside = false;  ///< of a closed mesh
};

/// x, moved by so many floats.
float moved_by_ulps(float x, int ulps);

/// A direction, evenly distributed, of length about 1.
Vec3 any_direction(bench::Dice& dice);

/// From these origins, one after the other, at the scene's finite triangles, or at those from `first` on. Every fourth
/// group starts in a plane of a box, x, y or z being that of a vertex, and half of its rays stay in it, if the place
/// allows.
RayMaker at_triangles(const FlatScene& flat, std::vector<Origins> origins, std::uint32_t first = 0);

/// At the first half of the triangles, a sheet about `middle`, from the side that `along`, 1 long, points away from:
/// within 45 degrees of it, from 1.5 away. At the inner part, so that rays which go on do not pass the second half, the
/// sheet behind, at its rim.
RayMaker through_first_layer(const FlatScene& flat, DVec3 along, DVec3 middle);

/// A ray without end.
shared::QueryRay make_ray(Vec3 origin, Vec3 direction);

}  // namespace hemiray::stability

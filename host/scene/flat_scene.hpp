// The scene as arrays of the kernels' own structs, in the world: transforms applied, lights collected; but meshes with
// many copies may stay as they are, with instances that place them. Host only.
#pragma once

#include <cstdint>
#include <vector>

#include "host/scene/instancing.hpp"
#include "host/scene/scene.hpp"
#include "shared/scene_types.h"

namespace hemiray {

/// A mesh that instances share: its triangles stand at [first_triangle, + triangle_count).
struct SharedMesh {
  std::uint32_t first_triangle = 0;
  std::uint32_t triangle_count = 0;
};

/// Primitive indices: triangles (of the objects in order, then two for each visible area light), spheres, shapes,
/// planes, and then every instance's triangles, one instance after the other. Triangles of shared meshes, in object
/// space like their vertices, stand behind the world's own; only as parts of instances are they primitives. Object
/// indices: Scene::objects, spheres, shapes, planes, visible area lights, in that order.
struct FlatScene {
  std::vector<float> positions;  ///< 3 a vertex, world [m]
  std::vector<float> normals;    ///< 3 a vertex, world, zero where flat; empty if no mesh has normals
  std::vector<shared::float2> uvs;
  std::vector<float> colors;                    ///< 3 a vertex, linear
  std::vector<shared::uint4> triangles;         ///< vertex indices, material
  std::vector<std::uint32_t> triangle_objects;  ///< of the world's own
  std::vector<shared::Sphere> spheres;
  std::vector<shared::Shape> shapes;
  std::vector<shared::uint4> tapes;  ///< of implicit shapes, one behind the other
  /// Of patches lit by a radiosity solution (host/radiosity/display.hpp), 6 a triangle: irradiance [W/m^2], rgb, at the
  /// three corners of its front, then of its back; else empty.
  std::vector<shared::float4> patch_light;
  /// Rays that look from a hit of a patch for what comes to it, in place of its own patch_light; 0: it is shown itself.
  std::uint32_t gather_rays = 0;
  std::vector<shared::Plane> planes;
  std::vector<shared::Material> materials;
  std::vector<shared::Light> lights;
  std::vector<shared::Emitter> emitters;
  std::vector<shared::Texture> textures;
  std::vector<std::uint32_t> texels;
  std::vector<SharedMesh> shared_meshes;
  std::vector<shared::Instance> instances;  ///< in the order of their objects

  /// Triangles in the world itself.
  [[nodiscard]] std::uint32_t world_triangles() const {
    return shared_meshes.empty() ? static_cast<std::uint32_t>(triangles.size()) : shared_meshes.front().first_triangle;
  }
};

/// Throws DeviceError if the scene has more than 2^30 vertices or triangles, 2^31 primitives counting those of
/// instances, or textures of over 2^32 texels. Whoever reads world triangles himself, or builds a tree that cannot hold
/// instances, leaves instancing off.
FlatScene flatten_scene(const Scene& scene, Instancing instancing = Instancing::never);

}  // namespace hemiray

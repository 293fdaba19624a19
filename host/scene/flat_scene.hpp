// The scene as arrays of the kernels' own structs, in the world: transforms applied, lights collected. Host only.
#pragma once

#include <cstdint>
#include <vector>

#include "host/scene/scene.hpp"
#include "shared/scene_types.h"

namespace hemiray {

/// Primitive indices: triangles (of the objects in order, then two for each visible area light), spheres, planes.
/// Object indices: Scene::objects, spheres, planes, visible area lights, in that order.
struct FlatScene {
  std::vector<float> positions;  ///< 3 a vertex, world [m]
  std::vector<float> normals;    ///< 3 a vertex, world, zero where flat; empty if no mesh has normals
  std::vector<shared::float2> uvs;
  std::vector<float> colors;             ///< 3 a vertex, linear
  std::vector<shared::uint4> triangles;  ///< vertex indices, material
  std::vector<std::uint32_t> triangle_objects;
  std::vector<shared::Sphere> spheres;
  std::vector<shared::Plane> planes;
  std::vector<shared::Material> materials;
  std::vector<shared::Light> lights;
  std::vector<shared::Emitter> emitters;
  std::vector<shared::Texture> textures;
  std::vector<std::uint32_t> texels;
};

/// Throws DeviceError if the scene has more than 2^30 vertices or triangles, or textures of over 2^32 texels.
FlatScene flatten_scene(const Scene& scene);

}  // namespace hemiray

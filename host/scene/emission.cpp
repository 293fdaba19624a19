// Emissive surfaces in use.
#include "host/scene/emission.hpp"

#include <algorithm>

namespace hemiray {
namespace {

bool emits(const Material& material) { return material.emission != Vec3(0.0F); }

bool object_emits(const Scene& scene, const Object& object) {
  const Mesh& mesh = scene.meshes[object.mesh];
  if (mesh.triangles.empty()) return false;
  if (object.material != kNone) return emits(scene.materials[static_cast<std::size_t>(object.material)]);
  return std::any_of(mesh.triangle_materials.begin(), mesh.triangle_materials.end(),
                     [&](std::uint32_t material) { return emits(scene.materials[material]); });
}

}  // namespace

std::uint64_t count_emitters(const Scene& scene) {
  const auto objects = std::count_if(scene.objects.begin(), scene.objects.end(),
                                     [&](const Object& object) { return object_emits(scene, object); });
  const auto spheres = std::count_if(scene.spheres.begin(), scene.spheres.end(),
                                     [&](const Sphere& sphere) { return emits(scene.materials[sphere.material]); });
  return static_cast<std::uint64_t>(objects + spheres);
}

bool has_emitters(const Scene& scene) {
  return std::any_of(scene.objects.begin(), scene.objects.end(),
                     [&](const Object& object) { return object_emits(scene, object); }) ||
         std::any_of(scene.spheres.begin(), scene.spheres.end(),
                     [&](const Sphere& sphere) { return emits(scene.materials[sphere.material]); });
}

}  // namespace hemiray

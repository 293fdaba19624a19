// Emissive surfaces in use.
#include "host/scene/emission.hpp"

#include <algorithm>

namespace hemiray {
namespace {

bool emits(const Material& material) { return material.emission != Vec3(0.0F); }

}  // namespace

std::vector<bool> emissive_objects(const Scene& scene) {
  std::vector<bool> by_mesh(scene.meshes.size());
  std::transform(scene.meshes.begin(), scene.meshes.end(), by_mesh.begin(), [&](const Mesh& mesh) {
    return std::any_of(mesh.triangle_materials.begin(), mesh.triangle_materials.end(),
                       [&](std::uint32_t material) { return emits(scene.materials[material]); });
  });
  std::vector<bool> result(scene.objects.size());
  std::transform(scene.objects.begin(), scene.objects.end(), result.begin(), [&](const Object& object) {
    if (scene.meshes[object.mesh].triangles.empty()) return false;
    if (object.material != kNone) return emits(scene.materials[static_cast<std::size_t>(object.material)]);
    return static_cast<bool>(by_mesh[object.mesh]);
  });
  return result;
}

std::uint64_t count_emitters(const Scene& scene) {
  const std::vector<bool> objects = emissive_objects(scene);
  const auto spheres = std::count_if(scene.spheres.begin(), scene.spheres.end(),
                                     [&](const Sphere& sphere) { return emits(scene.materials[sphere.material]); });
  return static_cast<std::uint64_t>(std::count(objects.begin(), objects.end(), true) + spheres);
}

bool has_emitters(const Scene& scene) { return count_emitters(scene) > 0; }

}  // namespace hemiray

// Device memory by counting what is uploaded and built: instances have their own vertices there.
#include "host/scene/memory_estimate.hpp"

#include <algorithm>

namespace hemiray {

std::uint64_t predict_device_bytes(const Scene& scene) {
  constexpr std::uint64_t kFloat = 4;
  constexpr std::uint64_t kTriangleBytes = 16 + 4;         // indices with material, object id
  constexpr std::uint64_t kPrimitiveBytes = 64 + 48 + 40;  // BVH nodes, leaf data, build scratch
  constexpr std::uint64_t kMaterialBytes = 128;

  const bool colors =
      std::any_of(scene.meshes.begin(), scene.meshes.end(), [](const Mesh& mesh) { return !mesh.colors.empty(); });
  const std::uint64_t vertex_bytes = kFloat * (3 + 3 + 2 + (colors ? 3 : 0));  // position, normal, uv, colour

  std::uint64_t bytes = 0;
  std::uint64_t primitives = scene.spheres.size();
  for (const Object& object : scene.objects) {
    const Mesh& mesh = scene.meshes[object.mesh];
    bytes += vertex_bytes * mesh.positions.size() + kTriangleBytes * mesh.triangles.size();
    primitives += mesh.triangles.size();
  }
  for (const Light& light : scene.lights) {
    if (light.kind != LightKind::area || !light.visible) continue;
    bytes += vertex_bytes * 4 + kTriangleBytes * 2;
    primitives += 2;
  }
  for (const Texture& texture : scene.textures) bytes += texture.rgba.size();
  return bytes + kPrimitiveBytes * primitives + kMaterialBytes * scene.materials.size();
}

}  // namespace hemiray

// What every scene a mesh reader returns must fulfil; a fuzz target aborts where it does not.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "host/scene/scene.hpp"

namespace hemiray::fuzz {

inline void require(bool good) {
  if (!good) std::abort();
}

/// Indices in range, arrays of equal length, positions finite, notes on one line.
inline void check_scene(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes) {
    const std::size_t count = mesh.positions.size();
    require(mesh.normals.empty() || mesh.normals.size() == count);
    require(mesh.uvs.empty() || mesh.uvs.size() == count);
    require(mesh.colors.empty() || mesh.colors.size() == count);
    require(mesh.triangle_materials.size() == mesh.triangles.size());
    for (const Vec3& p : mesh.positions) require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
    for (const Vec3& n : mesh.normals) require(std::isfinite(n.x) && std::isfinite(n.y) && std::isfinite(n.z));
    for (const Vec2& uv : mesh.uvs) require(std::isfinite(uv.x) && std::isfinite(uv.y));
    for (const UVec3& t : mesh.triangles) require(t.x < count && t.y < count && t.z < count);
    for (const std::uint32_t material : mesh.triangle_materials) require(material < scene.materials.size());
  }
  for (const Object& object : scene.objects) require(object.mesh < scene.meshes.size());
  for (const Material& m : scene.materials) {
    for (const int t : {m.kd_texture, m.metallic_roughness_texture, m.emission_texture, m.normal_texture}) {
      require(t == kNone || static_cast<std::size_t>(t) < scene.textures.size());
    }
  }
  for (const std::string& note : scene.notes) require(note.find('\n') == std::string::npos);
}

/// For readers that ask for files beside the scene: there are none.
inline std::optional<std::vector<std::uint8_t>> no_files(const std::string&) { return std::nullopt; }

}  // namespace hemiray::fuzz

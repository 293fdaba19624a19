// Small steps that all mesh readers share.
#include "host/scene/mesh_tools.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "host/base/error.hpp"
#include "host/base/image_decode.hpp"
#include "host/base/numbers.hpp"

namespace hemiray {

namespace {

// Text files give about six digits: corners of a modelled parallelogram miss each other by that much of its size.
constexpr double kRectangleTolerance = 1e-5;

using QuadCorners = std::array<std::uint32_t, 4>;

// The corners p q r s of a quad that two triangles p q r and p r s make up, each written from any corner on.
std::optional<QuadCorners> quad_of(const UVec3& a, const UVec3& b) {
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t p = a[i];
      const std::uint32_t r = a[(i + 2) % 3];
      const std::uint32_t s = b[(k + 2) % 3];
      if (b[k] == p && b[(k + 1) % 3] == r && s != a[(i + 1) % 3]) return QuadCorners{p, a[(i + 1) % 3], r, s};
    }
  }
  return std::nullopt;
}

template <typename T>
void reorder(const QuadCorners& order, std::vector<T>& values) {
  if (values.empty()) return;
  values = {values[order[0]], values[order[1]], values[order[2]], values[order[3]]};
}

}  // namespace

Vec3 normalized_or_zero(const DVec3& v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0.0) || !std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) return Vec3(0.0F);
  return Vec3(glm::normalize(v / largest));  // scaled first, so that squares neither overflow nor vanish
}

bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

float srgb_to_linear(float encoded) {
  return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

float normal_reflectance(float ior) {
  const float ratio = (ior - 1.0F) / (ior + 1.0F);
  return ratio * ratio;
}

Material default_material(bool has_vertex_colors) {
  Material material;
  material.name = "default";
  if (has_vertex_colors) material.kd = Vec3(1.0F);
  return material;
}

int add_texture(Scene& scene, Texture texture, std::span<const std::uint8_t> file_bytes, const std::string& place) {
  DecodedImage image = decode_image(file_bytes, place);
  std::uint64_t total = image.rgba.size();
  for (const Texture& other : scene.textures) total += other.rgba.size();
  if (total > kMaxSceneTextureBytes) {
    throw InputError(place,
                     "the textures take more than " + format_bytes(kMaxSceneTextureBytes) + "; make them smaller");
  }
  texture.width = image.width;
  texture.height = image.height;
  texture.rgba = std::move(image.rgba);
  scene.textures.push_back(std::move(texture));
  return static_cast<int>(scene.textures.size() - 1);
}

void mark_rectangle(Mesh& mesh) {
  if (mesh.positions.size() != 4 || mesh.triangles.size() != 2) return;
  if (mesh.triangle_materials[0] != mesh.triangle_materials[1]) return;
  const std::optional<QuadCorners> quad = quad_of(mesh.triangles[0], mesh.triangles[1]);
  if (!quad) return;
  const DVec3 p0(mesh.positions[(*quad)[0]]);
  const DVec3 p1(mesh.positions[(*quad)[1]]);
  const DVec3 p2(mesh.positions[(*quad)[2]]);
  const DVec3 p3(mesh.positions[(*quad)[3]]);
  const double gap = glm::length((p1 - p0) - (p2 - p3));
  if (!(gap <= kRectangleTolerance * std::min(glm::length(p1 - p0), glm::length(p3 - p0)))) return;
  reorder(*quad, mesh.positions);
  reorder(*quad, mesh.normals);
  reorder(*quad, mesh.uvs);
  reorder(*quad, mesh.colors);
  mesh.triangles = {UVec3(0, 1, 2), UVec3(0, 2, 3)};
  mesh.rectangle = true;
}

}  // namespace hemiray

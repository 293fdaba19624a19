#include "host/scene/features.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "host/base/vec.hpp"

namespace hemiray {
namespace {

constexpr std::array<const char*, HR_FEATURE_COUNT> kNames = {"triangles",     "spheres",
                                                              "planes",        "smooth-normals",
                                                              "textures",      "normal-maps",
                                                              "vertex-colors", "metallic-roughness",
                                                              "specular",      "ambient",
                                                              "emission",      "lights",
                                                              "point-lights",  "directional-lights",
                                                              "spot-lights",   "area-lights",
                                                              "emitters",      "secondary",
                                                              "reflection",    "refraction",
                                                              "branching",     "fresnel",
                                                              "orthographic",  "phong-shading",
                                                              "instances",     "shapes",
                                                              "implicits",     "thin-triangles",
                                                              "radiosity",     "final-gather"};

bool is_positive(const shared::float4& v) { return v.x > 0.0F || v.y > 0.0F || v.z > 0.0F; }

std::uint32_t material_features(const shared::Material& m, bool has_uvs, int depth) {
  std::uint32_t mask = 0;
  if (is_positive(m.ks)) mask |= HR_FEATURE_SPECULAR;
  if (is_positive(m.emission)) mask |= HR_FEATURE_EMISSION;
  if ((m.flags & HR_MATERIAL_METALLIC_ROUGHNESS) != 0) mask |= HR_FEATURE_METALLIC_ROUGHNESS | HR_FEATURE_SPECULAR;
  if (has_uvs) {
    if (m.kd_texture != HR_NO_TEXTURE || m.metallic_roughness_texture != HR_NO_TEXTURE ||
        m.emission_texture != HR_NO_TEXTURE) {
      mask |= HR_FEATURE_TEXTURES;
    }
    if (m.normal_texture != HR_NO_TEXTURE) mask |= HR_FEATURE_TEXTURES | HR_FEATURE_NORMAL_MAPS;
  }
  if (depth > 0) {
    const bool reflects = is_positive(m.kr);
    const bool refracts = is_positive(m.kt);
    if (reflects) mask |= HR_FEATURE_REFLECTION | HR_FEATURE_SECONDARY;
    if (refracts) mask |= HR_FEATURE_REFRACTION | HR_FEATURE_SECONDARY;
    if (reflects && refracts) mask |= HR_FEATURE_BRANCHING;
    if (refracts && (m.flags & HR_MATERIAL_FRESNEL) != 0) mask |= HR_FEATURE_FRESNEL;
  }
  return mask;
}

std::uint32_t light_feature(std::uint32_t kind) {
  switch (kind) {
    case HR_LIGHT_POINT:
      return HR_FEATURE_POINT_LIGHTS;
    case HR_LIGHT_DIRECTIONAL:
      return HR_FEATURE_DIRECTIONAL_LIGHTS;
    case HR_LIGHT_SPOT:
      return HR_FEATURE_SPOT_LIGHTS;
    case HR_LIGHT_AREA:
      return HR_FEATURE_AREA_LIGHTS;
    default:
      return HR_FEATURE_EMITTERS;
  }
}

// Longest side over the height on it.
constexpr double kThinAspect = 100.0;
// One thin triangle of so many is an exception, for which all rays would pay 7 to 19 % of their time.
constexpr std::size_t kFewOf = 16;

DVec3 vertex_at(const FlatScene& flat, std::uint32_t i) {
  const float* p = &flat.positions[std::size_t{3} * i];
  return {p[0], p[1], p[2]};
}

bool is_thin(const FlatScene& flat, const shared::uint4& t) {
  const DVec3 a = vertex_at(flat, t.x), ab = vertex_at(flat, t.y) - a, ac = vertex_at(flat, t.z) - a, bc = ac - ab;
  const double longest2 = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
  const DVec3 normal = glm::cross(ab, ac);
  return longest2 * longest2 > kThinAspect * kThinAspect * glm::dot(normal, normal);
}

}  // namespace

std::uint32_t triangle_features(const FlatScene& flat) {
  if (flat.triangles.empty()) return 0;
  const auto thin = std::count_if(flat.triangles.begin(), flat.triangles.end(),
                                  [&](const shared::uint4& t) { return is_thin(flat, t); });
  const bool many = static_cast<std::size_t>(thin) * kFewOf > flat.triangles.size();
  return HR_FEATURE_TRIANGLES | (many ? HR_FEATURE_THIN_TRIANGLES : 0U);
}

std::uint32_t features_of(const Scene& scene, const FlatScene& flat, int depth) {
  std::uint32_t mask = triangle_features(flat);
  if (!flat.spheres.empty()) mask |= HR_FEATURE_SPHERES;
  if (!flat.shapes.empty()) mask |= HR_FEATURE_SHAPES;
  if (!flat.tapes.empty()) mask |= HR_FEATURE_IMPLICITS;
  if (!flat.patch_light.empty()) mask |= HR_FEATURE_RADIOSITY;
  if (flat.gather_rays > 0) mask |= HR_FEATURE_GATHER;
  if (!flat.planes.empty()) mask |= HR_FEATURE_PLANES;
  if (!flat.normals.empty()) mask |= HR_FEATURE_SMOOTH_NORMALS;
  if (!flat.colors.empty()) mask |= HR_FEATURE_VERTEX_COLORS;
  if (!flat.instances.empty()) mask |= HR_FEATURE_INSTANCES;
  std::vector<bool> used(flat.materials.size(), false);
  const std::span<const shared::uint4> triangles(flat.triangles);
  for (const shared::uint4& t : triangles.first(flat.world_triangles())) used[t.w] = true;
  std::vector<bool> own(flat.shared_meshes.size(), false);  // meshes seen in their own materials
  for (const shared::Instance& instance : flat.instances) {
    if (instance.material == HR_NO_MATERIAL) {
      own[instance.mesh] = true;
    } else {
      used[instance.material] = true;
    }
  }
  for (std::size_t i = 0; i < own.size(); i++) {
    if (!own[i]) continue;
    const SharedMesh& mesh = flat.shared_meshes[i];
    for (const shared::uint4& t : triangles.subspan(mesh.first_triangle, mesh.triangle_count)) used[t.w] = true;
  }
  for (const shared::Sphere& s : flat.spheres) used[s.material] = true;
  for (const shared::Shape& s : flat.shapes) used[s.material] = true;
  for (const shared::Plane& p : flat.planes) used[p.material] = true;
  for (std::size_t i = 0; i < used.size(); i++) {
    if (used[i]) mask |= material_features(flat.materials[i], !flat.uvs.empty(), depth);
  }
  for (const shared::Light& light : flat.lights) mask |= HR_FEATURE_LIGHTS | light_feature(light.kind);
  if (scene.ambient.x > 0.0F || scene.ambient.y > 0.0F || scene.ambient.z > 0.0F) mask |= HR_FEATURE_AMBIENT;
  if (scene.camera.kind == CameraKind::orthographic) mask |= HR_FEATURE_ORTHOGRAPHIC;
  if (scene.shading == Shading::phong) mask |= HR_FEATURE_PHONG_SHADING;
  return mask;
}

std::vector<std::string> feature_names(std::uint32_t features) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < kNames.size(); i++) {
    if ((features >> i & 1U) != 0) names.emplace_back(kNames[i]);
  }
  return names;
}

}  // namespace hemiray

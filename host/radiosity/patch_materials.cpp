// What patches reflect, transmit and emit: the material's values, textures averaged over the patch.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "host/base/error.hpp"
#include "host/radiosity/patch_mesh.hpp"
#include "host/scene/mesh_tools.hpp"

namespace hemiray {
namespace {

constexpr int kTextureDivisions =
    8;  // a textured patch is looked at in the middles of this many parts an edge, squared

Vec3 rgb(const shared::float4& v) { return {v.x, v.y, v.z}; }

std::uint32_t wrapped(double coordinate, std::uint32_t size, std::uint32_t wrap) {
  const double period = wrap == HR_WRAP_MIRROR ? 2.0 : 1.0;
  double t =
      wrap == HR_WRAP_CLAMP ? std::clamp(coordinate, 0.0, 1.0) : coordinate - period * std::floor(coordinate / period);
  if (t > 1.0) t = 2.0 - t;
  return std::min(static_cast<std::uint32_t>(t * size), size - 1);
}

// The texel at uv; averages over a patch need no filter.
Vec3 texel_at(const FlatScene& flat, std::uint32_t index, Vec2 uv) {
  const shared::Texture& texture = flat.textures[index];
  const std::uint32_t x = wrapped(uv.x, texture.width, texture.wrap_u),
                      y = wrapped(uv.y, texture.height, texture.wrap_v);
  const std::uint32_t rgba = flat.texels[texture.first_texel + std::size_t{y} * texture.width + x];
  Vec3 color;
  for (int i = 0; i < 3; i++) {
    const float encoded = static_cast<float>(rgba >> (8U * static_cast<unsigned>(i)) & 255U) / 255.0F;
    color[i] = texture.flags & HR_TEXTURE_SRGB ? srgb_to_linear(encoded) : encoded;
  }
  return color;
}

// Of one point of a patch.
struct Reflectance {
  Vec3 kd, emission;
};

Reflectance material_at(const FlatScene& flat, const shared::Material& m, const shared::uint4& t, float u, float v) {
  const float w = 1.0F - u - v;
  Reflectance result{rgb(m.kd), rgb(m.emission)};
  for (int i = 0; i < 3 && !flat.colors.empty(); i++) {
    const auto at = [&](std::uint32_t vertex) {
      return flat.colors[std::size_t{3} * vertex + static_cast<std::size_t>(i)];
    };
    result.kd[i] *= w * at(t.x) + u * at(t.y) + v * at(t.z);
  }
  float metallic = m.flags & HR_MATERIAL_METALLIC_ROUGHNESS ? m.kr.w : 0.0F;
  if (!flat.uvs.empty()) {
    const shared::float2 a = flat.uvs[t.x], b = flat.uvs[t.y], c = flat.uvs[t.z];
    const Vec2 uv(w * a.x + u * b.x + v * c.x, w * a.y + u * b.y + v * c.y);
    if (m.kd_texture != HR_NO_TEXTURE) result.kd *= texel_at(flat, m.kd_texture, uv);
    if (m.emission_texture != HR_NO_TEXTURE) result.emission *= texel_at(flat, m.emission_texture, uv);
    if (metallic > 0.0F && m.metallic_roughness_texture != HR_NO_TEXTURE) {
      metallic *= texel_at(flat, m.metallic_roughness_texture, uv).z;
    }
  }
  result.kd *= 1.0F - metallic;
  return result;
}

bool varies(const FlatScene& flat, const shared::Material& m) {
  const bool textured = m.kd_texture != HR_NO_TEXTURE || m.emission_texture != HR_NO_TEXTURE ||
                        (m.metallic_roughness_texture != HR_NO_TEXTURE && m.kr.w > 0.0F);
  return textured && !flat.uvs.empty();
}

Reflectance mean_over(const FlatScene& flat, const shared::Material& m, const shared::uint4& t) {
  constexpr float kThird = 1.0F / 3.0F;
  if (!varies(flat, m)) return material_at(flat, m, t, kThird, kThird);  // linear at most: the middle is the mean
  Reflectance sum{Vec3(0.0F), Vec3(0.0F)};
  const float step = 1.0F / kTextureDivisions;
  const auto add = [&](float i, float j) {
    const Reflectance one = material_at(flat, m, t, i * step, j * step);
    sum.kd += one.kd;
    sum.emission += one.emission;
  };
  for (int i = 0; i < kTextureDivisions; i++) {
    for (int j = 0; i + j < kTextureDivisions; j++) {
      add(static_cast<float>(i) + kThird, static_cast<float>(j) + kThird);
      if (i + j + 1 < kTextureDivisions) add(static_cast<float>(i) + 2 * kThird, static_cast<float>(j) + 2 * kThird);
    }
  }
  const float count = kTextureDivisions * kTextureDivisions;
  return {sum.kd / count, sum.emission / count};
}

}  // namespace

void read_patch_materials(const FlatScene& flat, PatchMesh& mesh) {
  for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
    const shared::uint4& t = mesh.flat.triangles[i];
    const shared::Material& m = flat.materials[t.w];
    const Reflectance mean = mean_over(mesh.flat, m, t);
    const float most = std::max({mean.kd.x, mean.kd.y, mean.kd.z});
    if (!(most < 1.0F)) {
      throw InputError("radiosity", fmt::format("patch {} of object {} reflects {} of the light; below 1 is solvable",
                                                i, mesh.flat.triangle_objects[i], most));
    }
    const Vec3 e = mean.emission * static_cast<float>(std::numbers::pi);
    for (const bool front : {true, false}) {
      mesh.reflectance.push_back({mean.kd.x, mean.kd.y, mean.kd.z, most});
      mesh.transmittance.push_back({m.translucency_r, m.translucency_g, m.translucency_b, 0.0F});
      mesh.emission.push_back(front ? shared::float4{e.x, e.y, e.z, 1.0F} : shared::float4{0.0F, 0.0F, 0.0F, 1.0F});
    }
  }
}

}  // namespace hemiray

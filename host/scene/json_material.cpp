// The "materials" object of a JSON scene, with the textures the materials name.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "host/base/image_decode.hpp"
#include "host/base/read_file.hpp"
#include "host/base/spelling.hpp"
#include "host/scene/json_build.hpp"

namespace hemiray {
namespace {

constexpr std::uint64_t kTextureFileLimit = 1ULL << 30U;  // bytes; far above any sensible PNG or JPEG
constexpr double kMaxShininess = 1e6;                     // beyond it a lobe is narrower than float can tell
constexpr float kEnergySlack = 1e-4F;                     // reflectances are given with about four digits

constexpr auto kFilters = std::to_array<std::string_view>({"linear", "nearest"});
constexpr auto kWraps = std::to_array<std::string_view>({"repeat", "clamp", "mirror"});
constexpr auto kColorSpaces = std::to_array<std::string_view>({"srgb", "linear"});

int read_texture(const JsonNode& node, JsonBuild& build, ColorSpace default_space) {
  Texture texture;
  texture.color_space = default_space;
  if (!node.is_string()) {
    if (!node.is_object()) node.fail("expected a file name or an object, found " + describe(node.value()));
    check_keys(node, "texture");
    if (const auto filter = node.find("filter")) texture.filter = static_cast<Filter>(read_choice(*filter, kFilters));
    if (const auto space = node.find("color_space")) {
      texture.color_space = static_cast<ColorSpace>(read_choice(*space, kColorSpaces));
    }
    if (const auto wrap = node.find("wrap")) {
      if (wrap->is_array()) expect_array(*wrap, 2);
      texture.wrap_u = static_cast<Wrap>(read_choice(wrap->is_array() ? (*wrap)[0] : *wrap, kWraps));
      texture.wrap_v = static_cast<Wrap>(read_choice(wrap->is_array() ? (*wrap)[1] : *wrap, kWraps));
    }
  }
  const std::filesystem::path path = read_file_path(node.is_string() ? node : node.at("file"), build);
  texture.name = path.filename().string();
  const std::string key =
      fmt::format("{}|{}|{}|{}|{}", path.string(), static_cast<int>(texture.filter), static_cast<int>(texture.wrap_u),
                  static_cast<int>(texture.wrap_v), static_cast<int>(texture.color_space));
  const auto [known, fresh] = build.textures.emplace(key, static_cast<int>(build.scene.textures.size()));
  if (!fresh) return known->second;
  DecodedImage image = decode_image(read_file(path, kTextureFileLimit), path.string());
  texture.width = image.width;
  texture.height = image.height;
  texture.rgba = std::move(image.rgba);
  build.scene.textures.push_back(std::move(texture));
  return known->second;
}

void read_metallic_roughness(const JsonNode& node, JsonBuild& build, Material& material) {
  for (const char* key : {"kd", "ks", "shininess", "kd_texture"}) {
    if (const auto other = node.find(key)) {
      other->fail("does not go with base_color, metallic and roughness: they give kd, ks and the exponent");
    }
  }
  material.metallic_roughness = true;
  material.kd = Vec3(node.find("base_color_texture") ? 1.0F : 0.5F);
  if (const auto color = node.find("base_color")) material.kd = read_color(*color, 1.0);
  if (const auto texture = node.find("base_color_texture")) {
    material.kd_texture = read_texture(*texture, build, ColorSpace::srgb);
  }
  if (const auto texture = node.find("metallic_roughness_texture")) {
    material.metallic_roughness_texture = read_texture(*texture, build, ColorSpace::linear);
    material.metallic = 1.0F;  // the texture multiplies: give it its full range
    material.roughness = 1.0F;
  }
  if (const auto metallic = node.find("metallic")) {
    material.metallic = static_cast<float>(read_number(*metallic, 0.0, 1.0));
  }
  if (const auto roughness = node.find("roughness")) {
    material.roughness = static_cast<float>(read_number(*roughness, 0.0, 1.0));
  }
}

void read_phong(const JsonNode& node, JsonBuild& build, Material& material) {
  // Glass, mirrors and lamps are rarely meant to be grey as well.
  const bool specular_or_lamp =
      node.find("kr") || node.find("kt") || node.find("translucency") || node.find("emission");
  material.kd = Vec3(node.find("kd_texture") ? 1.0F : (specular_or_lamp ? 0.0F : 0.5F));
  if (const auto kd = node.find("kd")) material.kd = read_color(*kd, 1.0);
  if (const auto ks = node.find("ks")) material.ks = read_color(*ks, 1.0);
  if (const auto exponent = node.find("shininess")) {
    material.shininess = static_cast<float>(read_number(*exponent, 0.0, kMaxShininess));
  }
  if (const auto texture = node.find("kd_texture")) {
    material.kd_texture = read_texture(*texture, build, ColorSpace::srgb);
  }
}

bool transmits(const Material& material) { return material.kt != Vec3(0.0F); }

Material read_material(const JsonNode& node, JsonBuild& build) {
  check_keys(node, "material");
  Material material;
  const bool metallic_roughness = node.find("base_color") || node.find("base_color_texture") || node.find("metallic") ||
                                  node.find("roughness") || node.find("metallic_roughness_texture");
  if (metallic_roughness) {
    read_metallic_roughness(node, build, material);
  } else {
    read_phong(node, build, material);
  }
  if (const auto ka = node.find("ka")) material.ka = read_color(*ka, 1.0);
  if (const auto kr = node.find("kr")) material.kr = read_color(*kr, 1.0);
  if (const auto kt = node.find("kt")) material.kt = read_color(*kt, 1.0);
  if (const auto tau = node.find("translucency")) {
    material.translucency = read_color(*tau, 1.0);
    const Vec3 sum = material.kd + material.translucency;
    if (!(std::max({sum.r, sum.g, sum.b}) < 1.0F)) {
      tau->fail("kd and translucency must be below 1 together, in every colour");
    }
  }
  if (const auto ior = node.find("ior")) material.ior = static_cast<float>(read_positive(*ior, 100.0));
  if (const auto fresnel = node.find("fresnel")) material.fresnel = read_bool(*fresnel);
  // Fresnel splits the light between kr and kt: what is not transmitted is reflected unless the scene says otherwise.
  if (transmits(material) && material.fresnel && !node.find("kr")) material.kr = Vec3(1.0F);
  if (const auto texture = node.find("emission_texture")) {
    material.emission_texture = read_texture(*texture, build, ColorSpace::srgb);
    material.emission = Vec3(1.0F);
  }
  if (const auto emission = node.find("emission")) material.emission = read_color(*emission, kMaxRadiance);
  if (const auto texture = node.find("normal_texture")) {
    material.normal_texture = read_texture(*texture, build, ColorSpace::linear);
  }
  if (const auto scale = node.find("normal_scale")) {
    if (material.normal_texture == kNone) scale->fail("there is no normal_texture for it to scale");
    material.normal_scale = static_cast<float>(read_number(*scale, -1000.0, 1000.0));
  }
  return material;
}

// More light than arrives may leave a Phong material by accident: worth a note, not an error.
void note_energy(Scene& scene, const Material& material) {
  if (scene.shading != Shading::physical) return;
  const bool split = transmits(material) && material.fresnel;
  const Vec3 mirrored = split ? glm::max(material.kr, material.kt) : material.kr + material.kt;
  const Vec3 sum =
      (material.metallic_roughness ? Vec3(0.0F) : material.kd + material.ks) + material.translucency + mirrored;
  const float largest = std::max({sum.r, sum.g, sum.b});
  if (largest > 1.0F + kEnergySlack) {
    scene.notes.push_back(
        fmt::format("material {} sends out up to {:.3g} times the light that arrives (kd + ks{} + {})",
                    in_quotes(material.name), largest, material.translucency != Vec3(0.0F) ? " + translucency" : "",
                    split ? "the larger of kr and kt" : "kr + kt"));
  }
}

}  // namespace

bool has_texture(const Material& material) {
  return material.kd_texture != kNone || material.metallic_roughness_texture != kNone ||
         material.emission_texture != kNone || material.normal_texture != kNone;
}

void read_materials(const JsonNode& node, JsonBuild& build) {
  if (!node.is_object()) {
    node.fail("expected an object of materials by name, found " + describe(node.value()));
  }
  for (const auto& [name, value] : node.value().items()) {
    Material material = read_material(node.at(name), build);
    material.name = name;
    note_energy(build.scene, material);
    build.materials.emplace(name, static_cast<std::uint32_t>(build.scene.materials.size()));
    build.scene.materials.push_back(std::move(material));
  }
}

std::uint32_t read_material_of(const JsonNode& object, JsonBuild& build) {
  const auto node = object.find("material");
  if (!node) {
    if (!build.default_material) {
      build.default_material = static_cast<std::uint32_t>(build.scene.materials.size());
      build.scene.materials.emplace_back().name = "default";
    }
    return *build.default_material;
  }
  const std::string name = read_string(*node);
  const auto known = build.materials.find(name);
  if (known != build.materials.end()) return known->second;
  std::vector<std::string_view> names;
  for (const auto& [candidate, index] : build.materials) names.push_back(candidate);
  node->fail(fmt::format("unknown material {}{}", in_quotes(name), spelling_hint(name, names)));
}

}  // namespace hemiray

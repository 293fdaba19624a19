// Metallic-roughness materials and their extensions; textures and samplers.
#include "host/scene/gltf_materials.hpp"

#include <string>
#include <utility>

#include "host/scene/mesh_tools.hpp"

namespace hemiray {

namespace {

// Below this perceptual roughness a surface mirrors: a Phong exponent of 2 / 0.1^4 = 20000 is a mirror to the eye.
constexpr float kMirrorRoughness = 0.1F;
// Reflectance at normal incidence that glTF gives all dielectrics.
constexpr float kDielectricReflectance = 0.04F;

std::string quoted_name(const std::string& name) { return name.empty() ? "without name" : "'" + name + "'"; }

// A smooth untextured surface: a mirror in place of the glossy lobe that metallic and roughness would give.
void make_mirror(Material& material) {
  material.kr = glm::mix(Vec3(kDielectricReflectance), material.kd, material.metallic);
  material.kd *= 1.0F - material.metallic;
  material.ks = Vec3(0.0F);
  material.fresnel = false;
  material.metallic_roughness = false;
}

// A smooth dielectric interface: Fresnel splits the light, and what is not reflected is transmitted or diffuse.
void make_transmissive(float transmission, Material& material) {
  const Vec3 base = material.kd * (1.0F - material.metallic);
  material.kt = base * transmission;
  material.kd = base * (1.0F - transmission);
  // Fresnel scales kr only where light passes; black glass keeps the reflectance at normal incidence.
  material.kr = Vec3(material.kt == Vec3(0.0F) ? normal_reflectance(material.ior) : 1.0F);
  material.ks = Vec3(0.0F);
  material.fresnel = true;
  material.metallic_roughness = false;
}

Wrap read_wrap(const JsonNode& sampler, std::string_view key) {
  const std::optional<JsonNode> node = sampler.find(key);
  if (!node) return Wrap::repeat;
  switch (read_integer(*node, 0, kMaxGltfInteger)) {
    case 10497:
      return Wrap::repeat;
    case 33071:
      return Wrap::clamp;
    case 33648:
      return Wrap::mirror;
    default:
      node->fail("unknown wrap mode; use 10497 (repeat), 33071 (clamp) or 33648 (mirror)");
  }
}

Filter read_filter(const JsonNode& sampler) {
  const std::int64_t code = integer_or(sampler, "magFilter", 9729, 0, kMaxGltfInteger);
  if (code != 9728 && code != 9729) sampler.at("magFilter").fail("unknown filter; use 9728 (nearest) or 9729 (linear)");
  return code == 9728 ? Filter::nearest : Filter::linear;
}

}  // namespace

GltfMaterial GltfMaterials::of_primitive(const JsonNode& primitive) {
  const std::optional<JsonNode> reference = primitive.find("material");
  if (!reference) {
    if (!default_) {
      Material material;
      material.name = "glTF default";
      material.kd = Vec3(1.0F);
      material.metallic_roughness = true;
      material.metallic = 1.0F;
      scene_.materials.push_back(material);
      default_ = GltfMaterial{static_cast<std::uint32_t>(scene_.materials.size() - 1), kNone};
    }
    return *default_;
  }
  const std::size_t index = document_.index_of(*reference, "materials");
  const auto known = loaded_.find(index);
  if (known != loaded_.end()) return known->second;
  const GltfMaterial material = load(document_.item("materials", index));
  loaded_.emplace(index, material);
  return material;
}

GltfMaterial GltfMaterials::load(const JsonNode& node) {
  Material material;
  material.name = name_of(node);
  material.metallic_roughness = true;
  material.kd = Vec3(1.0F);
  material.metallic = 1.0F;
  if (node.find("pbrMetallicRoughness")) {
    const JsonNode pbr = object_at(node, "pbrMetallicRoughness");
    if (const std::optional<JsonNode> factor = pbr.find("baseColorFactor")) {
      expect_array(*factor, 4);
      for (int i = 0; i < 3; ++i) {
        material.kd[i] = static_cast<float>(read_number((*factor)[static_cast<std::size_t>(i)], 0.0, 1.0));
      }
      read_number((*factor)[3], 0.0, 1.0);
    }
    material.metallic = static_cast<float>(number_or(pbr, "metallicFactor", 1.0, 0.0, 1.0));
    material.roughness = static_cast<float>(number_or(pbr, "roughnessFactor", 1.0, 0.0, 1.0));
  }
  double strength = 1.0;
  if (const auto ext = extension(node, "KHR_materials_emissive_strength")) {
    strength = number_or(*ext, "emissiveStrength", 1.0, 0.0, kMaxRadiance);
  }
  material.emission = Vec3(vector_or(node, "emissiveFactor", DVec3(0.0), 0.0, 1.0) * strength);
  if (const auto ext = extension(node, "KHR_materials_ior")) {
    const double ior = number_or(*ext, "ior", 1.5, 0.0, 1000.0);
    if (ior < 1.0 && ior != 0.0) ext->at("ior").fail("must be at least 1");
    // 0 stands for "reflects like a mirror at all angles", which no index of refraction gives.
    if (ior == 0.0) document_.note("material " + quoted_name(material.name) + ": ior 0 is not supported, 1.5 is used");
    material.ior = ior == 0.0 ? 1.5F : static_cast<float>(ior);
  }
  GltfMaterial result;
  read_textures(node, material, result.tex_coord);
  note_ignored(node, material.name);

  double transmission = 0.0;
  if (const auto ext = extension(node, "KHR_materials_transmission")) {
    transmission = number_or(*ext, "transmissionFactor", 0.0, 0.0, 1.0);
    if (ext->find("transmissionTexture")) {
      document_.note("material " + quoted_name(material.name) + ": transmissionTexture is not supported, ignored");
    }
  }
  const bool rough_texture = material.metallic_roughness_texture != kNone;
  if (transmission > 0.0 && rough_texture) material.metallic = 0.0F;  // the texture says where; taken as glass
  if (transmission > 0.0 && material.metallic < 1.0F) {               // metals transmit nothing
    if (rough_texture || material.roughness >= kMirrorRoughness) {
      document_.note("material " + quoted_name(material.name) + ": rough transmission is treated as smooth");
    }
    if (material.kd_texture != kNone) {
      document_.note("material " + quoted_name(material.name) + ": baseColorTexture does not tint the transmission");
    }
    material.metallic_roughness_texture = kNone;
    make_transmissive(static_cast<float>(transmission), material);
  } else if (material.roughness < kMirrorRoughness && !rough_texture &&
             (material.metallic == 0.0F || material.kd_texture == kNone)) {
    make_mirror(material);
  }
  result.index = static_cast<std::uint32_t>(scene_.materials.size());
  scene_.materials.push_back(std::move(material));
  return result;
}

void GltfMaterials::read_textures(const JsonNode& node, Material& material, int& tex_coord) {
  if (node.find("pbrMetallicRoughness")) {
    const JsonNode pbr = object_at(node, "pbrMetallicRoughness");
    if (pbr.find("baseColorTexture")) {
      const TextureUse use = read_texture_info(object_at(pbr, "baseColorTexture"), ColorSpace::srgb, tex_coord);
      material.kd_texture = use.texture;
    }
    if (pbr.find("metallicRoughnessTexture")) {
      const JsonNode info = object_at(pbr, "metallicRoughnessTexture");
      material.metallic_roughness_texture = read_texture_info(info, ColorSpace::linear, tex_coord).texture;
    }
  }
  if (node.find("emissiveTexture") && material.emission != Vec3(0.0F)) {
    const JsonNode info = object_at(node, "emissiveTexture");
    material.emission_texture = read_texture_info(info, ColorSpace::srgb, tex_coord).texture;
  }
  if (node.find("normalTexture")) {
    const JsonNode info = object_at(node, "normalTexture");
    material.normal_texture = read_texture_info(info, ColorSpace::linear, tex_coord).texture;
    material.normal_scale = static_cast<float>(number_or(info, "scale", 1.0, -1000.0, 1000.0));
  }
}

GltfMaterials::TextureUse GltfMaterials::read_texture_info(const JsonNode& info, ColorSpace color_space,
                                                           int& tex_coord) {
  const JsonNode index = info.at("index");
  const JsonNode texture = document_.item("textures", document_.index_of(index, "textures"));
  TextureUse use;
  use.tex_coord = static_cast<int>(integer_or(info, "texCoord", 0, 0, 1000000));
  use.texture = load_texture(texture, color_space);
  if (use.texture == kNone) return use;
  if (tex_coord == kNone) {
    tex_coord = use.tex_coord;
  } else if (tex_coord != use.tex_coord) {
    document_.note("a material that uses several TEXCOORD sets is not supported; TEXCOORD_" +
                   std::to_string(tex_coord) + " is used for all of its textures");
  }
  return use;
}

int GltfMaterials::load_texture(const JsonNode& texture, ColorSpace color_space) {
  const std::optional<JsonNode> source = texture.find("source");
  if (!source) {
    document_.note("a texture without a PNG or JPEG source is left out");
    return kNone;
  }
  Texture sampler;
  sampler.color_space = color_space;
  if (const std::optional<JsonNode> reference = texture.find("sampler")) {
    const JsonNode node = document_.item("samplers", document_.index_of(*reference, "samplers"));
    sampler.wrap_u = read_wrap(node, "wrapS");
    sampler.wrap_v = read_wrap(node, "wrapT");
    sampler.filter = read_filter(node);
  }
  return load_image(document_.index_of(*source, "images"), sampler);
}

int GltfMaterials::load_image(std::size_t image, const Texture& sampler) {
  const auto key = std::tuple(image, sampler.color_space, sampler.wrap_u, sampler.wrap_v, sampler.filter);
  const auto known = textures_.find(key);
  if (known != textures_.end()) return known->second;

  const JsonNode node = document_.item("images", image);
  std::vector<std::uint8_t> read;
  std::span<const std::uint8_t> bytes;
  if (const std::optional<JsonNode> uri = node.find("uri")) {
    read = document_.read_uri(*uri);
    bytes = read;
  } else if (const std::optional<JsonNode> reference = node.find("bufferView")) {
    bytes = document_.view(document_.index_of(*reference, "bufferViews")).bytes;
  } else {
    node.fail("has neither a uri nor a bufferView");
  }
  Texture texture = sampler;
  texture.name = name_of(node);
  const int index = add_texture(scene_, std::move(texture), bytes, node.place());
  textures_.emplace(key, index);
  return index;
}

void GltfMaterials::note_ignored(const JsonNode& node, const std::string& name) {
  const std::string prefix = "material " + quoted_name(name) + ": ";
  if (const std::optional<JsonNode> mode = node.find("alphaMode")) {
    const std::string text = read_string(*mode);
    if (text != "OPAQUE" && text != "MASK" && text != "BLEND") mode->fail("use OPAQUE, MASK or BLEND");
    if (text != "OPAQUE") document_.note(prefix + "alphaMode " + text + " is not supported, treated as opaque");
  }
  if (node.find("occlusionTexture")) {
    document_.note("occlusion textures are ignored: occlusion is computed from the geometry");
  }
}

}  // namespace hemiray

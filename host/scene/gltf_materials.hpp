// glTF materials, textures and samplers. docs/scene-formats.md gives the rules from metallic-roughness to Material.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <tuple>
#include <unordered_map>

#include "host/scene/gltf_document.hpp"
#include "host/scene/scene.hpp"

namespace hemiray {

/// A material as a primitive uses it.
struct GltfMaterial {
  std::uint32_t index = 0;  ///< into Scene::materials
  int tex_coord = kNone;    ///< the TEXCOORD_n its textures want; kNone without textures
};

/// Loads materials and decodes their textures when a primitive first uses them.
class GltfMaterials {
 public:
  GltfMaterials(GltfDocument& document, Scene& scene) : document_(document), scene_(scene) {}

  /// The material a primitive names, or glTF's default material. Throws InputError.
  GltfMaterial of_primitive(const JsonNode& primitive);

 private:
  struct TextureUse {
    int texture = kNone;
    int tex_coord = 0;
  };

  GltfMaterial load(const JsonNode& node);
  void read_textures(const JsonNode& node, Material& material, int& tex_coord);
  TextureUse read_texture_info(const JsonNode& info, ColorSpace color_space, int& tex_coord);
  int load_texture(const JsonNode& texture, ColorSpace color_space);
  int load_image(std::size_t image, const Texture& sampler);
  void note_ignored(const JsonNode& node, const std::string& name);

  GltfDocument& document_;
  Scene& scene_;
  std::unordered_map<std::size_t, GltfMaterial> loaded_;
  std::optional<GltfMaterial> default_;
  std::map<std::tuple<std::size_t, ColorSpace, Wrap, Wrap, Filter>, int> textures_;
};

}  // namespace hemiray

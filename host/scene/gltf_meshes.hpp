// glTF meshes: primitives into indexed triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "host/scene/gltf_accessors.hpp"
#include "host/scene/gltf_document.hpp"
#include "host/scene/gltf_materials.hpp"
#include "host/scene/scene.hpp"

namespace hemiray {

/// Most triangles of one file; a few bytes of JSON can ask for the same accessor over and over.
inline constexpr std::uint64_t kMaxGltfTriangles = std::uint64_t{1} << 27;

/// Turns glTF meshes into Scene::meshes, each once. Triangles with non-finite or no area are dropped and counted.
class GltfMeshes {
 public:
  GltfMeshes(GltfDocument& document, Scene& scene) : document_(document), scene_(scene), materials_(document, scene) {}

  /// Index into Scene::meshes of glTF mesh `index`; nothing if it has no triangles. Throws InputError.
  std::optional<std::uint32_t> load(std::size_t index);

 private:
  struct Primitive;
  struct Remap {
    std::uint32_t stamp = 0;
    std::uint32_t vertex = 0;
  };

  std::optional<std::uint32_t> build(const JsonNode& node);
  void add_primitive(const JsonNode& node, Mesh& mesh);
  void add_triangle(const Primitive& primitive, const UVec3& corners, Mesh& mesh);
  std::uint32_t add_vertex(const Primitive& primitive, std::uint32_t corner, Mesh& mesh);
  std::optional<GltfAccessor> attribute(const JsonNode& attributes, const std::string& name, int min_components,
                                        int max_components, std::size_t count);

  GltfDocument& document_;
  Scene& scene_;
  GltfMaterials materials_;
  std::unordered_map<std::size_t, std::optional<std::uint32_t>> loaded_;
  std::vector<Remap> remap_;  // vertex of the primitive at hand -> vertex of the mesh, valid where the stamp agrees
  std::uint32_t stamp_ = 0;
  std::uint64_t triangles_ = 0;
};

}  // namespace hemiray

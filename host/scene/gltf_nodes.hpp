// The glTF node hierarchy: transforms, and the cameras, lights and meshes that nodes place.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/scene/gltf_document.hpp"
#include "host/scene/gltf_meshes.hpp"
#include "host/scene/scene.hpp"

namespace hemiray {

/// Deepest node hierarchy accepted.
inline constexpr int kMaxGltfNodeDepth = 256;

/// Walks the file's scene (its default one, else the first, else all root nodes) and fills in objects, camera and
/// lights. Cycles, nodes with several parents and hierarchies deeper than kMaxGltfNodeDepth are refused.
class GltfNodes {
 public:
  GltfNodes(GltfDocument& document, Scene& scene) : document_(document), scene_(scene), meshes_(document, scene) {}

  /// Throws InputError.
  void load();

 private:
  void find_parents();
  std::vector<std::size_t> root_nodes();
  void place(const JsonNode& node, std::size_t index, const DMat4& to_world);
  void place_mesh(const JsonNode& node, const JsonNode& reference, const std::string& name, const DMat4& to_world);
  void place_camera(const JsonNode& camera, const JsonNode& node, const DMat4& to_world);
  void place_light(const JsonNode& reference, const std::string& name, const DMat4& to_world);

  GltfDocument& document_;
  Scene& scene_;
  GltfMeshes meshes_;
  std::vector<int> parents_;  // kNone for roots
};

}  // namespace hemiray

// Puts the parts of the glTF reader together.
#include "host/scene/gltf_reader.hpp"

#include <utility>
#include <vector>

#include "host/scene/gltf_document.hpp"
#include "host/scene/gltf_nodes.hpp"
#include "host/scene/notes.hpp"

namespace hemiray {

Scene read_gltf(std::span<const std::uint8_t> bytes, const std::string& file, const FileResolver& resolve) {
  Scene scene;
  Notes notes;
  GltfDocument document(bytes, file, resolve, notes);
  if (document.count("animations") > 0) document.note("animations are ignored: the rest pose is used");
  GltfNodes(document, scene).load();
  if (scene.objects.empty()) document.note("holds no triangles");
  scene.notes = notes.lines();
  return scene;
}

Scene load_gltf(const std::filesystem::path& file) {
  const std::vector<std::uint8_t> bytes = read_file(file);
  Scene scene = read_gltf(bytes, file.string(), folder_resolver(file.parent_path()));
  scene.source = file;
  if (scene.title.empty()) scene.title = file.stem().string();
  return scene;
}

}  // namespace hemiray

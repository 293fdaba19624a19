// One door for all scene files.
#include "host/scene/load.hpp"

#include <algorithm>
#include <cctype>

#include "host/base/error.hpp"
#include "host/scene/gltf_reader.hpp"
#include "host/scene/json_scene.hpp"
#include "host/scene/obj_reader.hpp"
#include "host/scene/ply_reader.hpp"

namespace hemiray {
namespace {

Scene read_by_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".json") return load_json_scene(file);
  if (extension == ".gltf" || extension == ".glb") return load_gltf(file);
  if (extension == ".obj") return load_obj(file);
  if (extension == ".ply") return load_ply(file);
  const std::string kind = extension.empty() ? "a file without extension" : "the extension " + extension;
  throw InputError(file.string(), "cannot tell the format of " + kind + "; known: .json, .gltf, .glb, .obj, .ply");
}

}  // namespace

Scene load_scene(const std::filesystem::path& file) {
  Scene scene = read_by_extension(file);
  scene.source = file;
  if (scene.title.empty()) scene.title = file.stem().string();
  validate_scene(scene);
  finish_scene(scene);
  return scene;
}

}  // namespace hemiray

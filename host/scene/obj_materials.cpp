// Material lookup and texture loading for OBJ files.
#include "host/scene/obj_materials.hpp"

#include <sstream>
#include <utility>

#include "host/base/error.hpp"
#include "host/base/spelling.hpp"
#include "host/scene/mesh_tools.hpp"

namespace hemiray {

namespace {

std::string folder_of(const std::string& name) {
  const std::size_t slash = name.rfind('/');
  return slash == std::string::npos ? std::string() : name.substr(0, slash + 1);
}

}  // namespace

ObjMaterials::ObjMaterials(Scene& scene, std::string obj_file, const FileResolver& resolve, Notes& notes)
    : scene_(scene), obj_file_(std::move(obj_file)), resolve_(resolve), notes_(notes) {}

bool ObjMaterials::add_library(const std::string& name) {
  std::string path = name;
  for (char& c : path) c = c == '\\' ? '/' : c;
  if (is_absolute_name(path)) return false;
  const std::optional<std::vector<std::uint8_t>> bytes = resolve_(path);
  if (!bytes) return false;
  const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  const std::string file = folder_of(obj_file_) + path;
  for (MtlMaterial& mtl : read_mtl(text, file, notes_)) {
    const std::string key = mtl.name;
    const auto [at, fresh] = entries_.try_emplace(key);
    if (!fresh) notes_.once(mtl.place + ": material '" + printable(key) + "' is defined again; the first one is used");
    if (fresh) at->second = {std::move(mtl), folder_of(path), kNone};
  }
  return true;
}

void ObjMaterials::add_libraries(const std::string& names, const std::string& place) {
  if (add_library(names)) return;
  std::istringstream words(names);
  std::string name;
  while (words >> name) {
    if (name == names || !add_library(name)) {
      notes_.once(place + ": material library '" + printable(name) + "' " +
                  (is_absolute_name(name) ? "is an absolute path, not read" : "not found"));
    }
  }
}

std::uint32_t ObjMaterials::default_index() {
  if (default_index_ == kNone) {
    default_index_ = static_cast<int>(scene_.materials.size());
    scene_.materials.push_back(default_material(vertex_colors_));
  }
  return static_cast<std::uint32_t>(default_index_);
}

void ObjMaterials::set_vertex_colors() {
  if (!vertex_colors_ && default_index_ != kNone) {
    scene_.materials[static_cast<std::size_t>(default_index_)] = default_material(true);
  }
  vertex_colors_ = true;
}

int ObjMaterials::load_map(const MtlMap& map, const std::string& folder) {
  if (is_absolute_name(map.file)) {
    throw InputError(map.place,
                     "'" + printable(map.file) + "' is an absolute path; name the texture relative to the .mtl");
  }
  const std::string path = folder + map.file;
  const auto [at, fresh] = textures_.try_emplace({path, map.clamp}, kNone);
  if (!fresh) return at->second;
  const std::optional<std::vector<std::uint8_t>> bytes = resolve_(path);
  if (!bytes) throw InputError(map.place, "texture '" + printable(map.file) + "' not found");
  Texture texture;
  texture.name = printable(map.file);
  texture.wrap_u = texture.wrap_v = map.clamp ? Wrap::clamp : Wrap::repeat;
  at->second = add_texture(scene_, std::move(texture), *bytes, map.place + ": texture '" + printable(map.file) + "'");
  return at->second;
}

std::uint32_t ObjMaterials::use(const std::string& name) {
  const auto found = entries_.find(name);
  if (found == entries_.end()) {
    notes_.once(obj_file_ + ": material '" + printable(name) + "' is not defined, the default material is used");
    return default_index();
  }
  Entry& entry = found->second;
  if (entry.index == kNone) {
    Material material = to_material(entry.mtl, notes_);
    if (entry.mtl.map_kd) material.kd_texture = load_map(*entry.mtl.map_kd, entry.folder);
    if (entry.mtl.map_ke) material.emission_texture = load_map(*entry.mtl.map_ke, entry.folder);
    entry.index = static_cast<int>(scene_.materials.size());
    scene_.materials.push_back(std::move(material));
  }
  return static_cast<std::uint32_t>(entry.index);
}

}  // namespace hemiray

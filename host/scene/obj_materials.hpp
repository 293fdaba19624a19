// The materials of an OBJ file: looks names up in its .mtl libraries and loads what faces use.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <unordered_map>

#include "host/base/read_file.hpp"
#include "host/scene/mtl_reader.hpp"
#include "host/scene/notes.hpp"
#include "host/scene/scene.hpp"

namespace hemiray {

/// Fills scene.materials and scene.textures on demand.
class ObjMaterials {
 public:
  ObjMaterials(Scene& scene, std::string obj_file, const FileResolver& resolve, Notes& notes);

  /// Reads the libraries a mtllib line names: one file whose name may hold blanks, or several. A missing one is noted.
  void add_libraries(const std::string& names, const std::string& place);

  /// Index into scene.materials of the material of that name; the default material (with a note) for unknown names.
  std::uint32_t use(const std::string& name);

  /// Index of the default material, added at the first call.
  std::uint32_t default_index();

  /// Says that vertices have colours, so that the default material is white.
  void set_vertex_colors();

 private:
  struct Entry {
    MtlMaterial mtl;
    std::string folder;  // of the library, "" or with a trailing slash
    int index = kNone;   // into scene.materials
  };

  bool add_library(const std::string& name);
  int load_map(const MtlMap& map, const std::string& folder);

  Scene& scene_;
  std::string obj_file_;
  const FileResolver& resolve_;
  Notes& notes_;
  std::unordered_map<std::string, Entry> entries_;
  std::map<std::tuple<std::string, bool>, int> textures_;
  int default_index_ = kNone;
  bool vertex_colors_ = false;
};

}  // namespace hemiray

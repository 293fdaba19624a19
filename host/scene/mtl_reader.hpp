// Reads Wavefront MTL material libraries. docs/scene-formats.md holds the table from illum models to Material.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/base/vec.hpp"
#include "host/scene/notes.hpp"
#include "host/scene/scene.hpp"

namespace hemiray {

/// A texture a material asks for.
struct MtlMap {
  std::string file;   ///< as written, relative to the .mtl file, with '/' for '\'
  std::string place;  ///< "file:line:column" of the name
  bool clamp = false;
};

/// One `newmtl` block, as written; what is absent was not given.
struct MtlMaterial {
  std::string name;
  std::string place;                  ///< "file:line:column" of the name
  std::optional<Vec3> kd;             ///< [0,1]
  std::optional<Vec3> ks;             ///< [0,1]
  std::optional<Vec3> ka;             ///< [0,1]
  std::optional<Vec3> tf;             ///< [0,1] transmission of the whole body
  std::optional<Vec3> ke;             ///< radiance [W/m^2/sr], >= 0
  std::optional<float> ns;            ///< >= 0
  std::optional<float> ni;            ///< > 0
  std::optional<float> dissolve;      ///< d, [0,1]
  std::optional<float> transparency;  ///< Tr = 1 - d, [0,1]
  std::optional<int> illum;           ///< 0..10
  std::optional<MtlMap> map_kd;
  std::optional<MtlMap> map_ke;
};

/// Parses a material library. `file` is its name in errors and notes; unknown keywords are noted once each.
/// Throws InputError "file:line:column: ..." for numbers that are malformed or out of range.
std::vector<MtlMaterial> read_mtl(std::string_view text, const std::string& file, Notes& notes);

/// The material's surface, without its textures, by the table in docs/scene-formats.md.
Material to_material(const MtlMaterial& mtl, Notes& notes);

}  // namespace hemiray

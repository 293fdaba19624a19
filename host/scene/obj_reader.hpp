// Reads Wavefront OBJ models with their MTL materials. docs/scene-formats.md says what is supported.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "host/base/read_file.hpp"
#include "host/scene/scene.hpp"

namespace hemiray {

/// Loads an OBJ file, the .mtl files it names and their textures. One mesh and object per o/g group with faces;
/// polygons are triangulated, degenerate triangles dropped and counted. The scene has no camera and no lights (emissive
/// materials aside) and is not passed through finish_scene().
/// Throws InputError "file:line:column: ..." for malformed text, numbers and indices.
Scene load_obj(const std::filesystem::path& file);

/// The same from memory. `file` is the name used in errors; `resolve` gives the .mtl and texture files by the name the
/// OBJ file uses (a texture's name has its .mtl file's folder in front).
Scene read_obj(std::string_view text, const std::string& file, const FileResolver& resolve);

}  // namespace hemiray

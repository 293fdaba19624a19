// Reads PLY meshes (ascii, binary little and big endian). docs/scene-formats.md says what is supported.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "host/scene/scene.hpp"

namespace hemiray {

/// Loads a PLY file as one mesh and one object with the default material. Polygons are triangulated; degenerate
/// triangles and, in binary files, those with non-finite positions are dropped and counted. The scene has no camera
/// and no lights and is not passed through finish_scene().
/// Throws InputError "file:line:column: ..." for header and ascii faults, "file: element i: ..." for binary data.
Scene load_ply(const std::filesystem::path& file);

/// The same from memory. `file` is the name used in errors.
Scene read_ply(std::span<const std::uint8_t> bytes, const std::string& file);

}  // namespace hemiray

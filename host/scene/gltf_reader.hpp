// Reads glTF 2.0 scenes (.gltf and .glb). docs/scene-formats.md says what is supported.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "host/base/read_file.hpp"
#include "host/scene/scene.hpp"

namespace hemiray {

/// Loads a glTF 2.0 file with the buffers and images it names beside itself: objects, materials, textures, the first
/// camera and all punctual lights of its scene. Triangles without area or with non-finite corners are dropped and
/// counted; unsupported features are noted. The scene is not passed through finish_scene().
/// Throws InputError "file: /json/path: ...", "file:line:column: ..." for broken JSON, "file: byte n: ..." for broken
/// containers.
Scene load_gltf(const std::filesystem::path& file);

/// The same from memory; .glb is told from .gltf by its first bytes. `file` is the name used in errors; `resolve` gives
/// the files that URIs name, decoded and relative to the scene.
Scene read_gltf(std::span<const std::uint8_t> bytes, const std::string& file, const FileResolver& resolve);

}  // namespace hemiray

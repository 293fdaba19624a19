// The JSON scene format (docs/scene-json.md, scenes/scene.schema.json).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "host/scene/scene.hpp"

namespace hemiray {

/// Deepest nesting of arrays and objects in a JSON scene.
inline constexpr int kMaxSceneNesting = 64;

/// Loads a JSON scene with the mesh and texture files it names, without finish_scene(). Throws InputError with
/// "file:line:column: ..." for broken JSON and "file: /json/path: ..." for everything else.
Scene load_json_scene(const std::filesystem::path& file);

/// The same from memory. `name` stands for the file in messages; files the scene names are relative to `folder`, and
/// refused where that is empty.
Scene parse_json_scene(std::string_view text, const std::string& name, const std::filesystem::path& folder);

}  // namespace hemiray

// Reads a scene from any supported file.
#pragma once

#include <filesystem>

#include "host/scene/scene.hpp"

namespace hemiray {

/// Loads .json (hemiray scene), .gltf, .glb, .obj or .ply, validates it wholly and completes it with a framed camera
/// and a default light where the file has none (each named in Scene::notes). Throws InputError with "file:line:column:
/// ..." or "file: /json/path: ...".
Scene load_scene(const std::filesystem::path& file);

/// Gives a scene without camera one that frames its bounds, and one without any light or emission a default light;
/// says so in Scene::notes. Called by load_scene(); public for scenes built in code.
void finish_scene(Scene& scene);

/// Throws InputError unless every index is in range, every number finite, array lengths agree, radii and sizes
/// positive. For scenes built in code; the loaders give better places for the same faults.
void validate_scene(const Scene& scene);

}  // namespace hemiray

// Which surfaces of a scene emit light of themselves.
#pragma once

#include <cstdint>
#include <vector>

#include "host/scene/scene.hpp"

namespace hemiray {

/// For each of Scene::objects whether any of its triangles emits. Each mesh is looked through once. Indices must be in
/// range.
std::vector<bool> emissive_objects(const Scene& scene);

/// Objects with an emissive triangle, and emissive spheres. Area lights do not count. Indices must be in range.
std::uint64_t count_emitters(const Scene& scene);

/// Whether count_emitters() is not 0.
bool has_emitters(const Scene& scene);

}  // namespace hemiray

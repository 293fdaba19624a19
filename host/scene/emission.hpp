// Which surfaces of a scene emit light of themselves.
#pragma once

#include <cstdint>

#include "host/scene/scene.hpp"

namespace hemiray {

/// Objects with an emissive triangle, and emissive spheres. Area lights do not count. Indices must be in range.
std::uint64_t count_emitters(const Scene& scene);

/// Whether count_emitters() is not 0, found without counting all.
bool has_emitters(const Scene& scene);

}  // namespace hemiray

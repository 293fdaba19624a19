// The room that the bars are measured in.
#pragma once

#include <cstdint>

#include "host/bench/view.hpp"
#include "host/scene/flat_scene.hpp"

namespace hemiray::bench {

/// See procedural_scene(): `triangles` >= kLeastTriangles.
FlatScene interior_scene(std::uint32_t triangles);

/// From a corner of the room at 3.2 m, under a light near the middle of the ceiling.
View interior_view();

}  // namespace hemiray::bench

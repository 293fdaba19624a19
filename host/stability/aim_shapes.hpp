// Rays aimed where disks, cones, cylinders and quadrics are hard: rims, the edges between side and caps, apexes,
// tangents, generators, from the surface and from far away.
#pragma once

#include "host/scene/flat_scene.hpp"
#include "host/stability/aim.hpp"

namespace hemiray::stability {

/// At the scene's shapes, of which none is implicit, one after the other.
RayMaker at_shapes(const FlatScene& flat);

}  // namespace hemiray::stability

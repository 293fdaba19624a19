// The meshes of the hard cases.
#pragma once

#include <cstdint>

#include "host/base/vec.hpp"
#include "host/scene/flat_scene.hpp"

namespace hemiray::stability {

/// Every vertex p becomes scale p + offset, rounded once.
FlatScene moved(FlatScene flat, DVec3 scale, DVec3 offset = DVec3(0.0));

/// 20 triangles, convex, vertices at distance 1 from the origin and in no plane of the axes' grid; fronts outward.
FlatScene icosahedron();

/// `cells` x `cells` cells of two triangles on [-1, 1]^2 at z = 0, whose inner vertices are not evenly spaced.
FlatScene sheet(std::uint32_t cells);

/// `count` triangles with long sides of length 1, side by side; their width is 1 / aspect. Turned askew.
FlatScene slivers(std::uint32_t count, double aspect);

/// Adds the triangles of another.
void append(FlatScene& flat, const FlatScene& more);

/// Turned about two axes by angles that are no simple fractions, rounded once.
FlatScene askew(FlatScene flat);

}  // namespace hemiray::stability

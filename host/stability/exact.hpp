// Predicates of rays and triangles without rounding: floats are integers times a power of two.
#pragma once

#include "host/base/vec.hpp"

namespace hemiray::stability {

/// Sign of d . ((p - o) x (q - o)): on which side of the edge from p to q the ray passes. All finite.
int exact_edge_sign(Vec3 o, Vec3 d, Vec3 p, Vec3 q);

/// Whether the finite points lie on one line.
bool exact_collinear(Vec3 a, Vec3 b, Vec3 c);

/// Where the ray meets the plane of the triangle [in lengths of d], rounded once; the ray does not lie along it.
long double exact_plane_t(Vec3 o, Vec3 d, Vec3 a, Vec3 b, Vec3 c);

}  // namespace hemiray::stability

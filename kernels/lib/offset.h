// Where a secondary ray starts: as far off the surface as the hit point's rounding error demands, and no farther.
#ifndef HR_LIB_OFFSET_H
#define HR_LIB_OFFSET_H

#include "lib/vec.h"

static inline real nudge(real p, real offset) {
  return offset > 0 ? nextafter(p, (real)INFINITY) : (offset < 0 ? nextafter(p, (real)-INFINITY) : p);
}

// position +- error bounds the true point; `normal` is the geometric one; the result lies beyond the error box on the
// side of `direction` (Pharr, Jakob, Humphreys, Physically Based Rendering, 4th ed., 6.8.6).
static inline real3 offset_origin(real3 position, real3 error, real3 normal, real3 direction) {
  const real distance = dot3(fabs(normal), error);
  const real3 offset = normal * (dot3(direction, normal) < 0 ? -distance : distance);
  const real3 moved = position + offset;
  return (real3)(nudge(moved.x, offset.x), nudge(moved.y, offset.y), nudge(moved.z, offset.z));
}

#endif

// Triangles that are thin as the ray sees them: along their surface, or slivers. Their edge functions, which weigh the
// vertices' distances, are differences of nearly equal products of rounded coordinates, so t is taken from the plane.
#ifndef HR_LIB_THIN_TRIANGLE_H
#define HR_LIB_THIN_TRIANGLE_H

#include "lib/residual.h"

// In the sheared plane coordinates are at most `reach`, and each is off by some 5 ulps of `farthest`, the largest depth
// (reach is no more than twice that): an edge function by 5 ulps of 4 reach farthest, and t, whose weights these are,
// by that times `spread`, the difference of the vertices' depths, over det. Depth at the hit is depth_det / det. So t
// is off by at most some 40 times this many ulps where a triangle is not thin. A macro, for scalars and vectors.
#define HR_THIN_GAIN 64
#define HR_IS_THIN(spread, reach, farthest, depth_det) \
  ((spread) * (reach) * (farthest) > HR_THIN_GAIN * fabs(depth_det))

// t at which the ray meets the triangle's plane, within a few ulps over the sine of the angle between them, but between
// `one_end` and `other_end`, the vertices' least and largest t in any order: a ray that passes by the last bit, along
// the plane, may meet that anywhere. `weighted` if plane and ray are parallel, or numbers leave the range.
static inline real thin_triangle_t(real3 origin, real3 direction, real3 a, real3 b, real3 c, real one_end,
                                   real other_end, real weighted) {
  LongReal3 e1 = long_difference(b, a), e2 = long_difference(c, a);
  // In units that are a power of two: the area of a tiny triangle must not underflow.
  const int exponent = -ilogb(max_component(max(fabs(e1.high), fabs(e2.high))));
  e1.high = ldexp(e1.high, exponent);
  e1.low = ldexp(e1.low, exponent);
  e2.high = ldexp(e2.high, exponent);
  e2.low = ldexp(e2.low, exponent);
  const LongReal3 n = long_cross(e1, e2), along = {direction, (real3)(0)};
  const real t = divide(long_dot(long_difference(a, origin), n), long_dot(along, n));
  return isfinite(t) ? min(max(t, min(one_end, other_end)), max(one_end, other_end)) : weighted;
}

#endif

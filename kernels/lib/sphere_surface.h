// A sphere at a hit: its normal, which tells the side that the ray came from.
#ifndef HR_LIB_SPHERE_SURFACE_H
#define HR_LIB_SPHERE_SURFACE_H

#include "lib/vec.h"

// Outward, unit, where the ray meets the sphere at t. Where the ray all but touches the sphere, rounding leaves open
// which way it faces; but a ray from outside meets the front, one from inside the back, and whatever leaves the point
// relies on that. So there it is tilted, by no more than its error, until it faces as it must.
static inline real3 sphere_outward(real3 origin, real3 direction, real3 center, real radius, real t) {
  const real3 travelled = direction * t, from = origin - center;
  const real3 p = origin + travelled - center;
  const real3 outward = normalize3(p);
  // t is off by 4 roundings of |origin - center|, p by 3 more of its terms.
  const real unsure = dot3(fabs(origin) + fabs(travelled) + fabs(center), fabs(direction)) * HR_GAMMA(8);
  if (fabs(dot3(p, direction)) > unsure) return outward;
  const real length2 = dot3(direction, direction), cosine = dot3(outward, direction);
  const real side = dot3(from, from) > radius * radius ? -REAL(1.0) : REAL(1.0);
  // So much that the few roundings of mirroring a direction cannot change the sign again.
  const real least = square_root(length2) * HR_GAMMA(16);
  if (cosine * side >= least) return outward;
  return normalize3(outward - direction * divide(cosine - side * max(fabs(cosine), least), length2));
}

#endif

// How far from a triangle's edges rays leave it.
#ifndef HR_LIB_EDGE_DISTANCE_H
#define HR_LIB_EDGE_DISTANCE_H

#include "lib/vec.h"

// Where faces meet at an angle a, what is moved off one of them by its error must not pass the other, which is no more
// exact: that takes a distance of cot(a / 2) errors from the edge. 16: down to angles of 7.2 degrees.
#define HR_EDGE_ERRORS REAL(16.0)
// But no more than this share of the inscribed circle's radius, unless that is less than the error itself: triangles
// that small lie so far from the origin that their rays would all leave from their middle.
#define HR_EDGE_SHARE REAL(0.125)

// The way in the plane from a triangle's point with barycentrics u, v to where rays may leave, `error` off at most:
// none unless an edge is near. Across the edges e1 = b - a and e2 = c - a heights are barycentrics times those of the
// vertices; too small ones become the least allowed, and all others give in proportion to what they have beyond it.
static inline real3 way_off_edges(real u, real v, real3 e1, real3 e2, real3 error) {
  const real3 e3 = e2 - e1, b = (real3)(1 - u - v, u, v);
  const real size = max_component(max(fabs(e1), fabs(e2)));  // so that the square of a tiny area does not underflow
  const real3 side1 = divide3(e1, size), side2 = divide3(e2, size), side3 = divide3(e3, size);
  const real3 area = cross3(side1, side2);
  const real3 length =
      (real3)(square_root(dot3(side3, side3)), square_root(dot3(side2, side2)), square_root(dot3(side1, side1)));
  const real round_trip = length.x + length.y + length.z;
  const real inradius = size * divide(square_root(dot3(area, area)), round_trip);
  const real off = square_root(dot3(error, error));
  const real distance = max(off, min(HR_EDGE_ERRORS * off, HR_EDGE_SHARE * inradius));
  const real share = distance < inradius ? divide(distance, inradius) : REAL(1.0);
  const real3 least = length * divide(share, round_trip), beyond = max(b - least, (real3)(0));
  const real sum = beyond.x + beyond.y + beyond.z;
  if (b.x >= least.x && b.y >= least.y && b.z >= least.z) return (real3)(0);
  const real3 to = least + beyond * (sum > 0 ? divide(1 - share, sum) : REAL(0.0));
  return e1 * (to.y - u) + e2 * (to.z - v);
}

#endif

// Shadow rays of triangles with smooth normals start on the surface that the normals tell of, not on the triangle.
// Otherwise the triangle's own plane cuts the light off where the smooth surface still sees it, and the shadow's edge
// shows the triangles (the shadow terminator). Hanika 2021, "Hacking the Shadow Terminator", Ray Tracing Gems II,
// ch. 4.
#ifndef HR_LIB_TERMINATOR_H
#define HR_LIB_TERMINATOR_H

#include "lib/vec.h"

#ifndef HR_HARD_TERMINATOR
#define HR_HARD_TERMINATOR 0 /* 1: without this */
#endif

// What one vertex adds: the point is moved up to the vertex's tangent plane if it lies below. Both normals on the side
// of the viewer.
static inline real3 lift_to_tangent(real3 from_vertex, real3 vertex_normal, real3 normal, real weight) {
  const real length2 = dot3(vertex_normal, vertex_normal);
  if (!(length2 > 0)) return (real3)(0);
  const real side = dot3(vertex_normal, normal) < 0 ? REAL(-1.0) : REAL(1.0);
  const real below = -side * dot3(from_vertex, vertex_normal);
  return below > 0 ? vertex_normal * (divide(side * below, length2) * weight) : (real3)(0);
}

// From the triangle's point u, v to where shadow rays start [m]; e1 = b - a, e2 = c - a. Zero where it is concave.
static inline real3 shadow_lift(real3 e1, real3 e2, real u, real v, real3 na, real3 nb, real3 nc, real3 normal) {
  const real3 from_a = e1 * u + e2 * v;
  return lift_to_tangent(from_a, na, normal, 1 - u - v) + lift_to_tangent(from_a - e1, nb, normal, u) +
         lift_to_tangent(from_a - e2, nc, normal, v);
}

#endif

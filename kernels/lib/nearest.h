// Distances from a point, instead of along a ray: to boxes, triangles and spheres. Where sums of squares are formed,
// lengths must lie in [1e-15, 1e18] m, beyond which they leave the range of a float.
#ifndef HR_LIB_NEAREST_H
#define HR_LIB_NEAREST_H

#include "lib/accel_layout.h"
#include "lib/primitive.h"

// A box is left out if its distance, squared, exceeds the best by more than rounding may amount to.
#define HR_NEAREST_PAD REAL(0.999996)

// A point of the scene's surface.
typedef struct Nearest {
  real distance2;  // [m^2]
  real3 point;     // [m]
  uint primitive;
} Nearest;

static inline real length2(real3 v) {
#pragma OPENCL FP_CONTRACT OFF
  return v.x * v.x + v.y * v.y + v.z * v.z;
}

// Squared distance from p to the box; 0 inside. Each step rounds monotonically: it is never more than the computed
// squared distance to a point of the box.
static inline real box_distance2(real3 p, real3 lo, real3 hi) { return length2(max(max(lo - p, p - hi), (real3)(0))); }

static inline bool is_nearer(real distance2, uint primitive, const Nearest* best) {
  if (!(distance2 < INFINITY)) return false;
  return distance2 < best->distance2 || (distance2 == best->distance2 && primitive < best->primitive);
}

// Of the segment from a to b: by the projection of p, clamped.
static inline real3 nearest_on_segment(real3 p, real3 a, real3 b) {
  const real3 d = b - a;
  const real along = dot3(p - a, d), whole = dot3(d, d);
  if (!(along > 0)) return a;
  if (along >= whole) return b;
  // From the nearer end, so that its vertex is met exactly.
  return 2 * along < whole ? a + d * (along / whole) : b - d * (dot3(b - p, d) / whole);
}

// Of the triangle: p's projection if that lies inside of all edges, else the best of the edges (the regions of Ericson
// 2005, "Real-Time Collision Detection", 5.1.5). The edges are always looked at: near an edge of a sliver, rounding
// cannot tell the regions apart, and the smallest distance is the right one.
static inline real3 nearest_on_triangle(real3 p, real3 a, real3 b, real3 c) {
  real3 best = nearest_on_segment(p, a, b);
  real least = length2(p - best);
  const real3 on_bc = nearest_on_segment(p, b, c), on_ca = nearest_on_segment(p, c, a);
  const real to_bc = length2(p - on_bc), to_ca = length2(p - on_ca);
  if (to_bc < least) {
    least = to_bc;
    best = on_bc;
  }
  if (to_ca < least) {
    least = to_ca;
    best = on_ca;
  }
  const real3 n = normal_of_edges(b - a, c - a);
  const real3 inside =
      (real3)(dot3(cross3(n, b - a), p - a), dot3(cross3(n, c - b), p - b), dot3(cross3(n, a - c), p - c));
  if (inside.x > 0 && inside.y > 0 && inside.z > 0) {
    // Measured from the edges' nearest point: over that short way a sliver's inexact normal does little.
    const real3 projected = p - n * dot3(n, p - best);
    if (length2(p - projected) < least) best = projected;
  }
  return best;
}

// Of the sphere's surface; from the centre, the point along x.
static inline real3 nearest_on_sphere(real3 p, real3 centre, real radius) {
  const real3 d = p - centre;
  const real distance = sqrt(length2(d));
  return centre + (distance > 0 ? d * (radius / distance) : (real3)(radius, 0, 0));
}

// Makes *best the primitive's nearest point if that is nearer; ties go to the smaller primitive.
static inline void nearest_on_primitive(Primitive primitive, uint index, real3 p, Nearest* best) {
  const real3 a = param3(primitive.a);
  real3 point;
  real distance2;
  if (primitive.kind == HR_PRIMITIVE_TRIANGLE) {
    point = nearest_on_triangle(p, a, param3(primitive.b), param3(primitive.c));
    distance2 = length2(p - point);
  } else {
    point = nearest_on_sphere(p, a, primitive.b.x);
    const real distance = sqrt(length2(p - a)) - primitive.b.x;
    distance2 = distance * distance;
  }
  if (!is_nearer(distance2, index, best)) return;
  best->distance2 = distance2;
  best->point = point;
  best->primitive = index;
}

#endif

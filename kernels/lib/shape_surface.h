// A shape at a hit: the point of it nearest to the ray's, its normal, and how exact both are.
#ifndef HR_LIB_SHAPE_SURFACE_H
#define HR_LIB_SHAPE_SURFACE_H

#include "lib/shape.h"

// A shape as f(p) = 0, positive on the front; `terms` bounds the sum of what is added up in f.
typedef struct ShapeValue {
  real f;
  real3 gradient;
  real terms;
} ShapeValue;

// L^T v: a gradient in the world.
static inline real3 gradient_to_world(global const Shape* s, real3 v) {
  return param3(s->to_own_x) * v.x + param3(s->to_own_y) * v.y + param3(s->to_own_z) * v.z;
}

// |L| v, a bound of what v >= 0 becomes.
static inline real3 error_to_own(global const Shape* s, real3 v) {
  return (real3)(dot3(fabs(param3(s->to_own_x)), v), dot3(fabs(param3(s->to_own_y)), v),
                 dot3(fabs(param3(s->to_own_z)), v));
}

// At p in the shape's frame. A cone's side as distance from the axis, less the radius.
static inline ShapeValue shape_value(global const Shape* s, int part, real3 p) {
  ShapeValue v = {p.z, (real3)(0, 0, 1), fabs(p.z)};
  if (s->kind == HR_SHAPE_CONE && part == HR_PART_SIDE) {
    const real3 form = param3(s->form);
    const real distance = square_root(p.x * p.x + p.y * p.y);
    v.f = distance - (form.x + form.y * p.z);
    v.gradient = distance > 0 ? (real3)(divide(p.x, distance), divide(p.y, distance), -form.y) : (real3)(0, 0, -form.y);
    v.terms = distance + form.x + fabs(form.y * p.z);
  } else if (s->kind == HR_SHAPE_CONE) {
    v.gradient.z = part == HR_PART_UPPER_CAP ? REAL(1.0) : REAL(-1.0);
    v.f = v.gradient.z * p.z - s->form.z;
    v.terms = s->form.z;
  } else if (s->kind == HR_SHAPE_QUADRIC) {
    const real3 linear = param3(s->linear), product = quadric_product(s, p), a = fabs(p);
    const real3 own = fabs(param3(s->form)), mixed = fabs(param3(s->mixed));
    v.f = dot3(p, product + linear * 2) + s->form.w;
    v.gradient = (product + linear) * 2;
    v.terms = own.x * a.x * a.x + own.y * a.y * a.y + own.z * a.z * a.z +
              2 * (mixed.x * a.x * a.y + mixed.y * a.y * a.z + mixed.z * a.z * a.x + dot3(fabs(linear), a)) +
              fabs(s->form.w);
  }
  return v;
}

// Two steps of Newton's method along the gradient: the first leaves the square of t's rounding error, the second
// nothing. What remains is the rounding of f and of L p, seen as a distance; as much again is what a ray that starts
// here makes of it. The last step counts as error too: at a quadric's apex, where the gradient is 0, a step only halves
// the distance. Across the normal an error does no harm: it leads along the surface.
static inline void shape_surface(global const Shape* s, real3 origin, real3 direction, const Hit* hit, real3* position,
                                 real3* error, real3* outward) {
  const real3 place = shape_place(s);
  real3 p = point_from_place(origin, direction, place, hit->t);
  *outward = -normalize3(direction);  // of a point without normal: a cone's apex
  real unsure = 0;
  for (int step = 0; step < 2; step++) {
    const ShapeValue v = shape_value(s, (int)hit->u, vector_to_own(s, p));
    const real3 n = gradient_to_world(s, v.gradient);
    const real n2 = dot3(n, n), steepness = square_root(n2);
    if (!(n2 > 0)) break;
    *outward = divide3(n, steepness);
    p -= n * divide(v.f, n2);
    unsure = (fabs(v.f) + v.terms * HR_GAMMA(12) + dot3(fabs(v.gradient), error_to_own(s, fabs(p))) * HR_GAMMA(8)) /
             steepness;
  }
  *position = place + p;
  *error = fabs(*outward) * (2 * unsure) + (fabs(place) + fabs(p)) * HR_GAMMA(3);
}

#endif

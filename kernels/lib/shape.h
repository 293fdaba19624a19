// Ray against shape: disk, truncated cone (cylinder), quadric. The ray is taken to the shape's own frame, beginning at
// its point nearest to the shape if it comes from far away, so that nothing is larger there than the shape and distance
// costs no digits (Haines et al. 2019, Ray Tracing Gems, ch. 7).
#ifndef HR_LIB_SHAPE_H
#define HR_LIB_SHAPE_H

#include "lib/intersect.h"
#include "lib/residual.h"

// A ray that passes the sphere around a shape by less than this share of its radius is looked at: a dozen roundings.
#define HR_SHAPE_REACH_SLACK REAL(1.000002)

// The part of a ray near a shape, in the shape's frame.
typedef struct OwnRay {
  real3 origin;
  real3 direction;
  real start;  // t of its origin on the world's ray
} OwnRay;

// Up to two hits with lo <= hi, as distances from OwnRay.start; lo = -infinity and hi = infinity are none.
typedef struct ShapeHits {
  real lo, hi;
  real lo_part, hi_part;
} ShapeHits;

// An interval of a ray; empty if in > out.
typedef struct Span {
  real in, out;
} Span;

static inline real3 shape_place(global const Shape* s) { return (real3)(s->to_own_x.w, s->to_own_y.w, s->to_own_z.w); }

// L v.
static inline real3 vector_to_own(global const Shape* s, real3 v) {
  return (real3)(dot3(param3(s->to_own_x), v), dot3(param3(s->to_own_y), v), dot3(param3(s->to_own_z), v));
}

// p(t) - place for the ray's point at t, rounded once but for t itself.
static inline real3 point_from_place(real3 origin, real3 direction, real3 place, real t) {
#pragma OPENCL FP_CONTRACT OFF
  const real3 from = origin - place;
  return fma(direction, (real3)(t), from) + rest_of_difference(origin, place, from);
}

// False if the ray passes far from the shape. From afar t is rounded by as much as the shape's size: how far the ray
// passes is measured across it.
static inline bool ray_to_own(const Ray* ray, global const Shape* s, OwnRay* own) {
#pragma OPENCL FP_CONTRACT OFF
  const real3 place = shape_place(s), direction = ray->direction;
  const real reach = s->lo.w * HR_SHAPE_REACH_SLACK, length2 = dot3(direction, direction);
  const real3 from = ray->origin - place;
  const bool starts_near = dot3(from, from) <= reach * reach;
  own->start = starts_near ? 0 : divide(-dot3(from, direction), length2);
  const real3 nearest = point_from_place(ray->origin, direction, place, own->start);
  if (!starts_near) {
    const real3 across = fma(direction, (real3)(divide(-dot3(nearest, direction), length2)), nearest);
    if (!(dot3(across, across) <= reach * reach)) return false;
  }
  own->origin = vector_to_own(s, nearest);
  own->direction = vector_to_own(s, direction);
  return true;
}

// Where |o + t d| <= half.
static inline Span slab_span(real o, real d, real half_size) {
#pragma OPENCL FP_CONTRACT OFF
  const real a = divide(-half_size - o, d), b = divide(half_size - o, d);
  Span span = {min(a, b), max(a, b)};
  if (d == 0) {
    span.in = fabs(o) <= half_size ? -INFINITY : INFINITY;
    span.out = -span.in;
  }
  return span;
}

static inline Span common_span(Span a, Span b) {
  const Span span = {max(a.in, b.in), min(a.out, b.out)};
  return span;
}

static inline bool is_in_span(Span span, real t) { return t >= span.in && t <= span.out; }

// The roots of a t^2 + 2 b t + c, given b^2 - a c = disc >= 0, without cancellation; infinite or NaN where there is
// none. The second is no larger than the first: where c / q is, b is small, and near a double root c and q are but
// rounding.
static inline Span quadratic_roots(real a, real b, real c, real disc) {
#pragma OPENCL FP_CONTRACT OFF
  const real root = copysign(square_root(disc), b), q = -(b + root);
  const real t0 = divide(q, a), t1 = q == 0 ? t0 : fabs(a * c) <= q * q ? divide(c, q) : divide(root - b, a);
  const Span roots = {min(t0, t1), max(t0, t1)};
  return roots;
}

static inline void intersect_disk(const OwnRay* r, real radius, ShapeHits* hits) {
#pragma OPENCL FP_CONTRACT OFF
  const real t = divide(-r->origin.z, r->direction.z);  // infinite or NaN along the plane
  const real x = fma(r->direction.x, t, r->origin.x), y = fma(r->direction.y, t, r->origin.y);
  if (x * x + y * y <= radius * radius) hits->lo = t;
}

// x^2 + y^2 = (mean + slope z)^2 between z = -half and half. With p = d.xy, m = o.xy, g the radius at o, e its growth
// along d: a = p^2 - e^2, b = m p - g e, c = m^2 - g^2, which long_dot() rounds once: of a ray that passes the apex
// along a generator little is left of them. And b^2 - a c = |g p - e m|^2 - (m x p)^2 (Lagrange's identity): the
// form of the smaller terms is taken, the latter at thin cylinders. A capped cone is convex: the ray is inside of it
// where it is inside of the side and between the caps, so none slips between side and cap.
static inline void intersect_cone(const OwnRay* r, real mean, real slope, real half_height, bool capped,
                                  ShapeHits* hits) {
#pragma OPENCL FP_CONTRACT OFF
  const real3 o = r->origin, d = r->direction;
  const real g = fma(slope, o.z, mean), e = slope * d.z;
  const LongReal3 at = {(real3)(o.x, o.y, g), (real3)(0)}, at_minus = {(real3)(o.x, o.y, -g), (real3)(0)};
  const LongReal3 along = {(real3)(d.x, d.y, e), (real3)(0)}, along_minus = {(real3)(d.x, d.y, -e), (real3)(0)};
  const real a = long_dot(along, along_minus), b = long_dot(at, along_minus), c = long_dot(at, at_minus);
  const real area = difference_of_products(o.x, d.y, o.y, d.x);
  const real vx = difference_of_products(g, d.x, e, o.x), vy = difference_of_products(g, d.y, e, o.y);
  const real disc = b * b < vx * vx + vy * vy ? difference_of_products(b, b, a, c)
                                              : fma(vx, vx, difference_of_products(vy, vy, area, area));
  if (!(disc >= 0) && a >= 0) return;
  const Span roots = quadratic_roots(a, b, c, max(disc, REAL(0.0)));  // through both halves of the cone: there are two
  const Span between = slab_span(o.z, d.z, half_height);
  if (!capped) {
    if (is_in_span(between, roots.in)) hits->lo = roots.in;
    if (is_in_span(between, roots.out)) hits->hi = roots.out;
    return;
  }
  Span side = roots;
  if (a < 0) {  // it stays inside of one half from a root on, or up to one
    side.in = e > 0 ? roots.out : -INFINITY;
    side.out = e > 0 ? INFINITY : roots.in;
  } else if (a == 0 && b == 0) {  // along the axis of a cylinder, or in a generator
    side.in = c <= 0 ? -INFINITY : INFINITY;
    side.out = -side.in;
  }
  const Span inside = common_span(side, between);
  if (!(inside.in <= inside.out)) return;
  hits->lo = inside.in;
  hits->hi = inside.out;
  if (between.in > side.in) hits->lo_part = d.z > 0 ? HR_PART_LOWER_CAP : HR_PART_UPPER_CAP;
  if (between.out < side.out) hits->hi_part = d.z > 0 ? HR_PART_UPPER_CAP : HR_PART_LOWER_CAP;
}

// A v.
static inline real3 quadric_product(global const Shape* s, real3 v) {
  const real3 own = param3(s->form), mixed = param3(s->mixed);
  return (real3)(own.x * v.x + mixed.x * v.y + mixed.z * v.z, mixed.x * v.x + own.y * v.y + mixed.y * v.z,
                 mixed.z * v.x + mixed.y * v.y + own.z * v.z);
}

static inline Span clip_span(global const Shape* s, const OwnRay* r) {
  const real3 o = r->origin, d = r->direction;
  Span span = {-INFINITY, INFINITY};
  if (s->flags & HR_SHAPE_CLIP_BOX) {
    const real3 half_size = param3(s->clip);
    span = common_span(common_span(slab_span(o.x, d.x, half_size.x), slab_span(o.y, d.y, half_size.y)),
                       slab_span(o.z, d.z, half_size.z));
  } else if (s->flags & HR_SHAPE_CLIP_SPHERE) {
    const real a = dot3(d, d), b = dot3(o, d), c = dot3(o, o) - s->clip.w * s->clip.w;
    const real disc = difference_of_products(b, b, a, c);
    if (disc >= 0) return quadratic_roots(a, b, c, disc);
    span.in = INFINITY;
    span.out = -INFINITY;
  }
  return span;
}

// The discriminant is taken about the chord's middle where that is nearer than the origin, as for spheres; the roots
// come from the origin, so that a ray which leaves the surface sees on which side of it it starts.
static inline void intersect_quadric(global const Shape* s, const OwnRay* r, ShapeHits* hits) {
#pragma OPENCL FP_CONTRACT OFF
  const real3 o = r->origin, d = r->direction, linear = param3(s->linear);
  const real3 slope = quadric_product(s, o) + linear;
  const real a = dot3(d, quadric_product(s, d)), b = dot3(d, slope);
  const real c = dot3(o, slope + linear) + s->form.w;
  const real3 middle = fma(d, (real3)(divide(-b, a)), o);
  real disc = difference_of_products(b, b, a, c);
  if (dot3(middle, middle) <= dot3(o, o)) {  // not where a is 0
    const real3 there = quadric_product(s, middle) + linear;
    const real rest = dot3(d, there);
    disc = difference_of_products(rest, rest, a, dot3(middle, there + linear) + s->form.w);
  }
  if (!(disc >= 0)) return;
  const Span roots = quadratic_roots(a, b, c, disc), clip = clip_span(s, r);
  if (is_in_span(clip, roots.in)) hits->lo = roots.in;
  if (is_in_span(clip, roots.out)) hits->hi = roots.out;
}

// The nearest hit beyond t_min; *part: what it is on, HR_PART_...
static inline bool intersect_shape(const Ray* ray, global const Shape* s, real* t, real* part) {
#pragma OPENCL FP_CONTRACT OFF
  OwnRay own;
  if (!ray_to_own(ray, s, &own)) return false;
  ShapeHits hits = {-INFINITY, INFINITY, HR_PART_SIDE, HR_PART_SIDE};
  if (s->kind == HR_SHAPE_DISK) {
    intersect_disk(&own, s->form.x, &hits);
  } else if (s->kind == HR_SHAPE_CONE) {
    intersect_cone(&own, s->form.x, s->form.y, s->form.z, (s->flags & HR_SHAPE_CAPPED) != 0, &hits);
  } else {
    intersect_quadric(s, &own, &hits);
  }
  const real lo = own.start + hits.lo, hi = own.start + hits.hi;
  const bool first = lo > ray->t_min;
  *t = first ? lo : hi;
  *part = first ? hits.lo_part : hits.hi_part;
  return *t > ray->t_min && *t < INFINITY;
}

#endif

// Ray against an implicit polynomial surface: its smallest root with a certificate, or a count of what cannot be told.
#ifndef HR_LIB_IMPLICIT_H
#define HR_LIB_IMPLICIT_H

#include "lib/intersect.h"
#include "lib/polynomial.h"
#include "lib/shape.h"

// How much beyond the clip roots are still taken: relative to the surface's size and the way to the clip's ends from
// the point of the ray nearest to it, more than these are rounded by.
#define HR_CLIP_PAD (64 * HR_HALF_ULP)

// The part of a ray within the clip: t in start + [near, far]. `start` is that of the point nearest to the surface if
// the ray comes from afar, so that near and far have the digits of the surface's size.
typedef struct ClipSpan {
  real start, near, far;
} ClipSpan;

static inline bool implicit_span(global const Shape* s, const Ray* ray, ClipSpan* span) {
  OwnRay own;
  if (!ray_to_own(ray, s, &own)) return false;
  const real3 d = own.direction, oc = own.origin - param3(s->linear);
  const real length2 = dot3(d, d);
  if (s->flags & HR_SHAPE_CLIP_SPHERE) {
    const real middle = -divide(dot3(oc, d), length2);
    const real3 closest = oc + d * middle;
    const real radius = s->clip.w * (1 + HR_CLIP_PAD) + HR_GAMMA(24) * (fabs(oc.x) + fabs(oc.y) + fabs(oc.z));
    const real rest = divide(radius * radius - dot3(closest, closest), length2);
    if (!(rest >= 0)) return false;
    span->near = middle - square_root(rest);
    span->far = middle + square_root(rest);
  } else {
    const real3 inverse = (real3)(safe_reciprocal(d.x), safe_reciprocal(d.y), safe_reciprocal(d.z));
    const real3 a = (-param3(s->clip) - oc) * inverse, b = (param3(s->clip) - oc) * inverse;
    const real3 lo = min(a, b), hi = max(a, b);
    span->near = max(max(lo.x, lo.y), lo.z);
    span->far = min(min(hi.x, hi.y), hi.z);
  }
  const real size = divide(s->lo.w, square_root(dot3(ray->direction, ray->direction)));
  const real pad = HR_CLIP_PAD * (fabs(span->near) + fabs(span->far) + size);
  span->start = own.start;
  span->near -= pad;
  span->far += pad;
  return span->near < span->far;
}

typedef struct ImplicitSearch {
  global const uint4* tapes;
  global const Shape* surface;
  real3 origin, direction;
  float m, h;  // t = m + h s
  ClipSpan clip;
  real t_min, t_far;
  ulong end;       // t_far as a place, or a little beyond
  uint uncertain;  // regions in front of the hit, or of nothing, in which there may be a root
} ImplicitSearch;

// The interval that is searched has the digits of t alone, so from afar it reaches beyond the clip.
static inline bool implicit_in_clip(const ImplicitSearch* search, HR_WIDE_NUM root) {
  const real t = HR_WIDE_REAL(HR_WIDE_LINEAR(HR_WIDE_OF(search->clip.start), HR_WIDE_OF(-1), root));
  return t >= search->clip.near && t <= search->clip.far;
}

// [t_lo, t_hi] could not be told as part of a longer interval. Its own series has smaller coefficients, so less error.
// Sets *t to the smallest root and returns HR_FIND_ROOT or HR_FIND_CLUSTER, or HR_FIND_NONE, counting what is open.
static inline uint implicit_look_closer(ImplicitSearch* search, HR_WIDE_ERR t_lo, HR_WIDE_ERR t_hi, HR_WIDE_NUM* t) {
#pragma OPENCL FP_CONTRACT OFF
  const HR_WIDE_ERR reach = t_hi - t_lo;
  const float lo = (float)max(t_lo - reach, (HR_WIDE_ERR)search->m - search->h);
  const float hi = (float)min(t_hi + reach, (HR_WIDE_ERR)search->m + search->h);
  // Rounded to float, outwards: that is all that is needed of a place to expand about.
  const float m = 0.5f * (lo + hi);
  const float h = max(nextafter(hi, (float)INFINITY) - m, m - nextafter(lo, -(float)INFINITY));
  HR_WIDE(Poly) p;
  HR_WIDE(poly_along)
  (search->tapes, search->surface, search->origin, search->direction, HR_WIDE_OF(m), HR_WIDE_OF(h), HR_MAX_DEGREE, &p);
  const HR_WIDE_ERR bound = HR_WIDE(poly_bound)(&p);
  ulong at = 0;
  int sign = 0;
  for (;;) {
    HR_WIDE(Find) find = HR_WIDE(poly_search)(&p, bound, at, HR_PLACE_END, sign, false);
    if (find.kind == HR_FIND_NONE) return HR_FIND_NONE;
    if (find.kind == HR_FIND_OPEN) {
      search->uncertain++;
      if (find.next >= HR_PLACE_END) return HR_FIND_NONE;
    } else {
      const HR_WIDE_NUM s =
          find.kind == HR_FIND_ROOT
              ? HR_WIDE(poly_refine)(&p, bound, find.sign_lo, &find.lo, &find.hi)
              : HR_WIDE_LINEAR(find.lo, HR_WIDE_OF(0.5f), HR_WIDE_LINEAR(find.hi, HR_WIDE_OF(0.5f), HR_WIDE_OF(0)));
      *t = HR_WIDE_LINEAR(s, HR_WIDE_OF(h), HR_WIDE_OF(m));
      return find.kind;
    }
    at = find.next;
    sign = find.sign_next;
  }
}

// From place `at` on, in the wide arithmetic.
static inline bool implicit_wide(ImplicitSearch* search, ulong at, int sign, real* t) {
#pragma OPENCL FP_CONTRACT OFF
  const HR_WIDE_NUM m = HR_WIDE_OF(search->m), h = HR_WIDE_OF(search->h);
  HR_WIDE(Poly) p;
  HR_WIDE(poly_along)
  (search->tapes, search->surface, search->origin, search->direction, m, h, HR_MAX_DEGREE, &p);
  const HR_WIDE_ERR bound = HR_WIDE(poly_bound)(&p);
  while (at < search->end) {
    HR_WIDE(Find) find = HR_WIDE(poly_search)(&p, bound, at, search->end, sign, false);
    if (find.kind == HR_FIND_NONE) return false;
    at = find.next;
    sign = find.sign_next;
    HR_WIDE_NUM root;
    if (find.kind == HR_FIND_ROOT) {
      root = HR_WIDE_LINEAR(HR_WIDE(poly_refine)(&p, bound, find.sign_lo, &find.lo, &find.hi), h, m);
    } else {
      const HR_WIDE_NUM t_lo = HR_WIDE_LINEAR(find.lo, h, m), t_hi = HR_WIDE_LINEAR(find.hi, h, m);
      if (implicit_look_closer(search, HR_WIDE_HIGH(t_lo), HR_WIDE_HIGH(t_hi), &root) == HR_FIND_NONE) {
        if (find.kind == HR_FIND_OPEN) continue;
        root = HR_WIDE_LINEAR(t_lo, HR_WIDE_OF(0.5f), HR_WIDE_LINEAR(t_hi, HR_WIDE_OF(0.5f), HR_WIDE_OF(0)));
      }
    }
    *t = HR_WIDE_REAL(root);
    if (*t > search->t_far) return false;
    if (*t > search->t_min && implicit_in_clip(search, root)) return true;
  }
  return false;
}

// A step of Newton's method leaves its square, in parts of the way through the clip: no more than the clip is padded
// by.
#define HR_LAST_STEP REAL(0.000244140625)

// A root that float has isolated in [s_lo, s_hi] to the precision of `real`: Newton's steps with value and slope in the
// wide arithmetic. Then the root tells, however far t is, on which side of the clip it lies. False if they do not
// settle within the bracket, which floats of t could not tell apart from its neighbours when seen from afar.
static inline bool implicit_polish(const ImplicitSearch* search, float s_lo, float s_hi, HR_WIDE_NUM* root) {
#pragma OPENCL FP_CONTRACT OFF
  const float s = 0.5f * (s_lo + s_hi), reach = (0.5f * (s_hi - s_lo) + 2 * HR_UNIT_F) * search->h;
  const HR_WIDE_NUM from = HR_WIDE_LINEAR(HR_WIDE_OF(s), HR_WIDE_OF(search->h), HR_WIDE_OF(search->m));
  const real size = 2 * max(fabs((real)HR_WIDE_HIGH(from)), (real)reach);
  const real enough = min(REAL(0.0625) * HR_HALF_ULP * size, HR_LAST_STEP * (search->clip.far - search->clip.near));
  HR_WIDE_NUM at = from;
  for (int i = 0; i < 5; i++) {
    HR_WIDE(Poly) p;
    HR_WIDE(poly_along)
    (search->tapes, search->surface, search->origin, search->direction, at, HR_WIDE_OF(1), 1, &p);
    if (p.degree == 0) return false;
    const HR_WIDE_NUM move = HR_WIDE_QUOTIENT(p.c[0], p.c[1]);
    at = HR_WIDE_LINEAR(move, HR_WIDE_OF(-1), at);
    if (!(fabs(HR_WIDE_HIGH(HR_WIDE_LINEAR(from, HR_WIDE_OF(-1), at))) <= reach)) return false;
    *root = at;
    if (fabs((real)HR_WIDE_HIGH(move)) <= enough) return true;
  }
  return false;
}

// Where to stop: the place in [-1, 1] of t_far, raised by more than its rounding.
static inline ulong implicit_end(float m, float h, real t_far) {
  if (!(t_far < (real)m + h)) return HR_PLACE_END;
  const float away = (float)(t_far - m) + 64 * HR_UNIT_F * (fabs((float)t_far) + fabs(m) + h);
  const float share = 0.5f + 0.5f * (float)divide(away, h);
  return share >= 1 ? HR_PLACE_END : share > 0 ? (ulong)(share * (float)HR_PLACE_END) : 0;
}

// The smallest t in (t_min, t_far] at which the ray meets the surface within its clip, whatever t_far beyond it is.
// *uncertain is raised by the number of regions in front of it that could be neither excluded nor found to hold a root.
static inline bool intersect_implicit(global const uint4* tapes, global const Shape* surface, const Ray* ray,
                                      real t_far, real* t, uint* uncertain) {
#pragma OPENCL FP_CONTRACT OFF
  ImplicitSearch search;
  if (!implicit_span(surface, ray, &search.clip)) return false;
  const real t0 = max(search.clip.start + search.clip.near, ray->t_min);
  const real t1 = min(search.clip.start + search.clip.far, ray->t_max);
  if (!(t0 <= t1) || t0 > t_far) return false;
  search.tapes = tapes;
  search.surface = surface;
  search.origin = ray->origin;
  search.direction = ray->direction;
  search.m = 0.5f * (float)(t0 + t1);
  search.h = max(nextafter((float)t1, (float)INFINITY) - search.m, search.m - nextafter((float)t0, -(float)INFINITY));
  search.t_min = ray->t_min;
  search.t_far = t_far;
  search.end = implicit_end(search.m, search.h, t_far);
  search.uncertain = 0;
  if (!(search.h < INFINITY)) return false;
  Poly_f p;
  poly_along_f(tapes, surface, ray->origin, ray->direction, search.m, search.h, HR_MAX_DEGREE, &p);
  const float bound = poly_bound_f(&p);
  Find_f find = poly_search_f(&p, bound, 0, search.end, 0, true);
  if (find.kind == HR_FIND_NONE) return false;
  ulong at = find.next;
  int sign = find.sign_next;
  if (find.kind == HR_FIND_ROOT) {
    poly_refine_f(&p, bound, find.sign_lo, &find.lo, &find.hi);
    HR_WIDE_NUM root;
    if (implicit_polish(&search, find.lo, find.hi, &root)) {
      *t = HR_WIDE_REAL(root);
      if (*t > t_far) return false;
      if (*t > ray->t_min && implicit_in_clip(&search, root)) return true;
    } else {  // from the beginning: `at` is behind the root
      at = 0;
      sign = 0;
    }
  }
  const bool hit = implicit_wide(&search, at, sign, t);
  *uncertain += search.uncertain;
  return hit;
}

// The point at t, moved onto the surface by one Newton step along the gradient; `error` bounds what is left per axis,
// the step itself included. `normal` is the unit gradient, or against the ray where the gradient is not certain.
static inline void implicit_surface(global const uint4* tapes, global const Shape* surface, real3 origin,
                                    real3 direction, real t, real3* position, real3* error, real3* normal) {
#pragma OPENCL FP_CONTRACT OFF
  const real3 p = origin + direction * t;
  real value = 0, value_error = 0, gradient[3];
  HR_WIDE(Poly) axis[3], f;
  HR_WIDE(poly_line)(surface, origin, direction, HR_WIDE_OF(t), HR_WIDE_OF(0), axis);
  for (int k = 0; k < 3; k++) {
    for (int j = 0; j < 3; j++) axis[j].c[1] = HR_WIDE_OF(j == k ? 1 : 0);
    HR_WIDE(poly_evaluate)(tapes + as_uint(surface->form.x), as_uint(surface->form.y), axis, 1, &f);
    value = HR_WIDE_REAL(f.c[0]);
    gradient[k] = f.degree > 0 ? HR_WIDE_REAL(f.c[1]) : 0;
    value_error = max(value_error, (real)f.error);
  }
  // First to a size that can be squared.
  const real largest = max(max(fabs(gradient[0]), fabs(gradient[1])), fabs(gradient[2]));
  const bool good = largest > 4 * value_error && largest < INFINITY;
  const real scale = good ? divide(1, largest) : 0;
  const real3 own = (real3)(gradient[0], gradient[1], gradient[2]) * scale;
  const real3 g =
      param3(surface->to_own_x) * own.x + param3(surface->to_own_y) * own.y + param3(surface->to_own_z) * own.z;
  const real length2 = dot3(g, g);
  if (!good || !(length2 > 0)) {
    *normal = -normalize3(direction);
    *position = p;
    *error = (fabs(origin) + fabs(direction * t)) * HR_GAMMA(3);
    return;
  }
  const real steepness = square_root(length2);
  *normal = g * divide(1, steepness);
  const real3 away = g * divide(value * scale, length2);
  const real left = divide(value_error * scale, steepness);
  *position = p - away;
  *error = (fabs(origin) + fabs(direction * t)) * HR_GAMMA(3) + fabs(away) + fabs(*normal) * left;
}

#endif

// Ray against box, triangle, sphere and plane, in watertight form.
#ifndef HR_LIB_INTERSECT_H
#define HR_LIB_INTERSECT_H

#include "lib/edge_function.h"
#include "lib/thin_triangle.h"
#include "lib/vec.h"
#include "shared/bvh_types.h"
#include "shared/features.h"
#include "shared/scene_types.h"

// Far slab distances are raised by 8 ulps, so that rounding never shrinks a box (Ize 2013, "Robust BVH Ray Traversal"):
// along two axes a reciprocal may err by 2.5 ulps, as OpenCL allows, and up to three more roundings by half an ulp
// each.
#define HR_SLAB_PAD REAL(1.000001)

// A direction component nearer to zero than this is taken as this, which keeps reciprocals finite: over any distance a
// float can hold a position in, such a ray leaves its plane by less than half an ulp.
#define HR_TINY_DIRECTION REAL(1e-18)

typedef struct Ray {
  real3 origin;
  real3 direction;
  real3 inverse;  // 1 / direction, finite
  real t_min, t_max;
  // Shear that maps the direction to (0, 0, 1) (Woop, Benthin, Wald 2013).
  int kx, ky, kz;
  real sx, sy, sz;
  real3 shear_origin;  // origin along kx, ky, kz
} Ray;

typedef struct Hit {
  real t, u, v;
  uint primitive;
} Hit;

static inline real safe_reciprocal(real d) {
  return divide(1, fabs(d) < HR_TINY_DIRECTION ? copysign(HR_TINY_DIRECTION, d) : d);
}

static inline Ray make_ray(real3 origin, real3 direction, real t_min, real t_max) {
  Ray r;
  r.origin = origin;
  r.direction = direction;
  r.inverse = (real3)(safe_reciprocal(direction.x), safe_reciprocal(direction.y), safe_reciprocal(direction.z));
  r.t_min = t_min;
  r.t_max = t_max;
  const real3 a = fabs(direction);
  r.kz = a.x > a.y ? (a.x > a.z ? 0 : 2) : (a.y > a.z ? 1 : 2);
  r.kx = r.kz == 2 ? 0 : r.kz + 1;
  r.ky = r.kx == 2 ? 0 : r.kx + 1;
  const real dz = pick(direction, r.kz);
  if (dz < 0) {  // keeps the winding
    const int swap = r.kx;
    r.kx = r.ky;
    r.ky = swap;
  }
  r.sz = pick(r.inverse, r.kz);  // the longest component is none of those that safe_reciprocal() changes
  r.sx = pick(direction, r.kx) * r.sz;
  r.sy = pick(direction, r.ky) * r.sz;
  r.shear_origin = (real3)(pick(origin, r.kx), pick(origin, r.ky), pick(origin, r.kz));
  return r;
}

// The same, as one box from lo to hi [m]: enters it at *t_near if it meets it before t_far. Subtract first, multiply
// after: fma(plane, inverse, -origin * inverse) loses rays far from the origin.
static inline bool intersect_box(const Ray* ray, real3 lo, real3 hi, real t_far, real* t_near) {
#pragma OPENCL FP_CONTRACT OFF
  const real3 t_lo = (lo - ray->origin) * ray->inverse;
  const real3 t_hi = (hi - ray->origin) * ray->inverse;
  const real3 t_in = min(t_lo, t_hi), t_out = max(t_lo, t_hi);
  *t_near = max(max(ray->t_min, t_in.x), max(t_in.y, t_in.z));
  return *t_near <= min(min(t_out.x, t_out.y), min(t_out.z, t_far)) * HR_SLAB_PAD;
}

// Woop, Benthin, Wald 2013, "Watertight Ray/Triangle Intersection". Products are rounded alike on both sides of a
// shared edge, so an edge function's sign is right or zero: no ray slips between neighbours. A zero is then found
// exactly: counted as inside at once, it would let small triangles be met by rays that pass far from them, where the
// rounding of products is larger than their area. So a hit is one of the sheared vertices as rounded, which lie within
// some ulps of |vertex - origin| of where they should. The scalar twin of block_candidates() in leaf_block.h, operation
// for operation.
static inline bool intersect_triangle(const Ray* ray, real3 a, real3 b, real3 c, real* t, real* u, real* v) {
#pragma OPENCL FP_CONTRACT OFF
  const real az = pick(a, ray->kz) - ray->shear_origin.z;
  const real bz = pick(b, ray->kz) - ray->shear_origin.z;
  const real cz = pick(c, ray->kz) - ray->shear_origin.z;
  const real ax = fma(-ray->sx, az, pick(a, ray->kx) - ray->shear_origin.x);
  const real ay = fma(-ray->sy, az, pick(a, ray->ky) - ray->shear_origin.y);
  const real bx = fma(-ray->sx, bz, pick(b, ray->kx) - ray->shear_origin.x);
  const real by = fma(-ray->sy, bz, pick(b, ray->ky) - ray->shear_origin.y);
  const real cx = fma(-ray->sx, cz, pick(c, ray->kx) - ray->shear_origin.x);
  const real cy = fma(-ray->sy, cz, pick(c, ray->ky) - ray->shear_origin.y);
  real wa = cx * by - cy * bx;
  real wb = ax * cy - ay * cx;
  real wc = bx * ay - by * ax;
  if (!(min(min(wa, wb), wc) >= 0 || max(max(wa, wb), wc) <= 0)) return false;
  if (wa == 0 || wb == 0 || wc == 0) {  // their product underflows for small triangles
    wa = exact_edge_function(cx, cy, bx, by);
    wb = exact_edge_function(ax, ay, cx, cy);
    wc = exact_edge_function(bx, by, ax, ay);
    if (!(min(min(wa, wb), wc) >= 0 || max(max(wa, wb), wc) <= 0)) return false;
  }
  real det = wa + wb + wc;
  if (det == 0) return false;
  real depth_det = fma(wa, az, fma(wb, bz, wc * cz));
  const real nearest = min(min(az, bz), cz), farthest = max(max(az, bz), cz);
  const bool thin = HR_HAS(THIN_TRIANGLES) &&
                    HR_IS_THIN(farthest - nearest,
                               max(max(max(fabs(ax), fabs(ay)), max(fabs(bx), fabs(by))), max(fabs(cx), fabs(cy))),
                               max(fabs(nearest), fabs(farthest)), depth_det);
  if (thin) {  // the signs stay as they are
    wa = exact_edge_function(cx, cy, bx, by);
    wb = exact_edge_function(ax, ay, cx, cy);
    wc = exact_edge_function(bx, by, ax, ay);
    det = wa + wb + wc;
    depth_det = fma(wa, az, fma(wb, bz, wc * cz));
  }
  const real inverse_det = divide(1, det);
  *t = ray->sz * depth_det * inverse_det;
  *u = wb * inverse_det;
  *v = wc * inverse_det;
  if (thin) {
    *t = thin_triangle_t(ray->origin, ray->direction, a, b, c, ray->sz * nearest, ray->sz * farthest, *t);
  }
  return *t > ray->t_min;
}

// The fast test: volumes of the ray with the triangle's edges (Möller and Trumbore 1997; Kensler and Shirley 2006),
// from vertex a and the edges e1 = a - b, e2 = c - a. Edges of neighbours are rounded apart: rays can slip between
// them.
static inline bool intersect_triangle_fast(const Ray* ray, real3 a, real3 e1, real3 e2, real* t, real* u, real* v) {
  const real3 n = cross3(e2, e1);
  const real3 o = a - ray->origin;
  const real3 r = cross3(o, ray->direction);
  const real det = dot3(n, ray->direction);
  const real sign = det < 0 ? -REAL(1.0) : REAL(1.0), size = fabs(det);
  const real su = dot3(r, e2) * sign, sv = dot3(r, e1) * sign;
  if (!(su >= 0 && sv >= 0 && su + sv <= size && size > 0)) return false;
  const real inverse_det = divide(1, size);
  *t = dot3(n, o) * sign * inverse_det;
  *u = su * inverse_det;
  *v = sv * inverse_det;
  return *t > ray->t_min;
}

// Smaller root beyond t_min. The discriminant is taken from the vector to the chord's middle, whose t is then corrected
// by what that vector lacks of a right angle to the ray; the root nearer to the origin comes from the product of both
// where it would cancel (Haines et al., Ray Tracing Gems, ch. 7). So t is off by a few ulps of itself, however far or
// small the sphere.
static inline bool intersect_sphere(const Ray* ray, real3 center, real radius, real* t) {
  const real3 oc = ray->origin - center;
  const real length2 = dot3(ray->direction, ray->direction);
  const real b = -dot3(oc, ray->direction), about = divide(b, length2);
  const real3 near_middle = fma(ray->direction, (real3)(about), oc);  // cancels: no product may be rounded before
  const real off = divide(dot3(near_middle, ray->direction), length2), t_middle = about - off;
  const real3 middle = fma(ray->direction, (real3)(-off), near_middle);
  const real disc = length2 * (radius * radius - dot3(middle, middle));
  if (!(disc >= 0)) return false;
  const real root = square_root(disc), chord = divide(root, length2);  // half of it
  const real t0 = t_middle >= 0 ? t_middle + chord : t_middle - chord;
  real t1 = t_middle >= 0 ? t_middle - chord : t_middle + chord;
  if (chord > REAL(0.5) * fabs(t_middle)) {
    const real q = b >= 0 ? b + root : b - root;  // length2 t0
    if (q != 0) t1 = divide(dot3(oc, oc) - radius * radius, q);
  }
  const real lo = min(t0, t1), hi = max(t0, t1);
  *t = lo > ray->t_min ? lo : hi;
  return *t > ray->t_min;
}

static inline bool intersect_plane(const Ray* ray, real3 point, real3 normal, real* t) {
  const real cosine = dot3(ray->direction, normal);
  if (cosine == 0) return false;
  *t = divide(dot3(point - ray->origin, normal), cosine);
  return *t > ray->t_min;
}

#endif

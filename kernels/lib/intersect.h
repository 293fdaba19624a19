// Ray against box, triangle, sphere and plane, in watertight form.
#ifndef HR_LIB_INTERSECT_H
#define HR_LIB_INTERSECT_H

#include "lib/vec.h"
#include "shared/bvh_types.h"
#include "shared/scene_types.h"

// Far slab distances are raised by 3 ulps, so that rounding never shrinks a box (Ize 2013, "Robust BVH Ray Traversal").
#define HR_SLAB_PAD REAL(1.0000004)

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
} Ray;

typedef struct Hit {
  real t, u, v;
  uint primitive;
} Hit;

static inline real safe_reciprocal(real d) {
  return 1 / (fabs(d) < HR_TINY_DIRECTION ? copysign(HR_TINY_DIRECTION, d) : d);
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
  r.sz = 1 / dz;
  r.sx = pick(direction, r.kx) * r.sz;
  r.sy = pick(direction, r.ky) * r.sz;
  return r;
}

// Which of a node's two boxes the ray meets before t_far; *t_near is where it enters them. Subtract first, multiply
// after: fma(plane, inverse, -origin * inverse) loses rays far from the origin.
static inline int2 intersect_boxes(const Ray* ray, const BvhNode* node, real t_far, real2* t_near) {
#pragma OPENCL FP_CONTRACT OFF
  const real4 x = (real4)(node->x.x, node->x.y, node->x.z, node->x.w) - ray->origin.x;
  const real4 y = (real4)(node->y.x, node->y.y, node->y.z, node->y.w) - ray->origin.y;
  const real4 z = (real4)(node->z.x, node->z.y, node->z.z, node->z.w) - ray->origin.z;
  const real4 tx = x * ray->inverse.x, ty = y * ray->inverse.y, tz = z * ray->inverse.z;
  const real2 near_x = min(tx.xz, tx.yw), near_y = min(ty.xz, ty.yw), near_z = min(tz.xz, tz.yw);
  const real2 far_x = max(tx.xz, tx.yw), far_y = max(ty.xz, ty.yw), far_z = max(tz.xz, tz.yw);
  *t_near = max(max(near_x, near_y), max(near_z, (real2)(ray->t_min)));
  const real2 t_exit = min(min(far_x, far_y), min(far_z, (real2)(t_far))) * HR_SLAB_PAD;
  return *t_near <= t_exit;
}

// Woop, Benthin, Wald 2013, "Watertight Ray/Triangle Intersection". Products are rounded alike on both sides of a
// shared edge, so an edge function's sign is right or zero, and zero counts as inside: no ray slips between neighbours.
static inline bool intersect_triangle(const Ray* ray, real3 a, real3 b, real3 c, real* t, real* u, real* v) {
#pragma OPENCL FP_CONTRACT OFF
  const real3 pa = a - ray->origin;
  const real3 pb = b - ray->origin;
  const real3 pc = c - ray->origin;
  const real az = pick(pa, ray->kz), bz = pick(pb, ray->kz), cz = pick(pc, ray->kz);
  const real ax = fma(-ray->sx, az, pick(pa, ray->kx)), ay = fma(-ray->sy, az, pick(pa, ray->ky));
  const real bx = fma(-ray->sx, bz, pick(pb, ray->kx)), by = fma(-ray->sy, bz, pick(pb, ray->ky));
  const real cx = fma(-ray->sx, cz, pick(pc, ray->kx)), cy = fma(-ray->sy, cz, pick(pc, ray->ky));
  const real wa = cx * by - cy * bx;
  const real wb = ax * cy - ay * cx;
  const real wc = bx * ay - by * ax;
  const bool inside = (wa >= 0 && wb >= 0 && wc >= 0) || (wa <= 0 && wb <= 0 && wc <= 0);
  const real det = wa + wb + wc;
  if (!inside || det == 0) return false;
  const real scaled_t = wa * (ray->sz * az) + wb * (ray->sz * bz) + wc * (ray->sz * cz);
  *t = scaled_t / det;
  *u = wb / det;
  *v = wc / det;
  return *t > ray->t_min;
}

// Smaller root beyond t_min. The discriminant is taken from the vector to the chord's middle, and the roots from
// q = b + sign(b) sqrt(disc), so that nothing cancels for far or small spheres (Haines et al., Ray Tracing Gems, ch.
// 7).
static inline bool intersect_sphere(const Ray* ray, real3 center, real radius, real* t) {
  const real3 oc = ray->origin - center;
  const real length2 = dot3(ray->direction, ray->direction);
  const real b = -dot3(oc, ray->direction);
  const real3 middle = oc + ray->direction * (b / length2);
  const real disc = length2 * (radius * radius - dot3(middle, middle));
  if (!(disc >= 0)) return false;
  const real root = sqrt(disc);
  const real q = b >= 0 ? b + root : b - root;
  const real c = dot3(oc, oc) - radius * radius;
  const real t0 = q / length2;
  const real t1 = q != 0 ? c / q : t0;
  const real lo = min(t0, t1), hi = max(t0, t1);
  *t = lo > ray->t_min ? lo : hi;
  return *t > ray->t_min;
}

static inline bool intersect_plane(const Ray* ray, real3 point, real3 normal, real* t) {
  const real cosine = dot3(ray->direction, normal);
  if (cosine == 0) return false;
  *t = dot3(point - ray->origin, normal) / cosine;
  return *t > ray->t_min;
}

#endif

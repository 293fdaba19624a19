// A ray against all triangles of a leaf's block at once, on devices with explicit vectors: which it may meet.
#ifndef HR_LIB_LEAF_VECTORS_H
#define HR_LIB_LEAF_VECTORS_H

#include "lib/leaf_lane.h"

#if HR_EXPLICIT_VECTORS && HR_L > 1

#define HR_FLOATL HR_PASTE(float, HR_L)
#define HR_INTL HR_PASTE(int, HR_L)
#define HR_AS_INTL HR_PASTE(as_int, HR_L)
#define HR_AS_FLOATL HR_PASTE(as_float, HR_L)
#define HR_LANES_OF_L HR_PASTE(lanes_of, HR_L)
#define HR_ROW(r) (*(global const HR_FLOATL*)(block + (r)*HR_L))
#define HR_FLIP(v) HR_AS_FLOATL(HR_AS_INTL(v) ^ sign)

// As divide() in lib/divide.h.
static inline HR_FLOATL reciprocals(HR_FLOATL a) {
#if HR_OWN_DIVIDE
  float lanes[HR_L];
  HR_STORE(HR_L, a, lanes);
  for (uint i = 0; i < HR_L; i++) lanes[i] = divide(1, lanes[i]);
  return HR_PASTE(vload, HR_L)(0, lanes);
#else
  return 1.0f / a;
#endif
}

// What the lanes' hits are, before division: t = t_det / det and so on.
typedef struct BlockHits {
  HR_FLOATL t_det, u_det, v_det, det;
} BlockHits;

// The triangles of a block that the ray may meet before t_far; what rounding of t leaves open is let through, and in
// watertight form what lies on an edge for all that rounding tells, or is thin, or has no area: see is_doubtful().
static inline LaneSet block_candidates(BlockNumbers numbers, global const float* block, const Ray* ray, real t_far,
                                       BlockHits* hits) {
#if HR_TRIANGLE_WATERTIGHT
#pragma OPENCL FP_CONTRACT OFF
  const HR_FLOATL sx = (HR_FLOATL)(-ray->sx), sy = (HR_FLOATL)(-ray->sy);
  const HR_FLOATL az = HR_ROW(ray->kz) - ray->shear_origin.z;
  const HR_FLOATL bz = HR_ROW(3 + ray->kz) - ray->shear_origin.z;
  const HR_FLOATL cz = HR_ROW(6 + ray->kz) - ray->shear_origin.z;
  const HR_FLOATL ax = fma(sx, az, HR_ROW(ray->kx) - ray->shear_origin.x);
  const HR_FLOATL ay = fma(sy, az, HR_ROW(ray->ky) - ray->shear_origin.y);
  const HR_FLOATL bx = fma(sx, bz, HR_ROW(3 + ray->kx) - ray->shear_origin.x);
  const HR_FLOATL by = fma(sy, bz, HR_ROW(3 + ray->ky) - ray->shear_origin.y);
  const HR_FLOATL cx = fma(sx, cz, HR_ROW(6 + ray->kx) - ray->shear_origin.x);
  const HR_FLOATL cy = fma(sy, cz, HR_ROW(6 + ray->ky) - ray->shear_origin.y);
  const HR_FLOATL wa = cx * by - cy * bx;
  const HR_FLOATL wb = ax * cy - ay * cx;
  const HR_FLOATL wc = bx * ay - by * ax;
  const HR_FLOATL det = wa + wb + wc;
  const HR_INTL sign = HR_AS_INTL(det) & (HR_INTL)(0x80000000);
  hits->det = fabs(det);
  const HR_FLOATL depth_det = fma(wa, az, fma(wb, bz, wc * cz));
  hits->t_det = HR_FLIP(ray->sz * depth_det);
  hits->u_det = HR_FLIP(wb);
  hits->v_det = HR_FLIP(wc);
  const HR_FLOATL least = min(min(wa, wb), wc), most = max(max(wa, wb), wc);
  // On an edge, for all that rounding tells, t is only that of some point of the triangle.
  const HR_INTL in_range = (hits->t_det >= 0.0f) & (hits->t_det <= hits->det * (t_far * HR_SLAB_PAD));
  HR_INTL unsure = least * most == 0.0f;
  if (HR_HAS(THIN_TRIANGLES)) {
    const HR_FLOATL nearest = min(min(az, bz), cz), farthest = max(max(az, bz), cz);
    const HR_FLOATL reach = max(max(max(fabs(ax), fabs(ay)), max(fabs(bx), fabs(by))), max(fabs(cx), fabs(cy)));
    const HR_INTL thin = HR_IS_THIN(farthest - nearest, reach, max(fabs(nearest), fabs(farthest)), depth_det);
    // Wherever t is, it is between those of the vertices.
    const HR_FLOATL first = ray->sz < 0 ? farthest : nearest, last = ray->sz < 0 ? nearest : farthest;
    unsure |= thin & (ray->sz * first <= t_far * HR_SLAB_PAD) & (ray->sz * last >= 0.0f);
    hits->u_det = HR_AS_FLOATL(HR_AS_INTL(hits->u_det) | (thin & (HR_INTL)(0x80000000)));  // negative: doubtful
  }
  HR_INTL met = ((least >= 0.0f) | (most <= 0.0f)) & (in_range | unsure);
#else
  const HR_FLOATL ox = HR_ROW(0) - ray->origin.x, oy = HR_ROW(1) - ray->origin.y, oz = HR_ROW(2) - ray->origin.z;
  const HR_FLOATL e1x = HR_ROW(3), e1y = HR_ROW(4), e1z = HR_ROW(5);
  const HR_FLOATL e2x = HR_ROW(6), e2y = HR_ROW(7), e2z = HR_ROW(8);
  const HR_FLOATL nx = e2y * e1z - e2z * e1y, ny = e2z * e1x - e2x * e1z, nz = e2x * e1y - e2y * e1x;
  const real3 d = ray->direction;
  const HR_FLOATL rx = oy * d.z - oz * d.y, ry = oz * d.x - ox * d.z, rz = ox * d.y - oy * d.x;
  const HR_FLOATL det = nx * d.x + ny * d.y + nz * d.z;
  const HR_INTL sign = HR_AS_INTL(det) & (HR_INTL)(0x80000000);
  hits->det = fabs(det);
  hits->t_det = HR_FLIP(nx * ox + ny * oy + nz * oz);
  hits->u_det = HR_FLIP(rx * e2x + ry * e2y + rz * e2z);
  hits->v_det = HR_FLIP(rx * e1x + ry * e1y + rz * e1z);
  HR_INTL met = (hits->u_det >= 0.0f) & (hits->v_det >= 0.0f) & (hits->u_det + hits->v_det <= hits->det);
  met &= (hits->t_det > 0.0f) & (hits->t_det <= hits->det * (t_far * HR_SLAB_PAD)) & (hits->det > 0.0f);
#endif
  if (HR_HAS_ONE_BY_ONE) {
    const HR_INTL primitive = *(global const HR_INTL*)(block + HR_BLOCK_PRIMITIVE_ROW * HR_L);
    met &= primitive < (HR_INTL)((int)numbers.triangles);
  }
  return HR_LANES_OF_L(met);
}

// u + v of a hit that is surely off the third edge: of one on it, 1 less than 8 roundings.
#define HR_SURELY_INSIDE 0.999999f

// Which candidates intersect_lane() has to look at, since an edge function may be 0 or t too inexact. Rarely any.
static inline bool is_doubtful(real u, real v) {
  return HR_TRIANGLE_WATERTIGHT ? !(u > 0 && v > 0 && u + v < HR_SURELY_INSIDE) : false;
}

static inline LaneSet doubtful_lanes(const BlockHits* hits) {
  if (!HR_TRIANGLE_WATERTIGHT) return 0;
  return HR_LANES_OF_L(
      ~((hits->u_det > 0.0f) & (hits->v_det > 0.0f) & (hits->u_det + hits->v_det < hits->det * HR_SURELY_INSIDE)));
}

// Lanes that hold no triangle but something. HR_NO_PRIMITIVE is negative here.
static inline LaneSet other_lanes(BlockNumbers numbers, global const float* block) {
  const HR_INTL primitive = *(global const HR_INTL*)(block + HR_BLOCK_PRIMITIVE_ROW * HR_L);
  return HR_LANES_OF_L(primitive >= (HR_INTL)((int)numbers.triangles));
}

#endif

#endif

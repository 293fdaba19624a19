// A ray against one block of a leaf: HR_L primitives side by side, a row a coordinate (shared/bvh_types.h).
#ifndef HR_LIB_LEAF_BLOCK_H
#define HR_LIB_LEAF_BLOCK_H

#include "lib/accel_layout.h"
#include "lib/intersect.h"
#include "lib/lanes.h"
#include "lib/scene_view.h"
#include "lib/shape.h"

#if HR_HAS(IMPLICITS)  // much text, which costs compilers time
#include "lib/implicit.h"
#endif

// Blocks may hold what is not a triangle, and is tested lane by lane.
#define HR_HAS_ONE_BY_ONE (HR_HAS(SPHERES) || HR_HAS(SHAPES))

// Primitives a ray must not meet: the one it left, and those of the light it is traced to (inclusive range, which is
// empty if skip_first > skip_last).
typedef struct Skip {
  uint self;
  uint first, last;
} Skip;

// What the numbers in a tree's blocks mean.
typedef struct BlockNumbers {
  uint first;      // added to one, makes it a primitive index
  uint triangles;  // those below are triangles
  uint shapes;     // those from here on are shapes, what is between them spheres
  global const Shape* shape_array;
  global const uint4* tapes;
  global uint* uncertain_roots;
} BlockNumbers;

static inline BlockNumbers world_numbers(const SceneView* view) {
  const BlockNumbers numbers = {0,           view->triangle_count, first_shape(view), view->shapes,
                                view->tapes, view->uncertain_roots};
  return numbers;
}

static inline bool is_skipped(const Skip* skip, uint primitive) {
  return primitive == skip->self || (primitive >= skip->first && primitive <= skip->last);
}

static inline bool is_closer(const Hit* candidate, const Hit* best) {
  return candidate->t < best->t || (candidate->t == best->t && candidate->primitive < best->primitive);
}

static inline uint block_primitive(global const float* block, uint lane) {
  return ((global const uint*)block)[HR_BLOCK_PRIMITIVE_ROW * HR_L + lane];
}

static inline real3 block_point(global const float* block, uint row, uint lane) {
  return (real3)(block[row * HR_L + lane], block[(row + 1) * HR_L + lane], block[(row + 2) * HR_L + lane]);
}

// One lane by itself: spheres, shapes, and triangles on devices without explicit vectors. What lies beyond t_far need
// not be found.
static inline bool intersect_lane(BlockNumbers numbers, global const float* block, uint lane, const Ray* ray,
                                  real t_far, Hit* candidate) {
  const uint number = block_primitive(block, lane);
  if (number == HR_NO_PRIMITIVE) return false;
  candidate->primitive = numbers.first + number;
  candidate->u = 0;
  candidate->v = 0;
  if (HR_HAS(SHAPES) && number >= numbers.shapes && number >= numbers.triangles) {
    global const Shape* shape = numbers.shape_array + (number - numbers.shapes);
#if HR_HAS(IMPLICITS)
    if (shape->kind == HR_SHAPE_IMPLICIT) {
      uint uncertain = 0;
      const bool hit = intersect_implicit(numbers.tapes, shape, ray, t_far, &candidate->t, &uncertain);
      if (HR_UNLIKELY(uncertain != 0)) atomic_add(numbers.uncertain_roots, uncertain);
      return hit;
    }
#endif
    return intersect_shape(ray, shape, &candidate->t, &candidate->u);
  }
  const real3 a = block_point(block, 0, lane);
  if (HR_HAS(SPHERES) && number >= numbers.triangles) {
    return intersect_sphere(ray, a, block[3 * HR_L + lane], &candidate->t);
  }
  const real3 b = block_point(block, 3, lane), c = block_point(block, 6, lane);
  if (HR_TRIANGLE_WATERTIGHT) return intersect_triangle(ray, a, b, c, &candidate->t, &candidate->u, &candidate->v);
  return intersect_triangle_fast(ray, a, b, c, &candidate->t, &candidate->u, &candidate->v);
}

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

static inline void intersect_block_closest(BlockNumbers numbers, global const float* block, const Ray* ray,
                                           const Skip* skip, Hit* best) {
  BlockHits hits;
  LaneSet lanes = block_candidates(numbers, block, ray, best->t, &hits);
  if (lanes) {
    float t[HR_L], u[HR_L], v[HR_L];
    const HR_FLOATL inverse_det = reciprocals(hits.det);
    HR_STORE(HR_L, hits.t_det * inverse_det, t);
    HR_STORE(HR_L, hits.u_det * inverse_det, u);
    HR_STORE(HR_L, hits.v_det * inverse_det, v);
    do {
      const uint lane = first_lane(lanes);
      lanes = without_first(lanes);
      Hit candidate = {t[lane], u[lane], v[lane], numbers.first + block_primitive(block, lane)};
      if (HR_UNLIKELY(is_doubtful(candidate.u, candidate.v))) {
        if (!intersect_lane(numbers, block, lane, ray, best->t, &candidate)) continue;
      }
      const bool counts = candidate.t > ray->t_min && is_closer(&candidate, best);
      if (counts && !is_skipped(skip, candidate.primitive)) *best = candidate;
    } while (lanes);
  }
  if (HR_HAS_ONE_BY_ONE) {
    for (LaneSet rest = other_lanes(numbers, block); rest; rest = without_first(rest)) {
      Hit candidate;
      if (intersect_lane(numbers, block, first_lane(rest), ray, best->t, &candidate) && is_closer(&candidate, best) &&
          !is_skipped(skip, candidate.primitive)) {
        *best = candidate;
      }
    }
  }
}

static inline bool intersect_block_any(BlockNumbers numbers, global const float* block, const Ray* ray,
                                       const Skip* skip) {
  BlockHits hits;
  LaneSet lanes = block_candidates(numbers, block, ray, ray->t_max, &hits);
  if (lanes) {
    float t[HR_L];
    HR_STORE(HR_L, hits.t_det * reciprocals(hits.det), t);
    const LaneSet doubtful = doubtful_lanes(&hits);
    do {
      const uint lane = first_lane(lanes);
      lanes = without_first(lanes);
      if (HR_UNLIKELY((doubtful & lane_bit(lane)) != 0)) {
        Hit exact;
        if (!intersect_lane(numbers, block, lane, ray, ray->t_max, &exact)) continue;
        t[lane] = exact.t;
      }
      if (t[lane] > ray->t_min && t[lane] < ray->t_max &&
          !is_skipped(skip, numbers.first + block_primitive(block, lane))) {
        return true;
      }
    } while (lanes);
  }
  if (HR_HAS_ONE_BY_ONE) {
    for (LaneSet rest = other_lanes(numbers, block); rest; rest = without_first(rest)) {
      Hit candidate;
      if (intersect_lane(numbers, block, first_lane(rest), ray, ray->t_max, &candidate) && candidate.t < ray->t_max &&
          !is_skipped(skip, candidate.primitive)) {
        return true;
      }
    }
  }
  return false;
}

#else

static inline void intersect_block_closest(BlockNumbers numbers, global const float* block, const Ray* ray,
                                           const Skip* skip, Hit* best) {
  for (uint lane = 0; lane < HR_L; lane++) {
    Hit candidate;
    if (intersect_lane(numbers, block, lane, ray, best->t, &candidate) && is_closer(&candidate, best) &&
        !is_skipped(skip, candidate.primitive)) {
      *best = candidate;
    }
  }
}

static inline bool intersect_block_any(BlockNumbers numbers, global const float* block, const Ray* ray,
                                       const Skip* skip) {
  for (uint lane = 0; lane < HR_L; lane++) {
    Hit candidate;
    if (intersect_lane(numbers, block, lane, ray, ray->t_max, &candidate) && candidate.t < ray->t_max &&
        !is_skipped(skip, candidate.primitive)) {
      return true;
    }
  }
  return false;
}

#endif

#endif

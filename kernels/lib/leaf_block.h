// A ray against one block of a leaf: HR_L primitives side by side, a row a coordinate (shared/bvh_types.h).
#ifndef HR_LIB_LEAF_BLOCK_H
#define HR_LIB_LEAF_BLOCK_H

#include "lib/leaf_vectors.h"

#if HR_EXPLICIT_VECTORS && HR_L > 1

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

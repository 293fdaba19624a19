// A path's way through the stages to its end, in one go.
#ifndef HR_PATH_WALK_H
#define HR_PATH_WALK_H

#include "path/stages.h"

#define HR_STAGE_CASE(feature, name, loads, stores) \
  HR_IF_##feature(case HR_STAGE_##name : next = stage_##name(context, state); break;)

// Walks from stage `next` on; returns how many closest-hit and shadow rays that took.
static inline uint2 walk_path(const PathContext* context, PathState* state, uint next) {
  uint2 rays = (uint2)(0, 0);
  while (next != HR_STAGE_done) {
    if (next == HR_STAGE_intersect_closest) rays.x++;
    if (next == HR_STAGE_intersect_shadow) rays.y++;
    if (HR_HAS(GATHER) && next == HR_STAGE_gather) rays.x += context->params.gather_rays;
    switch (next) {
      HR_PATH_STAGES(HR_STAGE_CASE)
      default:
        next = HR_STAGE_done;
        break;
    }
  }
  return rays;
}

#endif

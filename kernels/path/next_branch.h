// Stage: a finished branch takes the path's next pending one off its stack.
#ifndef HR_PATH_NEXT_BRANCH_H
#define HR_PATH_NEXT_BRANCH_H

#include "path/path_context.h"

static inline uint stage_next_branch(const PathContext* context, PathState* s) {
  const uint size = s->control.w >> 8;
  const PendingBranch branch = context->branches[(size - 1) * context->params.slot_count + context->slot];
  s->ray_origin = branch.origin;
  s->ray_direction = branch.direction;
  s->ray_skip = branch.control.y;
  s->weight = branch.weight;
  s->control = (uint4)(branch.control.x, s->control.z, s->control.z + 1, branch.control.z | (size - 1) << 8);
  return HR_STAGE_intersect_closest;
}

#endif

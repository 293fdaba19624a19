// Stage: a ray that leaves the scene sees the background.
#ifndef HR_PATH_SHADE_MISS_H
#define HR_PATH_SHADE_MISS_H

#include "path/path_context.h"

static inline uint stage_shade_miss(const PathContext* context, PathState* s) {
  path_add(s, param3(context->params.background));
  return path_end_of_branch(s);
}

#endif

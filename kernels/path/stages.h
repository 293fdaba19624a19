// All stages, for the two engines.
#ifndef HR_PATH_STAGES_H
#define HR_PATH_STAGES_H

#include "path/gather.h"
#include "path/generate.h"
#include "path/intersect_closest.h"
#include "path/intersect_shadow.h"
#include "path/next_branch.h"
#include "path/scatter.h"
#include "path/shade_miss.h"
#include "path/shade_surface.h"

// Parameters both engines' kernels share, and their gathering into `context` (without its slot).
#define HR_CONTEXT_PARAMETERS                                       \
  HR_SCENE_PARAMETERS                                               \
  HR_IF_BRANCHING(global PendingBranch* restrict branches HR_COMMA) \
  global float4 *restrict aov_normal_depth, global float4 *restrict aov_albedo_object, const RenderParams params

#define HR_MAKE_CONTEXT                         \
  HR_MAKE_SCENE_VIEW(params)                    \
  PathContext context;                          \
  context.view = view;                          \
  context.params = params;                      \
  context.branches = 0;                         \
  HR_IF_BRANCHING(context.branches = branches;) \
  context.aov_normal_depth = aov_normal_depth;  \
  context.aov_albedo_object = aov_albedo_object;

#endif

// What every stage gets: the state of one path and the launch's context.
#ifndef HR_PATH_PATH_CONTEXT_H
#define HR_PATH_PATH_CONTEXT_H

#include "lib/scene_view.h"
#include "lib/vec.h"
#include "shared/path_state.def"
#include "shared/stages.def"

// Kind of the first bounce, low byte of control.w; decides which sum a contribution goes to.
#define HR_KIND_DIRECT 0u
#define HR_KIND_REFLECTION 1u
#define HR_KIND_REFRACTION 2u

#define HR_STATE_MEMBER(group, feature, type, name) type name;

typedef struct PathState {
  HR_PATH_STATE(HR_STATE_MEMBER)
} PathState;

// A refracted ray that waits until the reflected one and all that follows it is done.
typedef struct PendingBranch {
  real4 origin;
  real4 direction;
  real4 weight;
  uint4 control;  // x bounce, y primitive it left, z kind
} PendingBranch;

typedef struct PathContext {
  SceneView view;
  RenderParams params;
  uint slot;                         // pixel = first_pixel + slot
  global PendingBranch* branches;    // entry e of this path at branches[e * slot_count + slot]
  global float4* aov_normal_depth;   // per pixel: shading normal to the viewer, distance [m]; zero for a miss
  global float4* aov_albedo_object;  // per pixel: kd, object + 1 as float; zero for a miss
} PathContext;

static inline void path_add(PathState* s, real3 radiance) {
  real4 sum = vec4(radiance, 0);
  if (HR_HAS(SECONDARY)) sum *= s->weight;
  const float4 add = convert_float4(sum);
  const uint kind = s->control.w & 255u;
  if (HR_HAS(REFLECTION) && kind == HR_KIND_REFLECTION) {
    s->sum_reflection += add;
  } else if (HR_HAS(REFRACTION) && kind == HR_KIND_REFRACTION) {
    s->sum_refraction += add;
  } else {
    s->sum_direct += add;
  }
}

// After the last contribution of a branch: the next pending one, if there is one.
static inline uint path_end_of_branch(const PathState* s) {
  return HR_HAS(BRANCHING) && (s->control.w >> 8) > 0 ? HR_STAGE_next_branch : HR_STAGE_done;
}

static inline uint path_pixel(const PathContext* context) { return context->params.first_pixel + context->slot; }

#endif

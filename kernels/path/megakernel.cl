// The megakernel engine: one kernel that walks a whole pixel sample through the same stage functions, state in
// registers. The twin of wavefront.cl: strict builds of both give the same bits.
#include "path/walk.h"

#ifndef HR_LOCAL_SIZE
#define HR_LOCAL_SIZE 64
#endif

// Launch: one item a slot in [0, count). path_sum_*: radiance of the pixel sample by kind of its first bounce.
// ray_counts[slot]: closest-hit rays and shadow rays traced.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void path_megakernel(
    global float4* restrict path_sum_direct,
    HR_IF_REFLECTION(global float4* restrict path_sum_reflection HR_COMMA)
        HR_IF_REFRACTION(global float4* restrict path_sum_refraction HR_COMMA) global uint2* restrict ray_counts,
    const uint count, HR_CONTEXT_PARAMETERS) {
  const uint slot = (uint)get_global_id(0);
  if (slot >= count) return;
  HR_MAKE_CONTEXT
  context.slot = slot;
  PathState state;
  const uint2 rays = walk_path(&context, &state, HR_STAGE_generate);
  path_sum_direct[slot] = state.sum_direct;
  HR_IF_REFLECTION(path_sum_reflection[slot] = state.sum_reflection;)
  HR_IF_REFRACTION(path_sum_refraction[slot] = state.sum_refraction;)
  ray_counts[slot] = rays;
}

// The megakernel engine: one kernel that walks a whole pixel sample through the same stage functions, state in
// registers. The twin of wavefront.cl: strict builds of both give the same bits.
#include "path/stages.h"

#ifndef HR_LOCAL_SIZE
#define HR_LOCAL_SIZE 64
#endif

#define HR_STAGE_CASE(feature, name, loads, stores) \
  HR_IF_##feature(case HR_STAGE_##name : next = stage_##name(&context, &state); break;)

// Launch: one item a slot in [0, count). path_sum_*: radiance of the pixel sample by kind of its first bounce.
// ray_counts[slot]: closest-hit rays and shadow rays traced.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void path_megakernel(
    global real4* restrict path_sum_direct,
    HR_IF_REFLECTION(global real4* restrict path_sum_reflection HR_COMMA)
        HR_IF_REFRACTION(global real4* restrict path_sum_refraction HR_COMMA) global uint2* restrict ray_counts,
    const uint count, HR_CONTEXT_PARAMETERS) {
  const uint slot = (uint)get_global_id(0);
  if (slot >= count) return;
  HR_MAKE_CONTEXT
  context.slot = slot;
  PathState state;
  uint2 rays = (uint2)(0, 0);
  uint next = HR_STAGE_generate;
  while (next != HR_STAGE_done) {
    if (next == HR_STAGE_intersect_closest) rays.x++;
    if (next == HR_STAGE_intersect_shadow) rays.y++;
    switch (next) {
      HR_PATH_STAGES(HR_STAGE_CASE)
      default:
        next = HR_STAGE_done;
        break;
    }
  }
  path_sum_direct[slot] = state.sum_direct;
  HR_IF_REFLECTION(path_sum_reflection[slot] = state.sum_reflection;)
  HR_IF_REFRACTION(path_sum_refraction[slot] = state.sum_refraction;)
  ray_counts[slot] = rays;
}

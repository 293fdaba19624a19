// The end of a wave: when the paths left are not worth a round's launches and the way of their states through
// memory, they walk through their stages in one go, as in the megakernel.
#include "path/state_arrays.h"
#include "path/walk.h"

#ifndef HR_LOCAL_SIZE
#define HR_LOCAL_SIZE 64
#endif

// ray_counts[i]: closest-hit and shadow rays traced for the path in queue[i]. Launch: one item a queue entry.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void path_finish(
    HR_PATH_STATE(HR_STATE_PARAMETER) global uint* restrict next_stage, global const uint* restrict queue,
    global uint2* restrict ray_counts, const uint count, HR_CONTEXT_PARAMETERS) {
  const uint item = (uint)get_global_id(0);
  if (item >= count) return;
  const uint slot = queue[item];
  const uint loads = HR_ALL_GROUPS, stores = HR_GROUP_SUMS;
  HR_MAKE_CONTEXT
  context.slot = slot;
  PathState state;
  HR_PATH_STATE(HR_STATE_LOAD)
  ray_counts[item] = walk_path(&context, &state, next_stage[slot]);
  next_stage[slot] = HR_STAGE_done;
  HR_PATH_STATE(HR_STATE_STORE)
}

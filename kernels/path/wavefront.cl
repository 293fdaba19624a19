// The wavefront engine: one kernel a stage, made from stages.def. Work-item i runs the path in slot queue[first + i];
// the path's state lies in one array a field (path_state.def).
#include "path/stages.h"
#include "path/state_arrays.h"

#ifndef HR_LOCAL_SIZE
#define HR_LOCAL_SIZE 64
#endif

// Launch: one item a queue entry, rounded up to the local size. next_stage[slot] receives the path's next stage.
#define HR_STAGE_KERNEL(feature, name, group_loads, group_stores)                                            \
  HR_IF_##feature(kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void path_##name(        \
      HR_PATH_STATE(HR_STATE_PARAMETER) global uint* restrict next_stage, global const uint* restrict queue, \
      const uint first, const uint count, HR_CONTEXT_PARAMETERS) {                                           \
    const uint item = (uint)get_global_id(0);                                                                \
    if (item >= count) return;                                                                               \
    const uint slot = queue[first + item];                                                                   \
    const uint loads = group_loads;                                                                          \
    const uint stores = group_stores;                                                                        \
    HR_MAKE_CONTEXT                                                                                          \
    context.slot = slot;                                                                                     \
    PathState state;                                                                                         \
    HR_PATH_STATE(HR_STATE_LOAD)                                                                             \
    next_stage[slot] = stage_##name(&context, &state);                                                       \
    HR_PATH_STATE(HR_STATE_STORE)                                                                            \
  })

HR_PATH_STAGES(HR_STAGE_KERNEL)

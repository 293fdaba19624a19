// A path's state as one array a field (path_state.def): the wavefront kernels' parameters, and loads and stores by
// group.
#ifndef HR_PATH_STATE_ARRAYS_H
#define HR_PATH_STATE_ARRAYS_H

#include "path/path_context.h"

// In a kernel's parameter list; each ends with a comma.
#define HR_STATE_PARAMETER(group, feature, type, name) HR_IF_##feature(global type* restrict path_##name HR_COMMA)

// In a kernel's body, with `slot`, `state` and the groups `loads` or `stores` at hand.
#define HR_STATE_LOAD(group, feature, type, name) \
  HR_IF_##feature(if (loads & HR_GROUP_##group) state.name = path_##name[slot];)
#define HR_STATE_STORE(group, feature, type, name) \
  HR_IF_##feature(if (stores & HR_GROUP_##group) path_##name[slot] = state.name;)

#endif

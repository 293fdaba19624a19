// The scene's buffers as device functions see them. Members of what the effect mask switches off stay null.
#ifndef HR_LIB_SCENE_VIEW_H
#define HR_LIB_SCENE_VIEW_H

#include "shared/bvh_types.h"
#include "shared/features.h"
#include "shared/params.h"
#include "shared/scene_buffers.def"
#include "shared/scene_types.h"

#define HR_VIEW_MEMBER(feature, type, name) global const type* name;
#define HR_VIEW_PARAMETER(feature, type, name) HR_IF_##feature(global const type* restrict name HR_COMMA)
#define HR_VIEW_ASSIGN(feature, type, name) HR_IF_##feature(view.name = name;)

typedef struct SceneView {
  HR_SCENE_BUFFERS(HR_VIEW_MEMBER)
  uint triangle_count, sphere_count, plane_count, light_count, emitter_count, instance_count;
} SceneView;

// In a kernel's parameter list; each ends with a comma.
#define HR_SCENE_PARAMETERS HR_SCENE_BUFFERS(HR_VIEW_PARAMETER)

// In a kernel's body: declares `view`.
#define HR_MAKE_SCENE_VIEW(params)               \
  SceneView view = {0};                          \
  HR_SCENE_BUFFERS(HR_VIEW_ASSIGN)               \
  view.triangle_count = (params).triangle_count; \
  view.sphere_count = (params).sphere_count;     \
  view.plane_count = (params).plane_count;       \
  view.light_count = (params).light_count;       \
  view.emitter_count = (params).emitter_count;   \
  view.instance_count = (params).instance_count;

#endif

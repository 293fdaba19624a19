// The scene's buffers as device functions see them. Members of what the effect mask switches off stay null.
#ifndef HR_LIB_SCENE_VIEW_H
#define HR_LIB_SCENE_VIEW_H

#include "lib/tree_chunks.h"
#include "shared/bvh_types.h"
#include "shared/features.h"
#include "shared/params.h"
#include "shared/scene_buffers.def"
#include "shared/scene_types.h"

#define HR_VIEW_MEMBER(feature, type, name) global const type* name;
#define HR_VIEW_PARAMETER(feature, type, name) HR_IF_##feature(global const type* restrict name HR_COMMA)
#define HR_VIEW_CHUNK(array, i) view.array##_##i = array##_##i;
#define HR_VIEW_ASSIGN(feature, type, name) HR_IF_##feature(view.name = name;)

typedef struct SceneView {
  HR_SCENE_BUFFERS(HR_VIEW_MEMBER)
  HR_MORE_CHUNKS(HR_CHUNK_MEMBER)
  global uint* uncertain_roots;  // how often a ray may have met an implicit surface where it is said not to
  uint triangle_count, sphere_count, shape_count, plane_count, light_count, emitter_count, instance_count;
#ifdef HR_COUNT_VISITS
  uint* visits;  // of nodes and of blocks, by this work-item
#endif
} SceneView;

// A traversal has come to a node or a block: counted only by bvh/count_visits.cl.
#ifdef HR_COUNT_VISITS
#define HR_VISIT_NODE(view) ((view)->visits[0]++)
#define HR_VISIT_BLOCK(view) ((view)->visits[1]++)
#else
#define HR_VISIT_NODE(view)
#define HR_VISIT_BLOCK(view)
#endif

// Where primitives of a kind begin: triangles, spheres, shapes, planes, triangles of all instances.
static inline uint first_shape(const SceneView* view) { return view->triangle_count + view->sphere_count; }
static inline uint first_plane(const SceneView* view) { return first_shape(view) + view->shape_count; }

// Can a ray that leaves this shape meet it again?
static inline bool is_curved_shape(const SceneView* view, uint primitive) {
  const uint i = primitive - first_shape(view);
  return HR_HAS(SHAPES) && i < view->shape_count && view->shapes[i].kind != HR_SHAPE_DISK;
}

HR_DEFINE_NODE_AT(node_at, SceneView, global const float*)
HR_DEFINE_BLOCK_AT(block_at, SceneView, global const float*)

// In a kernel's parameter list; each ends with a comma.
#define HR_SCENE_PARAMETERS           \
  HR_SCENE_BUFFERS(HR_VIEW_PARAMETER) \
  HR_MORE_CHUNKS(HR_CHUNK_READ) HR_IF_IMPLICITS(global uint* restrict uncertain_roots HR_COMMA)
// For a kernel that reads the tree alone.
#define HR_TREE_PARAMETERS \
  global const float* restrict accel_nodes, global const float* restrict accel_blocks, HR_MORE_CHUNKS(HR_CHUNK_READ)

// In a kernel's body: declares `view`.
#define HR_MAKE_SCENE_VIEW(params)                         \
  SceneView view = {0};                                    \
  HR_SCENE_BUFFERS(HR_VIEW_ASSIGN)                         \
  HR_MORE_CHUNKS(HR_VIEW_CHUNK)                            \
  HR_IF_IMPLICITS(view.uncertain_roots = uncertain_roots;) \
  view.triangle_count = (params).triangle_count;           \
  view.sphere_count = (params).sphere_count;               \
  view.shape_count = (params).shape_count;                 \
  view.plane_count = (params).plane_count;                 \
  view.light_count = (params).light_count;                 \
  view.emitter_count = (params).emitter_count;             \
  view.instance_count = (params).instance_count;
#define HR_MAKE_TREE_VIEW           \
  SceneView view = {0};             \
  view.accel_nodes = accel_nodes;   \
  view.accel_blocks = accel_blocks; \
  HR_MORE_CHUNKS(HR_VIEW_CHUNK)

#endif

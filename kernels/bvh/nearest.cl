// Nearest-neighbour searches with the wide BVH, for arrays of points: a box is left out by its distance.
#include "lib/nearest.h"
#include "lib/scene_view.h"

#ifndef HR_LOCAL_SIZE
#define HR_LOCAL_SIZE 64
#endif
#define HR_MAX_NEIGHBOURS 16

// A child that waits, by its squared distance (bits of a float >= 0, hence ordered) above its reference.
typedef ulong Waiting;

static inline real waiting_distance2(Waiting w) { return as_float((uint)(w >> 32)); }

// Puts the node's children that are not farther than `least` on the stack, the nearest on top.
static inline void push_children(const SceneView* tree, int node, real3 p, real least, Waiting* stack, uint* size) {
  global const float* n = node_at(tree, (uint)node);
  const uint bottom = *size;
  for (uint i = 0; i < HR_W; i++) {
    const int child = ((global const int*)n)[HR_NODE_CHILD_ROW * HR_W + i];
    if (child == -1) continue;
    const real3 lo = (real3)(n[i], n[2 * HR_W + i], n[4 * HR_W + i]);
    const real3 hi = (real3)(n[HR_W + i], n[3 * HR_W + i], n[5 * HR_W + i]);
    const real distance2 = box_distance2(p, lo, hi);
    if (!(distance2 * HR_NEAREST_PAD <= least)) continue;
    const Waiting w = (ulong)as_uint(distance2) << 32 | (uint)child;
    uint place = (*size)++;
    for (; place > bottom && stack[place - 1] < w; place--) stack[place] = stack[place - 1];
    stack[place] = w;
  }
}

static inline uint lane_primitive(global const float* block, uint lane) {
  return ((global const uint*)block)[HR_BLOCK_PRIMITIVE_ROW * HR_L + lane];
}

// nearest[i]: xyz = the point of the scene's triangles and spheres (shapes are left out) nearest to queries[i].xyz, w =
// its distance [m]; primitives[i] its primitive. Farther than queries[i].w is not looked; then the point is the query
// itself, w infinite, the primitive HR_NO_PRIMITIVE. Launch: count items, rounded up to the local size.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void nearest_on_scene(
    HR_GEOMETRY_PARAMETERS HR_TREE_PARAMETERS global const float4* restrict queries, const uint count,
    global float4* restrict nearest, global uint* restrict primitives) {
  const uint i = (uint)get_global_id(0);
  if (i >= count) return;
  HR_MAKE_TREE_VIEW
  HR_MAKE_GEOMETRY(0)
  const real3 p = param3(queries[i]);
  const real farthest2 = queries[i].w * queries[i].w;
  Nearest best = {farthest2, p, HR_NO_PRIMITIVE};
  Waiting stack[HR_TRAVERSAL_STACK];
  uint size = 0;
  push_children(&view, 0, p, best.distance2, stack, &size);
  while (size > 0) {
    const Waiting at = stack[--size];
    if (!(waiting_distance2(at) * HR_NEAREST_PAD <= best.distance2)) continue;
    const int reference = (int)(uint)at;
    if (reference >= 0) {
      push_children(&view, reference, p, best.distance2, stack, &size);
      continue;
    }
    const uint leaf = (uint)~reference;
    for (uint k = 0; k < (leaf & 15u) * HR_L; k++) {
      const uint primitive = lane_primitive(block_at(&view, (leaf >> 4) + k / HR_L), k % HR_L);
      if (primitive == HR_NO_PRIMITIVE) continue;
      const Primitive one = load_primitive(&geometry, primitive);
      if (one.kind != HR_PRIMITIVE_SHAPE) nearest_on_primitive(one, primitive, p, &best);
    }
  }
  const bool found = best.primitive != HR_NO_PRIMITIVE;
  nearest[i] = (float4)(best.point.x, best.point.y, best.point.z, found ? sqrt(best.distance2) : INFINITY);
  primitives[i] = best.primitive;
}

// The k points nearest to queries[i].xyz and not farther than its w, nearest first, ties by the smaller index:
// distances[i k ...] [m] and indices[i k ...], filled up with infinity and HR_NO_PRIMITIVE. The tree's primitives are
// the points, as spheres of the least radius: a block's rows 0 to 2 are their coordinates. Launch: as nearest_on_scene.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void nearest_points(
    HR_TREE_PARAMETERS global const float4* restrict queries, const uint count, const uint k,
    global float* restrict distances, global uint* restrict indices) {
  const uint i = (uint)get_global_id(0);
  if (i >= count) return;
  HR_MAKE_TREE_VIEW
  const real3 p = param3(queries[i]);
  real distance2[HR_MAX_NEIGHBOURS];
  uint index[HR_MAX_NEIGHBOURS];
  uint found = 0;
  real least = queries[i].w * queries[i].w;  // of what still counts
  Waiting stack[HR_TRAVERSAL_STACK];
  uint size = 0;
  push_children(&view, 0, p, least, stack, &size);
  while (size > 0) {
    const Waiting at = stack[--size];
    if (!(waiting_distance2(at) * HR_NEAREST_PAD <= least)) continue;
    const int reference = (int)(uint)at;
    if (reference >= 0) {
      push_children(&view, reference, p, least, stack, &size);
      continue;
    }
    const uint leaf = (uint)~reference;
    for (uint j = 0; j < (leaf & 15u) * HR_L; j++) {
      global const float* block = block_at(&view, (leaf >> 4) + j / HR_L);
      const uint lane = j % HR_L, point = lane_primitive(block, lane);
      if (point == HR_NO_PRIMITIVE) continue;
      const real d2 = length2(p - (real3)(block[lane], block[HR_L + lane], block[2 * HR_L + lane]));
      if (!(d2 <= least && d2 < INFINITY) || (found == k && d2 == distance2[k - 1] && point > index[k - 1])) continue;
      uint place = found < k ? found++ : k - 1;
      for (; place > 0 && (distance2[place - 1] > d2 || (distance2[place - 1] == d2 && index[place - 1] > point));
           place--) {
        distance2[place] = distance2[place - 1];
        index[place] = index[place - 1];
      }
      distance2[place] = d2;
      index[place] = point;
      if (found == k) least = distance2[k - 1];
    }
  }
  for (uint j = 0; j < k; j++) {
    distances[(ulong)i * k + j] = j < found ? sqrt(distance2[j]) : INFINITY;
    indices[(ulong)i * k + j] = j < found ? index[j] : HR_NO_PRIMITIVE;
  }
}

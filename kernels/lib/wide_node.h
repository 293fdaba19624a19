// A ray at a node of the wide BVH: which children it enters, and which of them is next.
#ifndef HR_LIB_WIDE_NODE_H
#define HR_LIB_WIDE_NODE_H

#include "lib/instance.h"
#include "lib/leaf_block.h"

// A waiting child: where the ray enters it (bits of a float >= 0, hence ordered) above its reference.
typedef ulong StackEntry;

#define HR_ENTRY(t, reference) ((ulong)as_uint(t) << 32 | (uint)(reference))

static inline global const int* node_children(global const float* node) {
  return (global const int*)(node + HR_NODE_CHILD_ROW * HR_W);
}

static inline void prefetch_child(const SceneView* view, int child) {
  if (HR_HAS(INSTANCES) && is_instance_leaf(child)) {
    HR_PREFETCH((global const char*)(view->instances + leaf_instance(child)));
    return;
  }
  global const char* p =
      child >= 0 ? (global const char*)node_at(view, child) : (global const char*)block_at(view, (uint)~child >> 4);
  HR_PREFETCH(p);
  HR_PREFETCH(p + 64);
  if (HR_W == 8) {
    HR_PREFETCH(p + 128);
    HR_PREFETCH(p + 192);
  }
}

// What the slab tests of all nodes share: rows of near and far planes along each axis, by the ray's direction, and for
// the fast form the origin's own distances.
typedef struct Slabs {
  uint near_x, near_y, near_z, far_x, far_y, far_z;  // in words
  real qx, qy, qz;                                   // -origin * inverse
} Slabs;

static inline Slabs make_slabs(const Ray* ray) {
  Slabs s;
  s.near_x = ray->inverse.x < 0 ? HR_W : 0;
  s.near_y = ray->inverse.y < 0 ? 3 * HR_W : 2 * HR_W;
  s.near_z = ray->inverse.z < 0 ? 5 * HR_W : 4 * HR_W;
  s.far_x = HR_W - s.near_x;
  s.far_y = 5 * HR_W - s.near_y;
  s.far_z = 9 * HR_W - s.near_z;
  s.qx = -ray->origin.x * ray->inverse.x;
  s.qy = -ray->origin.y * ray->inverse.y;
  s.qz = -ray->origin.z * ray->inverse.z;
  return s;
}

#if HR_EXPLICIT_VECTORS

#define HR_FLOATW HR_PASTE(float, HR_W)
#define HR_LANES_OF_W HR_PASTE(lanes_of, HR_W)
#define HR_SLAB(row) (*(global const HR_FLOATW*)(node + (row)))

// The children that the ray enters before t_far, and where, in t_near[]. Subtract first, multiply after: fma(plane,
// inverse, -origin * inverse) loses rays far from the origin (the fast triangle test comes with the fast slabs).
static inline LaneSet enter_children(global const float* node, const Ray* ray, const Slabs* slabs, real t_far,
                                     float* t_near) {
#if HR_TRIANGLE_WATERTIGHT
#pragma OPENCL FP_CONTRACT OFF
  const HR_FLOATW x_in = (HR_SLAB(slabs->near_x) - ray->origin.x) * ray->inverse.x;
  const HR_FLOATW y_in = (HR_SLAB(slabs->near_y) - ray->origin.y) * ray->inverse.y;
  const HR_FLOATW z_in = (HR_SLAB(slabs->near_z) - ray->origin.z) * ray->inverse.z;
  const HR_FLOATW x_out = (HR_SLAB(slabs->far_x) - ray->origin.x) * ray->inverse.x;
  const HR_FLOATW y_out = (HR_SLAB(slabs->far_y) - ray->origin.y) * ray->inverse.y;
  const HR_FLOATW z_out = (HR_SLAB(slabs->far_z) - ray->origin.z) * ray->inverse.z;
  const HR_FLOATW t_in = max((HR_FLOATW)(ray->t_min), max(max(x_in, y_in), z_in));
  const HR_FLOATW t_out = min((HR_FLOATW)(t_far), min(min(x_out, y_out), z_out)) * HR_SLAB_PAD;
#else
  const real3 inverse = ray->inverse;
  const HR_FLOATW x_in = fma(HR_SLAB(slabs->near_x), (HR_FLOATW)(inverse.x), (HR_FLOATW)(slabs->qx));
  const HR_FLOATW y_in = fma(HR_SLAB(slabs->near_y), (HR_FLOATW)(inverse.y), (HR_FLOATW)(slabs->qy));
  const HR_FLOATW z_in = fma(HR_SLAB(slabs->near_z), (HR_FLOATW)(inverse.z), (HR_FLOATW)(slabs->qz));
  const HR_FLOATW x_out = fma(HR_SLAB(slabs->far_x), (HR_FLOATW)(inverse.x), (HR_FLOATW)(slabs->qx));
  const HR_FLOATW y_out = fma(HR_SLAB(slabs->far_y), (HR_FLOATW)(inverse.y), (HR_FLOATW)(slabs->qy));
  const HR_FLOATW z_out = fma(HR_SLAB(slabs->far_z), (HR_FLOATW)(inverse.z), (HR_FLOATW)(slabs->qz));
  const HR_FLOATW t_in = max((HR_FLOATW)(ray->t_min), max(max(x_in, y_in), z_in));
  const HR_FLOATW t_out = min((HR_FLOATW)(t_far), min(min(x_out, y_out), z_out));
#endif
  HR_STORE(HR_W, t_in, t_near);
  return HR_LANES_OF_W(t_in <= t_out);
}

#else

static inline LaneSet enter_children(global const float* node, const Ray* ray, const Slabs* slabs, real t_far,
                                     float* t_near) {
#pragma OPENCL FP_CONTRACT OFF
  LaneSet lanes = 0;
  for (uint i = 0; i < HR_W; i++) {
    const real x_in = (node[slabs->near_x + i] - ray->origin.x) * ray->inverse.x;
    const real y_in = (node[slabs->near_y + i] - ray->origin.y) * ray->inverse.y;
    const real z_in = (node[slabs->near_z + i] - ray->origin.z) * ray->inverse.z;
    const real x_out = (node[slabs->far_x + i] - ray->origin.x) * ray->inverse.x;
    const real y_out = (node[slabs->far_y + i] - ray->origin.y) * ray->inverse.y;
    const real z_out = (node[slabs->far_z + i] - ray->origin.z) * ray->inverse.z;
    t_near[i] = max(ray->t_min, max(max(x_in, y_in), z_in));
    const real t_out = min(t_far, min(min(x_out, y_out), z_out)) * HR_SLAB_PAD;
    if (t_near[i] <= t_out) lanes |= lane_bit(i);
  }
  return lanes;
}

#endif

static inline void sort_pair(StackEntry* a, StackEntry* b) {
  const StackEntry nearer = min(*a, *b), farther = max(*a, *b);
  *a = nearer;
  *b = farther;
}

// Puts the entered children on the stack, nearest on top, and takes that one: small networks for the usual cases.
static inline int nearest_child(const SceneView* view, global const float* node, LaneSet lanes, const float* t_near,
                                StackEntry* stack, uint* size) {
  global const int* child = node_children(node);
  uint lane = first_lane(lanes);
  lanes = without_first(lanes);
  if (!lanes) {
    prefetch_child(view, child[lane]);
    return child[lane];
  }
  StackEntry a = HR_ENTRY(t_near[lane], child[lane]);
  lane = first_lane(lanes);
  lanes = without_first(lanes);
  StackEntry b = HR_ENTRY(t_near[lane], child[lane]);
  if (!lanes) {
    sort_pair(&a, &b);
    stack[(*size)++] = b;
    prefetch_child(view, (int)(uint)b);
    return (int)(uint)a;
  }
  lane = first_lane(lanes);
  lanes = without_first(lanes);
  StackEntry c = HR_ENTRY(t_near[lane], child[lane]);
  if (!lanes) {
    sort_pair(&a, &b);
    sort_pair(&b, &c);
    sort_pair(&a, &b);
    stack[*size] = c;
    stack[*size + 1] = b;
    *size += 2;
    return (int)(uint)a;
  }
  lane = first_lane(lanes);
  lanes = without_first(lanes);
  StackEntry d = HR_ENTRY(t_near[lane], child[lane]);
  sort_pair(&a, &b);
  sort_pair(&c, &d);
  sort_pair(&a, &c);
  sort_pair(&b, &d);
  sort_pair(&b, &c);
  const uint bottom = *size;
  stack[bottom] = d;
  stack[bottom + 1] = c;
  stack[bottom + 2] = b;
  stack[bottom + 3] = a;
  uint top = bottom + 4;
  while (lanes) {
    lane = first_lane(lanes);
    lanes = without_first(lanes);
    const StackEntry e = HR_ENTRY(t_near[lane], child[lane]);
    uint place = top++;
    for (; place > bottom && stack[place - 1] < e; place--) stack[place] = stack[place - 1];
    stack[place] = e;
  }
  *size = top - 1;
  return (int)(uint)stack[top - 1];
}

#endif

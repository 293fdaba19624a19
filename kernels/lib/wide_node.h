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

// One axis of a ray's slab tests: a plane at p is entered at fma(p, in_rate, in_offset), left at fma(p, out_rate,
// out_offset). With the plain offset -origin / direction rays are lost: its rounding, half an ulp of itself, is not
// small beside a distance that is. The watertight form therefore
// lowers the one offset and raises the other by three ulps: half an ulp each for the rounding of the offset, of moving
// it, of padding it and of out_rate, and one to spare. All other roundings are relative to the distance, and
// HR_SLAB_PAD in out_rate and out_offset outweighs them. So it takes no more operations than the plain one.
typedef struct AxisSlab {
  uint in_row, out_row;  // of the node, in words
  real in_rate, in_offset, out_rate, out_offset;
} AxisSlab;

typedef struct Slabs {
  AxisSlab x, y, z;
} Slabs;

// Vectors of the fast triangle test keep the plain form, which needs fewer registers: 5 % faster.
#if HR_TRIANGLE_WATERTIGHT || !HR_EXPLICIT_VECTORS
#define HR_SAFE_SLABS 1
#else
#define HR_SAFE_SLABS 0
#endif

#define HR_OFFSET_SLACK (6 * HR_HALF_ULP)
// Larger ones come close to the end of a float's range. Only rays that start beyond 1e19, nearly across an axis, have
// them; they turn by less than what the origin is rounded to.
#define HR_MOST_OFFSET REAL(1e37)

static inline AxisSlab make_axis_slab(real origin, real rate, uint row) {
#pragma OPENCL FP_CONTRACT OFF
  AxisSlab s;
  s.in_row = row + (rate < 0 ? HR_W : 0);
  s.out_row = row + (rate < 0 ? 0 : HR_W);
  real offset = -origin * rate;
  if (HR_SAFE_SLABS) {
    if (!(fabs(offset) <= HR_MOST_OFFSET)) {
      rate = copysign(HR_MOST_OFFSET / fabs(origin), rate);
      offset = -origin * rate;
    }
    const real slack = fabs(offset) * HR_OFFSET_SLACK;
    s.in_rate = rate;
    s.in_offset = offset - slack;
    s.out_rate = rate * HR_SLAB_PAD;
    s.out_offset = (offset + slack) * HR_SLAB_PAD;
  } else {
    s.in_rate = rate;
    s.in_offset = offset;
    s.out_rate = rate;
    s.out_offset = offset;
  }
  return s;
}

static inline Slabs make_slabs(const Ray* ray) {
  Slabs s;
  s.x = make_axis_slab(ray->origin.x, ray->inverse.x, 0);
  s.y = make_axis_slab(ray->origin.y, ray->inverse.y, 2 * HR_W);
  s.z = make_axis_slab(ray->origin.z, ray->inverse.z, 4 * HR_W);
  return s;
}

#if HR_EXPLICIT_VECTORS

#define HR_FLOATW HR_PASTE(float, HR_W)
#define HR_LANES_OF_W HR_PASTE(lanes_of, HR_W)
#define HR_SLAB(row) (*(global const HR_FLOATW*)(node + (row)))

static inline HR_FLOATW slabs_entered(global const float* node, const AxisSlab* a) {
  return fma(HR_SLAB(a->in_row), (HR_FLOATW)(a->in_rate), (HR_FLOATW)(a->in_offset));
}

static inline HR_FLOATW slabs_left(global const float* node, const AxisSlab* a) {
  return fma(HR_SLAB(a->out_row), (HR_FLOATW)(a->out_rate), (HR_FLOATW)(a->out_offset));
}

// The children that the ray enters before t_far, and where: t_near must be aligned as a vector of HR_W floats.
static inline LaneSet enter_children(global const float* node, real t_min, const Slabs* s, real t_far, float* t_near) {
  const HR_FLOATW t_in = max(
      (HR_FLOATW)(t_min), max(max(slabs_entered(node, &s->x), slabs_entered(node, &s->y)), slabs_entered(node, &s->z)));
  const HR_FLOATW t_out = min((HR_FLOATW)(t_far * HR_SLAB_PAD),
                              min(min(slabs_left(node, &s->x), slabs_left(node, &s->y)), slabs_left(node, &s->z)));
  *(HR_FLOATW*)t_near = t_in;
  return HR_LANES_OF_W(t_in <= t_out);
}

#else

static inline real slab_entered(global const float* node, const AxisSlab* a, uint lane) {
  return fma((real)node[a->in_row + lane], a->in_rate, a->in_offset);
}

static inline real slab_left(global const float* node, const AxisSlab* a, uint lane) {
  return fma((real)node[a->out_row + lane], a->out_rate, a->out_offset);
}

static inline LaneSet enter_children(global const float* node, real t_min, const Slabs* s, real t_far, float* t_near) {
  LaneSet lanes = 0;
  for (uint i = 0; i < HR_W; i++) {
    const real t_in =
        max(t_min, max(max(slab_entered(node, &s->x, i), slab_entered(node, &s->y, i)), slab_entered(node, &s->z, i)));
    t_near[i] = convert_float_rtn(t_in);
    const real t_out = min(t_far * HR_SLAB_PAD,
                           min(min(slab_left(node, &s->x, i), slab_left(node, &s->y, i)), slab_left(node, &s->z, i)));
    if (t_in <= t_out) lanes |= lane_bit(i);
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
  if (!lanes) return child[lane];
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

// The same in the order of lanes, the last one next, which is likely to stop rays that ask for any hit
// (order_children() of bvh/cut.h).
static inline int last_child(global const float* node, LaneSet lanes, const float* t_near, StackEntry* stack,
                             uint* size) {
  global const int* child = node_children(node);
  uint lane = first_lane(lanes);
  for (lanes = without_first(lanes); lanes; lanes = without_first(lanes)) {
    stack[(*size)++] = HR_ENTRY(t_near[lane], child[lane]);
    lane = first_lane(lanes);
  }
  return child[lane];
}

#endif

// Packets (lib/packet_rays.h) of camera rays, of rays from a point light or of a hemicube go through the tree together.
// A node's children are first tested against the interval of all directions, then each survivor against the rays
// themselves (Wald, Boulos, Shirley 2007, "Ray Tracing Deformable Scenes Using Dynamic BVHs", with exact second test).
#ifndef HR_LIB_PACKET_H
#define HR_LIB_PACKET_H

#include "lib/packet_others.h"
#include "lib/packet_triangle.h"

#if HR_PACKETS

// Directions nearer to zero than this count as both signs.
#define HR_MIXED_DIRECTION 1e-12f

// The slabs of one axis for all directions in [lo, hi].
typedef struct AxisInterval {
  uint near_row, far_row;                      // in words
  float near_rate, far_rate, other_near_rate;  // 1 / direction
  bool mixed;                                  // both signs: rays may enter by either plane and need not leave
} AxisInterval;

static inline AxisInterval make_axis_interval(float lo, float hi, uint row) {
  AxisInterval a;
  a.mixed = !(lo > HR_MIXED_DIRECTION) && !(hi < -HR_MIXED_DIRECTION);
  const bool backwards = hi < -HR_MIXED_DIRECTION;
  a.near_row = row + (backwards ? HR_W : 0);
  a.far_row = row + (backwards ? 0 : HR_W);
  a.near_rate = backwards ? 1 / lo : 1 / max(hi, HR_MIXED_DIRECTION);
  a.far_rate = backwards ? 1 / hi : 1 / lo;
  a.other_near_rate = 1 / min(lo, -HR_MIXED_DIRECTION);
  return a;
}

// Narrows [t_in, t_out] of all children by one axis.
static inline void narrow_interval(global const float* node, const AxisInterval* a, real origin, HR_FLOATW* t_in,
                                   HR_FLOATW* t_out) {
  *t_in = max(*t_in, (HR_SLAB(a->near_row) - origin) * a->near_rate);
  if (a->mixed) {
    *t_in = max(*t_in, (HR_SLAB(a->far_row) - origin) * a->other_near_rate);
  } else {
    *t_out = min(*t_out, (HR_SLAB(a->far_row) - origin) * a->far_rate);
  }
}

// The ends of a box about the rays' origin [m]. A ray in the plane of an end and along it does not leave there, but 0
// times its rate would say so at once: such an end is moved far out, which only lets more rays in.
#define HR_FAR_END 1e12f
static inline float low_end(float x) { return x == 0 ? -HR_FAR_END : x; }
static inline float high_end(float x) { return x == 0 ? HR_FAR_END : x; }

// Does any ray of the packet enter child `lane` of the node?
static inline bool any_ray_enters(const Packet* p, global const float* node, uint lane) {
#pragma OPENCL FP_CONTRACT OFF
  const float lo_x = low_end(node[lane] - p->origin.x), hi_x = high_end(node[HR_W + lane] - p->origin.x);
  const float lo_y = low_end(node[2 * HR_W + lane] - p->origin.y), hi_y = high_end(node[3 * HR_W + lane] - p->origin.y);
  const float lo_z = low_end(node[4 * HR_W + lane] - p->origin.z), hi_z = high_end(node[5 * HR_W + lane] - p->origin.z);
  for (uint k = 0; k < HR_K; k++) {
    const float16 x0 = lo_x * p->rx[k], x1 = hi_x * p->rx[k];
    const float16 y0 = lo_y * p->ry[k], y1 = hi_y * p->ry[k];
    const float16 z0 = lo_z * p->rz[k], z1 = hi_z * p->rz[k];
    const float16 t_in = max((float16)(p->t_min), max(max(min(x0, x1), min(y0, y1)), min(z0, z1)));
    const float16 t_out = min(p->t[k], min(min(max(x0, x1), max(y0, y1)), max(z0, z1))) * HR_SLAB_PAD;
    if (any_lane16(t_in <= t_out)) return true;
  }
  return false;
}

static inline float most_t(const Packet* p) {
  float16 t = p->t[0];
  for (uint k = 1; k < HR_K; k++) t = max(t, p->t[k]);
  return most_of16(t);
}

// With `any`, a ray that has hit something is finished: its t drops below all others.
static inline void finish_hit_rays(Packet* p) {
  for (uint k = 0; k < HR_K; k++) p->t[k] = select(p->t[k], (float16)(-1.0f), p->primitive[k] != -1);
}

// Traces the packet; hits are in t, u, v, primitive afterwards (only primitive with `any`).
static inline void traverse_packet(const SceneView* view, Packet* p, bool any) {
  AxisInterval axes[3];
  for (uint i = 0; i < 3; i++) axes[i] = make_axis_interval(p->least[i], p->most[i], 2 * i * HR_W);
  if (HR_HAS(PLANES)) {
    intersect_packet_planes(view, p);
    if (any) finish_hit_rays(p);
  }
  const PacketCone cone = packet_cone(p);
  p->t_most = most_t(p);
  StackEntry stack[HR_TRAVERSAL_STACK];
  uint size = 0;
  int at = 0;
  if (HR_HAS(INSTANCES)) stack[size++] = HR_ENTRY(0.0f, instance_root(view));
  for (;;) {
    if (at >= 0) {
      global const float* node = node_at(view, at);
      HR_FLOATW t_in = (HR_FLOATW)(p->t_min), t_out = (HR_FLOATW)(p->t_most);
      narrow_interval(node, &axes[0], p->origin.x, &t_in, &t_out);
      narrow_interval(node, &axes[1], p->origin.y, &t_in, &t_out);
      narrow_interval(node, &axes[2], p->origin.z, &t_in, &t_out);
      LaneSet entered = 0;
      for (LaneSet rest = HR_LANES_OF_W(t_in * HR_INTERVAL_NEAR <= t_out * HR_INTERVAL_FAR); rest;
           rest = without_first(rest)) {
        const uint lane = first_lane(rest);
        if (any_ray_enters(p, node, lane)) entered |= lane_bit(lane);
      }
      if (entered) {
        float t_near[HR_W] HR_ALIGN_AS_VECTOR(HR_W);
        *(HR_FLOATW*)t_near = t_in;
        at = any ? last_child(node, entered, t_near, stack, &size)
                 : nearest_child(view, node, entered, t_near, stack, &size);
        continue;
      }
    } else {
      const uint leaf = (uint)~at;
      global const float* block = block_at(view, leaf >> 4);
      bool updated = false;
      if (HR_HAS(INSTANCES) && is_instance_leaf(at)) intersect_packet_instance(view, p, at, &updated);
      for (uint n = leaf & 15u; n > 0; n--, block += HR_BLOCK_ROWS * HR_L) {
        if (HR_HAS(TRIANGLES)) intersect_packet_block(view, p, &cone, block, &updated);
        if (HR_HAS_ONE_BY_ONE) intersect_packet_others(view, p, block, &updated);
      }
      if (updated) {
        if (any) finish_hit_rays(p);
        p->t_most = most_t(p);
        if (p->t_most < 0) return;
      }
    }
    StackEntry entry = 0;
    bool found = false;
    while (size > 0 && !found) {
      entry = stack[--size];
      found = as_float((uint)(entry >> 32)) * HR_INTERVAL_NEAR <= p->t_most * HR_INTERVAL_FAR;
    }
    if (!found) return;
    at = (int)(uint)entry;
  }
}

#endif

#endif

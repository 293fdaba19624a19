// Boxes bottom-up: each leaf climbs, and at every inner node the second child to arrive goes on (Karras 2012, section
// 4).
#include "lib/primitive.h"

#ifndef HR_LOCAL_SIZE
#define HR_LOCAL_SIZE 64
#endif

#define HR_NO_PARENT 0xffffffffu

// The arrival counter orders the sibling's box before its reader: with OpenCL 2 atomics by acquire and release, else by
// a fence on both sides and volatile access, which OpenCL 1.2 devices honour.
#if defined(__opencl_c_atomic_order_acq_rel) && defined(__opencl_c_atomic_scope_device)
static inline uint arrive(volatile global uint* flag) {
  return atomic_fetch_add_explicit((volatile global atomic_uint*)flag, 1u, memory_order_acq_rel, memory_scope_device);
}
#else
static inline uint arrive(volatile global uint* flag) {
  mem_fence(CLK_GLOBAL_MEM_FENCE);
  const uint before = atomic_inc(flag);
  mem_fence(CLK_GLOBAL_MEM_FENCE);
  return before;
}
#endif

// A node is 16 floats: x of left lo, left hi, right lo, right hi, then y, then z, then the references.
static inline void write_box(volatile global float* node, uint side, Box box) {
  node[2 * side] = box.lo.x;
  node[2 * side + 1] = box.hi.x;
  node[4 + 2 * side] = box.lo.y;
  node[4 + 2 * side + 1] = box.hi.y;
  node[8 + 2 * side] = box.lo.z;
  node[8 + 2 * side + 1] = box.hi.z;
}

static inline Box read_box(volatile global const float* node, uint side) {
  Box box;
  box.lo = (float4)(node[2 * side], node[4 + 2 * side], node[8 + 2 * side], 0.0f);
  box.hi = (float4)(node[2 * side + 1], node[4 + 2 * side + 1], node[8 + 2 * side + 1], 0.0f);
  return box;
}

// Writes the leaf records in Morton order and all boxes. order[i] = primitive of leaf i. With count = 0 it writes the
// leaf of NaNs that no ray meets. Launch: max(count, 1) items, rounded up to the local size; flags must be zero.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void bvh_refit_nodes(
    global const float* restrict positions, global const uint4* restrict triangles,
    global const Sphere* restrict spheres, const uint triangle_count, global const uint* restrict order,
    global BvhLeaf* restrict leaves, global float* nodes, global const uint* restrict node_parents,
    global const uint* restrict leaf_parents, global uint* flags, const uint count) {
  const uint i = (uint)get_global_id(0);
  if (i >= max(count, 1u)) return;
  BvhLeaf leaf;
  Box box;
  if (count == 0) {
    leaf.a = (float4)(NAN, NAN, NAN, as_float(HR_NO_PRIMITIVE));
    leaf.b = (float4)(NAN);
    leaf.c = (float4)(NAN);
    box.lo = (float4)(0.0f);
    box.hi = (float4)(0.0f);
  } else {
    const uint primitive = order[i];
    leaf = load_primitive(positions, triangles, spheres, triangle_count, primitive);
    box = primitive_box(leaf, primitive < triangle_count);
  }
  leaves[i] = leaf;
  volatile global float* floats = nodes;
  if (count <= 1) {
    write_box(floats, 0, box);
    write_box(floats, 1, box);
    return;
  }
  uint parent = leaf_parents[i];
  while (parent != HR_NO_PARENT) {
    const uint node = parent >> 1, side = parent & 1u;
    write_box(floats + 16 * (ulong)node, side, box);
    if (arrive(&flags[node]) == 0) return;
    const Box sibling = read_box(floats + 16 * (ulong)node, 1 - side);
    box.lo = min(box.lo, sibling.lo);
    box.hi = max(box.hi, sibling.hi);
    parent = node_parents[node];
  }
}

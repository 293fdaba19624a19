// The radix tree over sorted Morton codes (Karras 2012) with its boxes, in one pass.
//
// Karras emits all nodes in parallel and finds boxes bottom-up afterwards, with atomics. As the radix tree is the
// Cartesian tree of the prefixes that neighbours share, a sweep with a stack makes nodes and boxes together: a range is
// closed when the prefix to its right is shorter than the one to its left. It is agglomerate.cl with nothing to choose,
// its stack in private memory; what reaches over a chunk's ends is left to bvh_join_chunks.
#include "bvh/arena.h"

typedef struct Range {
  float4 lo, hi;
  uint reference, primitives;
  int left;  // prefix shared with what lies left of it
} Range;

static inline void close_range(global BinaryNode* node, uint index, Range* below, const Range* top) {
  BinaryNode n;
  n.x = (float4)(below->lo.x, below->hi.x, top->lo.x, top->hi.x);
  n.y = (float4)(below->lo.y, below->hi.y, top->lo.y, top->hi.y);
  n.z = (float4)(below->lo.z, below->hi.z, top->lo.z, top->hi.z);
  n.child = (uint4)(below->reference, top->reference, below->primitives, top->primitives);
  *node = n;
  below->lo = min(below->lo, top->lo);
  below->hi = max(below->hi, top->hi);
  below->reference = index;
  below->primitives += top->primitives;
}

// As bvh_cluster_chunks with limit = keep = 1. Launch: G items.
kernel void bvh_radix_chunks(global const ulong* restrict keys, const uint index_bits, const uint count,
                             global const Box* restrict boxes, global BinaryNode* restrict nodes,
                             global float* restrict arenas, const uint arena_capacity, global int2* restrict pending,
                             global uint* restrict pending_count, global uint2* restrict node_ranges) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint begin = chunk_begin(count, g, groups), end = chunk_begin(count, g + 1, groups);
  const ulong index_mask = (1ul << index_bits) - 1;
  Range stack[HR_SWEEP_DEPTH];
  uint size = 0, next_node = begin;
  int left = begin > 0 && begin < end ? shared_prefix(keys, begin) : -1;
  for (uint i = begin; i < end; i++) {
    const uint primitive = (uint)(keys[i] & index_mask);
    const Box box = boxes[primitive];
    Range* top = &stack[size++];
    top->lo = box.lo;
    top->hi = box.hi;
    top->reference = ~primitive;
    top->primitives = 1;
    top->left = left;
    left = i + 1 < count ? shared_prefix(keys, i + 1) : -1;
    while (size >= 2 && stack[size - 1].left > left && stack[size - 1].left > stack[size - 2].left) {
      close_range(nodes + next_node, next_node, &stack[size - 2], &stack[size - 1]);
      next_node++;
      size--;
    }
  }
  Arena arena = open_arena(arenas, g, arena_capacity, nodes, 0);
  for (uint e = 0; e < size; e++) {
    push_cluster(&arena, stack[e].lo, stack[e].hi, stack[e].reference, stack[e].primitives);
    pending[g * HR_SWEEP_DEPTH + e] = (int2)(1, stack[e].left);
  }
  pending_count[g] = size;
  node_ranges[g] = (uint2)(begin, next_node);
}

// Emission of the binary radix tree over sorted Morton codes, all inner nodes in parallel (Karras 2012, section 4).
#include "shared/bvh_types.h"

#ifndef HR_LOCAL_SIZE
#define HR_LOCAL_SIZE 64
#endif

// A parent's reference in parents[]: node << 1 | 1 if the child is the right one. The root has HR_NO_PARENT.
#define HR_NO_PARENT 0xffffffffu

// Length of the common prefix of keys i and j; equal keys are told apart by their indices; -1 outside the array.
static inline int common_prefix(global const ulong* keys, int n, int i, int j) {
  if (j < 0 || j >= n) return -1;
  const ulong differ = keys[i] ^ keys[j];
  return differ != 0 ? (int)clz(differ) : 64 + (int)clz((uint)(i ^ j));
}

static inline void link_child(global BvhNode* nodes, global uint* node_parents, global uint* leaf_parents, int node,
                              int child, bool is_leaf, uint side) {
  const uint reference = (uint)(is_leaf ? ~child : child);
  if (side == 0) {
    nodes[node].child.x = reference;
  } else {
    nodes[node].child.y = reference;
  }
  const uint parent = (uint)node << 1 | side;
  if (is_leaf) {
    leaf_parents[child] = parent;
  } else {
    node_parents[child] = parent;
  }
}

// Inner node i of n - 1. A tree of one primitive has one node with that leaf on both sides (refit.cl fills both).
// node_parents and flags have n - 1 entries (at least 1); flags are zeroed for refit. Launch: max(n - 1, 1) items,
// rounded up to the local size.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void bvh_emit_nodes(
    global const ulong* restrict keys, global BvhNode* restrict nodes, global uint* restrict node_parents,
    global uint* restrict leaf_parents, global uint* restrict flags, const uint count) {
  const int n = (int)count;
  const int i = (int)get_global_id(0);
  if (i >= max(n - 1, 1)) return;
  flags[i] = 0;
  nodes[i].child = (uint4)(0);
  if (i == 0) node_parents[0] = HR_NO_PARENT;
  if (n <= 1) {
    nodes[0].child = (uint4)(~0u, ~0u, 0, 0);
    leaf_parents[0] = 0;
    return;
  }
  // Direction of the range, then its other end by doubling and bisection.
  const int d = common_prefix(keys, n, i, i + 1) > common_prefix(keys, n, i, i - 1) ? 1 : -1;
  const int least = common_prefix(keys, n, i, i - d);
  int reach = 2;
  while (common_prefix(keys, n, i, i + reach * d) > least) reach <<= 1;
  int length = 0;
  for (int step = reach >> 1; step > 0; step >>= 1) {
    if (common_prefix(keys, n, i, i + (length + step) * d) > least) length += step;
  }
  const int j = i + length * d;
  // The highest differing bit inside the range is where it splits.
  const int prefix = common_prefix(keys, n, i, j);
  int split = 0;
  int step = length;
  do {
    step = (step + 1) >> 1;
    if (common_prefix(keys, n, i, i + (split + step) * d) > prefix) split += step;
  } while (step > 1);
  const int gamma = i + split * d + min(d, 0);
  link_child(nodes, node_parents, leaf_parents, i, gamma, min(i, j) == gamma, 0);
  link_child(nodes, node_parents, leaf_parents, i, gamma + 1, max(i, j) == gamma + 1, 1);
}

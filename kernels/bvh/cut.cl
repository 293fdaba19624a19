// Which nodes of the binary tree become nodes of W children, and which become leaves: the cut of least cost, found
// bottom-up by dynamic programming (Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through
// Compressed Wide BVHs", section 3.1).
#include "bvh/cut.h"
#include "lib/accel_layout.h"
#include "lib/lanes.h"

// ways[k], 1 <= k < W: what the rays pay below a subtree that hangs in a node as at most k children.
typedef struct Ways {
  float cost[HR_W];
} Ways;

static inline Ways all_ways(float cost) {
  Ways w;
  for (uint k = 0; k < HR_W; k++) w.cost[k] = cost;
  return w;
}

// What a ray pays that enters a leaf, in visits of a node.
static inline float leaf_cost(float entry, uint primitives) {
  return entry * (HR_LEAF_COST + HR_BLOCK_COST * (float)((primitives + HR_L - 1) / HR_L));
}

static inline Ways ways_of(int reference, uint primitives, Box box, global const float* costs, global const uint* cuts,
                           float4 metric) {
  if (reference < 0 || cuts[reference] == HR_CUT_LEAF) {
    return all_ways(leaf_cost(entry_cost(box, metric), primitives));
  }
  Ways w;
  for (uint k = 0; k < HR_W; k++) w.cost[k] = costs[(ulong)reference * HR_W + k];
  return w;
}

// shared[j - 1]: how to share j >= 2 children best: the cost, and in its lowest three bits how many go to side a. Such
// numbers compare as they are, as costs are not negative.
static inline void share_ways(const Ways* a, const Ways* b, uint* shared) {
  for (uint j = 0; j < HR_W; j++) shared[j] = 0x7fffffffu;
    // A third faster than loops.
#pragma unroll
  for (uint j = 2; j <= HR_W; j++) {
#pragma unroll
    for (uint k = 1; k < j; k++) {
      shared[j - 1] = min(shared[j - 1], (as_uint(a->cost[k] + b->cost[j - k]) & ~7u) | k);
    }
  }
}

// cuts[n] and costs[n W + k] of the nodes n in ranges[first + g], in this order; their children must be done. A subtree
// of at most max_leaf primitives may be a leaf. What one block holds is one, unless it is so large that several leaves
// may cost less: rays through a room need not test all its walls. Launch: G items.
kernel void bvh_cut_ranges(global const BinaryNode* restrict binary, global const uint2* restrict ranges,
                           const uint first, global float* costs, global uint* cuts, const float4 metric,
                           const uint max_leaf) {
  const uint g = (uint)get_global_id(0);
  const uint2 range = ranges[first + g];
  for (uint n = range.x; n < range.y; n++) {
    const BinaryNode node = binary[n];
    const uint primitives = node.child.z + node.child.w;
    const Box left = left_box(node), right = right_box(node);
    const float entry = entry_cost(box_union(left, right), metric);
    if (primitives <= min(max_leaf, (uint)HR_L) && entry <= HR_LARGE_LEAF) {
      cuts[n] = HR_CUT_LEAF;
      continue;
    }
    const Ways a = ways_of((int)node.child.x, node.child.z, left, costs, cuts, metric);
    const Ways b = ways_of((int)node.child.y, node.child.w, right, costs, cuts, metric);
    uint shared[HR_W];
    share_ways(&a, &b, shared);
    Ways here;
    uint cut = 0;
    // As one child: a node of its own, whose W children both sides share, or a leaf.
    const float as_leaf = leaf_cost(entry, primitives);
    here.cost[0] = 0.0f;
    here.cost[1] = entry + as_float(shared[HR_W - 1] & ~7u);
    if (primitives <= max_leaf && as_leaf <= here.cost[1]) {
      here.cost[1] = as_leaf;
      cut = HR_CUT_LEAF;
    } else {
      cut = (shared[HR_W - 1] & 7u) << HR_CUT_SHIFT(HR_W);
    }
    // As up to j children: no more than j - 1 of them, or both sides share them.
    for (uint j = 2; j < HR_W; j++) {
      const float split = as_float(shared[j - 1] & ~7u);
      if (split < here.cost[j - 1]) cut |= (shared[j - 1] & 7u) << HR_CUT_SHIFT(j);
      here.cost[j] = min(split, here.cost[j - 1]);
    }
    cuts[n] = cut;
    for (uint k = 0; k < HR_W; k++) costs[(ulong)n * HR_W + k] = here.cost[k];
  }
}

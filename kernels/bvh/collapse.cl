// From the binary tree, cut by bvh/cut.cl, to the shape of the wide one. One item opens the top until there are enough
// subtrees for all others, each of which counts what its subtree becomes; a scan over the counts then says where
// everything goes. No atomics: the same scene gives the same bytes.
#include "bvh/wide_walk.h"

// Opens the top of the tree, most primitives first, until `target` subtrees wait, or none has more than min_primitives,
// or `most_nodes` are drafted; the subtrees become regions 1, 2, ... A drafted leaf has its binary node in row 7.
// root[0]: the binary tree. totals[0] = number of regions. Launch: 1 item.
kernel void bvh_collapse_top(global const BinaryNode* restrict binary, global const uint* restrict cuts,
                             global const int* restrict root, const uint primitives, const float4 lo, const float4 hi,
                             global float* draft_nodes, global CollapseRegion* regions, global uint* restrict totals,
                             const uint target, const uint min_primitives, const uint most_nodes) {
  uint waiting = 1, node_count = 0, block_count = 0, stack = 1;
  regions[1].root = root[0];
  regions[1].primitives = primitives;
  regions[1].stack_load = 0;
  regions[1].parent_slot = 0;
  const Box bounds = {lo, hi};
  while (waiting > 0 && waiting < target && node_count < most_nodes) {
    uint most = 1;
    for (uint i = 2; i <= waiting; i++) {
      if (regions[i].primitives > regions[most].primitives) most = i;
    }
    CollapseRegion at;
    at.root = regions[most].root;
    at.primitives = regions[most].primitives;
    at.stack_load = regions[most].stack_load;
    at.parent_slot = regions[most].parent_slot;
    if (at.primitives <= min_primitives && node_count > 0) break;
    // Only what is set so far.
    regions[most].root = regions[waiting].root;
    regions[most].primitives = regions[waiting].primitives;
    regions[most].stack_load = regions[waiting].stack_load;
    regions[most].parent_slot = regions[waiting].parent_slot;
    waiting--;
    Children c;
    gather_children(binary, cuts, at.root, at.primitives, bounds, &c);
    order_children(&c);
    const uint node = node_count++;
    if (node > 0) ((global int*)draft_nodes)[at.parent_slot] = (int)node;
    stack = max(stack, at.stack_load + c.size);
    global float* draft = draft_nodes + node * HR_NODE_WORDS(HR_W);
    int child[HR_W];
    for (uint i = 0; i < c.size; i++) {
      child[i] = 0;
      if (c.leaf[i]) {
        child[i] = leaf_reference(block_count, c.primitives[i]);
        block_count += leaf_blocks(c.primitives[i]);
      } else {
        waiting++;
        regions[waiting].root = c.reference[i];
        regions[waiting].primitives = c.primitives[i];
        regions[waiting].stack_load = at.stack_load + c.size - 1;
        regions[waiting].parent_slot = node * HR_NODE_WORDS(HR_W) + HR_NODE_CHILD_ROW * HR_W + i;
      }
    }
    write_node(draft, &c, child);
    for (uint i = 0; i < c.size; i++) {
      if (c.leaf[i]) ((global int*)draft)[7 * HR_W + i] = c.reference[i];
    }
  }
  regions[0].nodes = node_count;
  regions[0].blocks = block_count;
  regions[0].stack = stack;
  for (uint i = 1; i <= waiting; i++) ((global int*)draft_nodes)[regions[i].parent_slot] = HR_REGION_FLAG | (int)i;
  totals[0] = waiting + 1;
}

// Nodes, blocks and stack of region g + 1. Launch: one item a region that may be.
kernel void bvh_count_regions(global const BinaryNode* restrict binary, global const uint* restrict cuts,
                              global CollapseRegion* regions, global const uint* restrict totals) {
  const uint g = (uint)get_global_id(0) + 1;
  if (g >= totals[0]) return;
  const CollapseRegion region = regions[g];
  WideWalk walk = start_walk(binary, &region);
  while (walk.size > 0) {
    Children c;
    int child[HR_W];
    step_walk(&walk, binary, cuts, false, &c, child);
  }
  regions[g].nodes = walk.nodes;
  regions[g].blocks = walk.blocks;
  regions[g].stack = walk.stack;
}

// Where each region's nodes and blocks go: behind first_node nodes and first_block blocks of other trees, the top first
// and then by size, as the nodes of a region (wide_walk.h). totals[1] = nodes, [2] = blocks, [3] = stack. Launch: 1
// item.
kernel void bvh_place_regions(global CollapseRegion* restrict regions, global uint* restrict totals,
                              const uint first_node, const uint first_block) {
  uint nodes = 0, blocks = 0, stack = 0;
  uint most = 0xffffffffu, after = 0;  // primitives and number of the region placed last
  for (uint k = 0; k < totals[0]; k++) {
    uint g = 0;
    if (k > 0) {
      uint next = 0;
      for (uint i = 1; i < totals[0]; i++) {
        const uint size = regions[i].primitives;
        const bool waits = size < most || (size == most && i > after);
        if (waits && (next == 0 || size > regions[next].primitives)) next = i;
      }
      g = next;
      most = regions[g].primitives;
      after = g;
    }
    regions[g].final_node = first_node + nodes;
    regions[g].final_block = first_block + blocks;
    nodes += regions[g].nodes;
    blocks += regions[g].blocks;
    stack = max(stack, regions[g].stack);
  }
  totals[1] = nodes;
  totals[2] = blocks;
  totals[3] = stack;
}

// The collapsed tree goes to its place: nodes from the drafts of all regions, and the leaves' blocks with geometry.
#include "lib/accel_layout.h"
#include "lib/block_write.h"
#include "lib/primitive.h"
#include "shared/bvh_types.h"

// Where each region's nodes and blocks go: behind first_node nodes and first_block blocks of other trees. totals[1] =
// nodes, [2] = blocks, [3] = stack. Launch: 1 item.
kernel void bvh_place_regions(global CollapseRegion* restrict regions, global uint* restrict totals,
                              const uint first_node, const uint first_block) {
  uint nodes = 0, blocks = 0, stack = 0;
  for (uint g = 0; g < totals[0]; g++) {
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

// Copies region g's draft to its place; accel_nodes begins with node first_node. Launch: one item a region.
kernel void bvh_emit_nodes(global const float* restrict draft_nodes, global const CollapseRegion* restrict regions,
                           global float* restrict accel_nodes, const uint region_count, const uint first_node) {
  const uint g = (uint)get_global_id(0);
  if (g >= region_count) return;
  const CollapseRegion region = regions[g];
  for (uint n = 0; n < region.nodes; n++) {
    global const float* from = draft_nodes + (ulong)(region.draft_node + n) * HR_NODE_WORDS(HR_W);
    global float* to = accel_nodes + (ulong)(region.final_node - first_node + n) * HR_NODE_WORDS(HR_W);
    for (uint i = 0; i < HR_NODE_CHILD_ROW * HR_W; i++) to[i] = from[i];
    for (uint i = HR_NODE_CHILD_ROW * HR_W; i < HR_NODE_WORDS(HR_W); i++) {
      int child = ((global const int*)from)[i];
      if (i >= (HR_NODE_CHILD_ROW + 1) * HR_W) {
        child = 0;
      } else if (child == -1) {
        // A lane without child.
      } else if (child < 0) {
        child = (int)~((uint)~child + (region.final_block << 4));
      } else if (child & HR_REGION_FLAG) {
        child = (int)regions[child ^ HR_REGION_FLAG].final_node;
      } else {
        child += (int)region.final_node;
      }
      ((global int*)to)[i] = child;
    }
  }
}

// Fills region g's blocks with the primitives' geometry; unused lanes hold a point, which no ray meets. accel_blocks
// begins with block first_block. Launch: one item a region.
kernel void bvh_emit_blocks(global const float* restrict positions, global const uint4* restrict triangles,
                            global const Sphere* restrict spheres, const uint triangle_count, const uint first_triangle,
                            global const uint* restrict leaf_order, global const uint* restrict descriptors,
                            global const CollapseRegion* restrict regions, global float* restrict accel_blocks,
                            const uint region_count, const uint first_block) {
  const uint g = (uint)get_global_id(0);
  if (g >= region_count) return;
  const CollapseRegion region = regions[g];
  const Primitive none = {(float4)(0.0f), (float4)(0.0f), (float4)(0.0f)};
  for (uint b = 0; b < region.blocks; b++) {
    const uint descriptor = descriptors[region.first_leaf + b];
    const uint first = region.first_leaf + (descriptor >> 4), used = descriptor & 15u;
    global float* block = accel_blocks + (ulong)(region.final_block - first_block + b) * (HR_BLOCK_ROWS * HR_L);
    for (uint lane = 0; lane < HR_L; lane++) {
      if (lane >= used) {
        write_lane(block, lane, none, false, HR_NO_PRIMITIVE);
        continue;
      }
      const uint primitive = leaf_order[first + lane];
      const Primitive p = load_primitive(positions, triangles + first_triangle, spheres, triangle_count, primitive);
      write_lane(block, lane, p, primitive < triangle_count, primitive);
    }
  }
}

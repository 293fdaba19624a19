// New geometry in an old tree, after vertices moved: blocks by the primitives they hold, then boxes bottom-up. A
// region's children come behind their parents, so one item goes through its nodes from the last to the first; the top,
// which refers to all other regions, comes after them in a launch of its own.
#include "lib/accel_layout.h"
#include "lib/block_write.h"
#include "lib/primitive.h"
#include "lib/tree_chunks.h"
#include "shared/bvh_types.h"

static inline Box primitive_bounds(const Geometry* geometry, uint primitive) {
  const Primitive p = load_primitive(geometry, primitive);
  Box box = primitive_box(p);
  if (primitive_status(p, box) == HR_PRIMITIVE_NON_FINITE) {
    box.lo = (float4)(INFINITY);
    box.hi = (float4)(-INFINITY);
  }
  return box;
}

// Region first_region + g: its blocks and boxes. Launch: one item a region.
kernel void bvh_refit_regions(HR_GEOMETRY_PARAMETERS const uint first_triangle,
                              global const CollapseRegion* restrict regions, const uint first_region,
                              const uint region_count, HR_MORE_CHUNKS(HR_CHUNK_WRITTEN) global float* accel_nodes,
                              global float* restrict accel_blocks) {
  const uint g = first_region + (uint)get_global_id(0);
  if (g >= region_count) return;
  const CollapseRegion region = regions[g];
  HR_MAKE_GEOMETRY(first_triangle)
  const NodeArrays nodes = {HR_NODE_ARRAYS};
  const BlockArrays blocks = {HR_BLOCK_ARRAYS};
  for (uint b = 0; b < region.blocks; b++) {
    global float* block = written_block(&blocks, region.final_block + b);
    for (uint lane = 0; lane < HR_L; lane++) {
      const uint primitive = ((global const uint*)block)[HR_BLOCK_PRIMITIVE_ROW * HR_L + lane];
      if (primitive == HR_NO_PRIMITIVE) continue;
      write_lane(block, lane, load_primitive(&geometry, primitive), primitive);
    }
  }
  for (uint n = region.nodes; n-- > 0;) {
    global float* node = written_node(&nodes, region.final_node + n);
    for (uint i = 0; i < HR_W; i++) {
      const int child = ((global const int*)node)[HR_NODE_CHILD_ROW * HR_W + i];
      Box box = {(float4)(INFINITY), (float4)(-INFINITY)};
      if (child >= 0) {
        global const float* below = written_node(&nodes, (uint)child);
        for (uint k = 0; k < HR_W; k++) {
          box.lo = min(box.lo, (float4)(below[k], below[2 * HR_W + k], below[4 * HR_W + k], 0.0f));
          box.hi = max(box.hi, (float4)(below[HR_W + k], below[3 * HR_W + k], below[5 * HR_W + k], 0.0f));
        }
      } else if (child != -1) {
        const uint leaf = (uint)~child;
        global const uint* primitives =
            (global const uint*)written_block(&blocks, leaf >> 4) + HR_BLOCK_PRIMITIVE_ROW * HR_L;
        for (uint k = 0; k < (leaf & 15u) * HR_L; k++) {
          const uint primitive = primitives[k / HR_L * (HR_BLOCK_ROWS * HR_L) + k % HR_L];
          if (primitive == HR_NO_PRIMITIVE) continue;
          const Box one = primitive_bounds(&geometry, primitive);
          box.lo = min(box.lo, one.lo);
          box.hi = max(box.hi, one.hi);
        }
      }
      node[i] = box.lo.x;
      node[HR_W + i] = box.hi.x;
      node[2 * HR_W + i] = box.lo.y;
      node[3 * HR_W + i] = box.hi.y;
      node[4 * HR_W + i] = box.lo.z;
      node[5 * HR_W + i] = box.hi.z;
    }
  }
}

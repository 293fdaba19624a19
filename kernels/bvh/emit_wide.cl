// The wide tree goes to its place: nodes, and the leaves' blocks with geometry.
#include "bvh/wide_walk.h"
#include "lib/block_write.h"
#include "lib/primitive.h"
#include "lib/tree_chunks.h"

#define HR_MOST_IN_LEAF (HR_MAX_LEAF_BLOCKS * HR_L)

// The `size` primitives below a binary node.
static inline void list_primitives(global const BinaryNode* binary, int reference, uint size, int* primitives) {
  primitives[0] = reference;
  // Level by level, so that the reads of a level wait for memory together.
  for (uint found = 1; found < size;) {
    for (uint i = found; i-- > 0;) {
      if (primitives[i] < 0) continue;
      const uint4 child = binary[primitives[i]].child;
      primitives[i] = (int)child.x;
      primitives[found++] = (int)child.y;
    }
  }
  for (uint i = 0; i < size; i++) primitives[i] = ~primitives[i];
}

// The primitives into the blocks from number `to` on; unused lanes hold NaN, which no ray meets.
static inline void write_leaf(const Geometry* geometry, const int* primitives, uint size, const BlockArrays* blocks,
                              uint to) {
  for (uint first = 0; first < size; first += HR_L) {
    global float* block = written_block(blocks, to++);
    for (uint lane = 0; lane < HR_L; lane++) {
      if (first + lane >= size) {
        write_lane(block, lane, no_primitive(), HR_NO_PRIMITIVE);
        continue;
      }
      const uint primitive = (uint)primitives[first + lane];
      write_lane(block, lane, load_primitive(geometry, primitive), primitive);
    }
  }
}

// Asks for the vertices of these primitives, all at once, before they are needed one by one.
static inline void prefetch_geometry(const Geometry* geometry, const int* primitives, uint size) {
  for (uint i = 0; i < size; i++) HR_PREFETCH(geometry->triangles + primitives[i]);
  for (uint i = 0; i < size; i++) {
    if ((uint)primitives[i] >= geometry->triangle_count) continue;
    const uint4 corner = geometry->triangles[primitives[i]];
    HR_PREFETCH(geometry->positions + (ulong)corner.x * 3);
    HR_PREFETCH(geometry->positions + (ulong)corner.y * 3);
    HR_PREFETCH(geometry->positions + (ulong)corner.z * 3);
  }
}

// What a leaf of the tree over instances refers to: it holds one of them, and no blocks.
static inline int instance_reference(int leaf) { return (int)~(((uint)~leaf + 1) << 4); }

// Region 0 from its draft, the others by a walk like the one that counted them. The nodes begin with number
// first_node, the blocks with number first_block, the geometry with first_triangle. Launch: one item a region.
kernel void bvh_emit_regions(global const BinaryNode* restrict binary, global const uint* restrict cuts,
                             global const float* restrict draft_nodes, global const CollapseRegion* restrict regions,
                             const uint region_count, const uint of_instances, const uint first_node,
                             const uint first_block, HR_GEOMETRY_PARAMETERS const uint first_triangle,
                             HR_MORE_CHUNKS(HR_CHUNK_WRITTEN) global float* restrict accel_nodes,
                             global float* restrict accel_blocks) {
  const uint g = (uint)get_global_id(0);
  if (g >= region_count) return;
  const CollapseRegion region = regions[g];
  HR_MAKE_GEOMETRY(first_triangle)
  const NodeArrays nodes = {HR_NODE_ARRAYS};
  const BlockArrays blocks = {HR_BLOCK_ARRAYS};
  const uint to_node = region.final_node - first_node, to_block = region.final_block - first_block;
  if (g == 0) {
    for (uint i = 0; i < region.nodes * HR_NODE_WORDS(HR_W); i++) {
      const uint row = i / HR_W % 8;
      int word = ((global const int*)draft_nodes)[i];
      if (row == HR_NODE_CHILD_ROW && word >= 0) {
        word =
            (int)(word & HR_REGION_FLAG ? regions[word ^ HR_REGION_FLAG].final_node : region.final_node + (uint)word);
      } else if (row == HR_NODE_CHILD_ROW && word != -1) {
        const int leaf = ((global const int*)draft_nodes)[i + HR_W];
        const uint block = (uint)~word >> 4, size = primitives_below(binary, leaf);
        if (of_instances) {
          word = instance_reference(leaf);
        } else {
          int primitives[HR_MOST_IN_LEAF];
          list_primitives(binary, leaf, size, primitives);
          write_leaf(&geometry, primitives, size, &blocks, to_block + block);
          word = leaf_reference(region.final_block + block, size);
        }
      } else if (row > HR_NODE_CHILD_ROW) {
        word = 0;
      }
      ((global int*)written_node(&nodes, to_node + i / HR_NODE_WORDS(HR_W)))[i % HR_NODE_WORDS(HR_W)] = word;
    }
    return;
  }
  WideWalk walk = start_walk(binary, &region);
  while (walk.size > 0) {
    Children c;
    int child[HR_W];
    const uint node = step_walk(&walk, binary, cuts, true, &c, child);
    // The leaves' primitives, one leaf after another.
    int primitives[HR_W * HR_MOST_IN_LEAF];
    uint listed = 0;
    for (uint i = 0; i < c.size && !of_instances; i++) {
      if (!c.leaf[i]) continue;
      list_primitives(binary, c.reference[i], c.primitives[i], primitives + listed);
      listed += c.primitives[i];
    }
    prefetch_geometry(&geometry, primitives, listed);
    listed = 0;
    for (uint i = 0; i < c.size; i++) {
      if (!c.leaf[i]) {
        child[i] += (int)region.final_node;
      } else if (of_instances) {
        child[i] = instance_reference(c.reference[i]);
      } else {
        const uint block = (uint)~child[i] >> 4;
        write_leaf(&geometry, primitives + listed, c.primitives[i], &blocks, to_block + block);
        listed += c.primitives[i];
        child[i] = leaf_reference(region.final_block + block, c.primitives[i]);
      }
    }
    write_node(written_node(&nodes, to_node + node), &c, child);
  }
}

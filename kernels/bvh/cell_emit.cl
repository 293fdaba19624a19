// Trees of cells, level by level: the next level's cells and references, and drafts of nodes and leaves; at the end,
// from the deepest level up, everything goes to its place. Count, scan, emit: the same scene gives the same bytes.
#include "lib/block_write.h"
#include "lib/chunk.h"
#include "lib/space_cell.h"

// What a cell became: its final reference, or with this flag the next level's cell that took its place.
#define HR_KEPT_FLAG 0x40000000

// Drafts cut cells as nodes, whose children are cells of the next level, and makes those; leaves[l] = (first of the
// leaf's references, how many, first block, blocks); records: first block, blocks. *_base: what earlier levels have.
// sums after an exclusive scan, counter by counter. Launch: G items.
kernel void bvh_emit_cells(global const SpaceCell* restrict cells, const uint cell_count,
                           global const uint* restrict prefix, global const uint* restrict offsets,
                           global const uint* restrict sums, global CellVerdict* restrict verdicts,
                           global SpaceCell* restrict next_cells, global float* restrict draft_nodes,
                           global int* restrict results, global uint4* restrict leaves, global uint2* restrict records,
                           const uint axis_bits, const uint node_base, const uint block_base, const uint record_base) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  uint at[HR_CELL_SUMS];
  for (uint j = 0; j < HR_CELL_SUMS; j++) at[j] = sums[j * groups + g] - sums[j * groups];
  const uint end = chunk_begin(cell_count, g + 1, groups);
  for (uint c = chunk_begin(cell_count, g, groups); c < end; c++) {
    const SpaceCell cell = cells[c];
    const int action = verdicts[c].action;
    if (action == HR_VERDICT_LEAF) {
      const uint blocks = (cell.references + HR_L - 1) / HR_L;
      const uint first_block = block_base + at[HR_SUM_BLOCKS];
      leaves[at[HR_SUM_LEAVES]++] = (uint4)(at[HR_SUM_LEAF_REFERENCES], cell.references, first_block, blocks);
      if (blocks >= HR_MANY_BLOCKS) {
        results[c] = (int)~((record_base + at[HR_SUM_RECORDS]) << 4 | HR_MANY_BLOCKS);
        records[at[HR_SUM_RECORDS]++] = (uint2)(first_block, blocks);
      } else {
        results[c] = (int)~(first_block << 4 | blocks);
      }
      verdicts[c].first[0] = at[HR_SUM_LEAF_REFERENCES];
      at[HR_SUM_LEAF_REFERENCES] += cell.references;
      at[HR_SUM_BLOCKS] += blocks;
      continue;
    }
    if (action == HR_VERDICT_KEEP) {
      SpaceCell same = cell;
      same.first = at[HR_SUM_REFERENCES];
      verdicts[c].first[0] = same.first;
      results[c] = (int)(HR_KEPT_FLAG | at[HR_SUM_CELLS]);
      next_cells[at[HR_SUM_CELLS]++] = same;
      at[HR_SUM_REFERENCES] += cell.references;
      continue;
    }
    results[c] = (int)(node_base + at[HR_SUM_NODES]);
    global float* node = draft_nodes + (ulong)at[HR_SUM_NODES]++ * HR_CELL_NODE_WORDS;
    global int* children = (global int*)node + HR_CELL_FIRST_CHILD;
#if HR_ACCEL == HR_ACCEL_OCTREE
    node[0] = cell.plane.x;
    node[1] = cell.plane.y;
    node[2] = cell.plane.z;
    node[3] = 0;
#else
    node[0] = along(cell.plane, cell.axis);
    children[2] = (int)cell.axis;
#endif
    verdicts[c].parts = cell.axis;
    for (uint part = 0; part < HR_CELL_PARTS; part++) {
      const uint count = count_before(prefix, offsets, groups, cell_count, c + 1, part) -
                         count_before(prefix, offsets, groups, cell_count, c, part);
      verdicts[c].first[part] = at[HR_SUM_REFERENCES];
      children[part] = HR_NO_CHILD;
      if (count == 0) continue;
      SpaceCell child = cell;
      const Box box = part_box(&cell, part);
      child.lo = box.lo;
      child.hi = box.hi;
      child.first = at[HR_SUM_REFERENCES];
      child.references = count;
      child.tried = 0;
      child.depth = cell.depth + 1;
#if HR_ACCEL == HR_ACCEL_OCTREE
      for (uint a = 0; a < 3; a++) {
        if (part >> a & 1) child.lattice[a] += 1u << (axis_bits - 1 - cell.level[a]);
        child.level[a]++;
      }
#else
#if HR_ACCEL != HR_ACCEL_KDTREE_MEDIAN
      if (part == 1) child.lattice[cell.axis] += 1u << (axis_bits - 1 - cell.level[cell.axis]);
      child.level[cell.axis]++;
#endif
      child.axis = cell.axis == 2 ? 0 : cell.axis + 1;
#endif
      children[part] = (int)at[HR_SUM_CELLS];
      next_cells[at[HR_SUM_CELLS]++] = child;
      at[HR_SUM_REFERENCES] += count;
    }
  }
}

// Every reference to the parts it touches, or to its leaf. Launch: G items, as bvh_mark_references.
kernel void bvh_emit_references(global const ulong* restrict keys, const uint index_bits,
                                global const Box* restrict boxes, global const SpaceCell* restrict cells,
                                const uint cell_count, global const uint* restrict references,
                                const uint reference_count, global const uchar* restrict marks,
                                global const uint* restrict prefix, global const uint* restrict offsets,
                                global const CellVerdict* restrict verdicts, const uint axis_bits,
                                global uint* restrict next_references, global uint* restrict leaf_references) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint begin = chunk_begin(reference_count, g, groups), end = chunk_begin(reference_count, g + 1, groups);
  if (begin >= end) return;
  uint run[HR_CELL_PARTS], before[HR_CELL_PARTS];
  uint c = cell_of_reference(cells, cell_count, begin);
  SpaceCell cell = cells[c];
  CellVerdict verdict = verdicts[c];
  for (uint k = 0; k < HR_CELL_PARTS; k++) {
    run[k] = offsets[k * groups + g];
    before[k] = count_before(prefix, offsets, groups, cell_count, c, k);
  }
  for (uint r = begin; r < end; r++) {
    if (r >= cell.first + cell.references) {
      cell = cells[++c];
      verdict = verdicts[c];
      for (uint k = 0; k < HR_CELL_PARTS; k++) before[k] = run[k];
    }
    const uint reference = references[r], place = reference & ~HR_OWNED, touched = marks[r];
    if (verdict.action == HR_VERDICT_LEAF) leaf_references[verdict.first[0] + r - cell.first] = place;
    if (verdict.action == HR_VERDICT_KEEP) next_references[verdict.first[0] + r - cell.first] = reference;
    uint owner = HR_CELL_PARTS;
    if (verdict.action == HR_VERDICT_CUT && reference & HR_OWNED) {
      const ulong key = keys[place];
      const Box box = boxes[(uint)(key & ((1ul << index_bits) - 1))];
#if HR_ACCEL == HR_ACCEL_OCTREE
      owner = 0;
      for (uint a = 0; a < 3; a++) {
        if (centre_is_above(&cell, a, key, place, axis_bits, index_bits, box)) owner |= 1u << a;
      }
#else
      owner = centre_is_above(&cell, cell.axis, key, place, axis_bits, index_bits, box) ? 1 : 0;
#endif
    }
    for (uint k = 0; k < HR_CELL_PARTS; k++) {
      if (!(touched >> k & 1)) continue;
      if (verdict.action == HR_VERDICT_CUT) {
        next_references[verdict.first[k] + run[k] - before[k]] = k == owner ? place | HR_OWNED : place;
      }
      run[k]++;
    }
  }
}

// One level's nodes to their place, children and kept cells by what the next level's cells became; level by level,
// deepest first. Launch: G items.
kernel void bvh_place_cells(global int* restrict results, const uint cell_count,
                            global const int* restrict next_results, global const float* restrict draft_nodes,
                            const uint node_count, const uint node_base, global float* restrict accel_nodes) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint cell_end = chunk_begin(cell_count, g + 1, groups), node_end = chunk_begin(node_count, g + 1, groups);
  for (uint c = chunk_begin(cell_count, g, groups); c < cell_end; c++) {
    if (results[c] >= HR_KEPT_FLAG) results[c] = next_results[results[c] ^ HR_KEPT_FLAG];
  }
  for (uint n = chunk_begin(node_count, g, groups); n < node_end; n++) {
    global const int* from = (global const int*)draft_nodes + (ulong)n * HR_CELL_NODE_WORDS;
    global int* to = (global int*)accel_nodes + HR_CELL_HEADER_WORDS + (ulong)(node_base + n) * HR_CELL_NODE_WORDS;
    for (uint i = 0; i < HR_CELL_NODE_WORDS; i++) {
      const bool is_child = i >= HR_CELL_FIRST_CHILD && i < HR_CELL_FIRST_CHILD + HR_CELL_PARTS;
      to[i] = is_child && from[i] != HR_NO_CHILD ? next_results[from[i]] : from[i];
    }
  }
}

// The header. root: what the first level's only cell became. Launch: 1 item.
kernel void bvh_write_header(global float* restrict accel_nodes, global const int* restrict root, const float4 lo,
                             const float4 hi, const uint records_at) {
  accel_nodes[0] = lo.x;
  accel_nodes[1] = lo.y;
  accel_nodes[2] = lo.z;
  accel_nodes[3] = hi.x;
  accel_nodes[4] = hi.y;
  accel_nodes[5] = hi.z;
  ((global int*)accel_nodes)[HR_HEADER_ROOT] = root[0];
  ((global uint*)accel_nodes)[HR_HEADER_RECORDS] = records_at;
}

// One level's leaf records to their place. Launch: 1 item.
kernel void bvh_copy_records(global const uint2* restrict records, const uint count, const uint at,
                             global float* restrict accel_nodes) {
  global uint* to = (global uint*)accel_nodes + at;
  for (uint i = 0; i < count; i++) {
    to[2 * i] = records[i].x;
    to[2 * i + 1] = records[i].y;
  }
}

// Fills the blocks of one level's leaves with geometry; unused lanes hold NaN, which no ray meets. Launch: G items.
kernel void bvh_fill_leaves(HR_GEOMETRY_PARAMETERS global const ulong* restrict keys, const uint index_bits,
                            global const uint4* restrict leaves, const uint leaf_count,
                            global const uint* restrict leaf_references, global float* restrict accel_blocks) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  HR_MAKE_GEOMETRY(0)
  const uint end = chunk_begin(leaf_count, g + 1, groups);
  for (uint l = chunk_begin(leaf_count, g, groups); l < end; l++) {
    const uint4 leaf = leaves[l];
    global float* block = accel_blocks + (ulong)leaf.z * (HR_BLOCK_ROWS * HR_L);
    for (uint i = 0; i < leaf.w * HR_L; i++) {
      if (i >= leaf.y) {
        write_lane(block, i % HR_L, no_primitive(), HR_NO_PRIMITIVE);
      } else {
        const uint primitive = (uint)(keys[leaf_references[leaf.x + i]] & ((1ul << index_bits) - 1));
        write_lane(block, i % HR_L, load_primitive(&geometry, primitive), primitive);
      }
      if (i % HR_L == HR_L - 1) block += HR_BLOCK_ROWS * HR_L;
    }
  }
}

// Trees of cells, level by level: which parts of its cell each reference touches, and what becomes of the cell.
#include "lib/cell_overlap.h"
#include "lib/chunk.h"
#include "lib/space_cell.h"

static inline Box widened(Box box, float pad) {
  const Box wide = {box.lo - pad, box.hi + pad};
  return wide;
}

// The parts of the cell that a primitive touches which touches the cell: at least one.
static inline uint touched_parts(const SpaceCell* cell, Primitive p, Box box, float pad, float unit) {
  uint near = 0, touched = 0;
#if HR_ACCEL == HR_ACCEL_OCTREE
  uint sides[3];  // 1: below, 2: above
  for (uint a = 0; a < 3; a++) {
    const float plane = along(cell->plane, a);
    sides[a] = (along(box.lo, a) <= plane + pad ? 1u : 0u) | (along(box.hi, a) >= plane - pad ? 2u : 0u);
  }
  for (uint part = 0; part < 8; part++) {
    const bool is_near = sides[0] >> (part & 1) & sides[1] >> (part >> 1 & 1) & sides[2] >> (part >> 2) & 1;
    if (is_near) near |= 1u << part;
  }
#else
  const float plane = along(cell->plane, cell->axis);
  near = (along(box.lo, cell->axis) <= plane + pad ? 1u : 0u) | (along(box.hi, cell->axis) >= plane - pad ? 2u : 0u);
#endif
  if ((near & (near - 1)) == 0) return near;
  for (uint part = 0; part < HR_CELL_PARTS; part++) {
    if (!(near >> part & 1)) continue;
    const Box wide = widened(part_box(cell, part), pad);
    if (boxes_touch(box, wide) && primitive_touches_cell(p, wide, unit)) touched |= 1u << part;
  }
  return touched != 0 ? touched : near;
}

// marks[r] = parts of its cell that reference r touches, a bit each. Counters: prefix for each cell that begins in the
// chunk, totals[k G + g] for the chunk (lib/space_cell.h). Launch: G items.
kernel void bvh_mark_references(HR_GEOMETRY_PARAMETERS global const ulong* restrict keys, const uint index_bits,
                                global const Box* restrict boxes, global const SpaceCell* restrict cells,
                                const uint cell_count, global const uint* restrict references,
                                const uint reference_count, const float pad, const float unit,
                                global uchar* restrict marks, global uint* restrict prefix,
                                global uint* restrict totals) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint begin = chunk_begin(reference_count, g, groups), end = chunk_begin(reference_count, g + 1, groups);
  HR_MAKE_GEOMETRY(0)
  uint run[HR_COUNTERS];
  for (uint k = 0; k < HR_COUNTERS; k++) run[k] = 0;
  if (begin < end) {
    uint c = cell_of_reference(cells, cell_count, begin);
    SpaceCell cell = cells[c];
    for (uint r = begin; r < end; r++) {
      if (r >= cell.first + cell.references) cell = cells[++c];
      if (r == cell.first) {
        for (uint k = 0; k < HR_COUNTERS; k++) prefix[(ulong)c * HR_PREFIX_WORDS + k] = run[k];
        prefix[(ulong)c * HR_PREFIX_WORDS + HR_COUNTERS] = g;
      }
      const uint primitive = (uint)(keys[references[r] & ~HR_OWNED] & ((1ul << index_bits) - 1));
      const Primitive p = load_primitive(&geometry, primitive);
      const uint touched = touched_parts(&cell, p, boxes[primitive], pad, unit);
      marks[r] = (uchar)touched;
      for (uint k = 0; k < HR_CELL_PARTS; k++) run[k] += touched >> k & 1;
      run[HR_CELL_PARTS] += references[r] >> 31;
    }
  }
  for (uint k = 0; k < HR_COUNTERS; k++) totals[k * groups + g] = run[k];
}

// What a leaf of up to max_leaf primitives costs, in steps down the tree: a block's lanes share most of it.
#define HR_PRIMITIVE_COST 0.25f
static inline float leaf_cost(uint max_leaf) { return 1.0f + HR_PRIMITIVE_COST * (float)max_leaf; }

static inline float half_area(Box b, float inverse_unit) {
  const float4 d = (b.hi - b.lo) * inverse_unit;
  return d.x * d.y + (d.x + d.y) * d.z;
}

// Does it pay to cut the cell into parts with `count` references each? By the chance that a ray meets each part
// (Goldsmith and Salmon 1987; MacDonald and Booth 1990). Cutting off empty space pays for small leaves too.
static inline bool cut_pays(const SpaceCell* cell, const uint* count, uint max_leaf, bool frugal) {
  const Box whole = {cell->lo, cell->hi};
  const float4 size = whole.hi - whole.lo;
  const float inverse = 1.0f / max(max(size.x, size.y), size.z);
  float weighted = 0.0f;
  uint sum = 0;
  for (uint part = 0; part < HR_CELL_PARTS; part++) {
    const uint leaves = (count[part] + max_leaf - 1) / max_leaf;
    weighted += (float)leaves * half_area(part_box(cell, part), inverse);
    sum += count[part];
  }
  if (frugal && sum > cell->references) return false;
  const float area = half_area(whole, inverse), leaves = (float)((cell->references + max_leaf - 1) / max_leaf);
  return area + leaf_cost(max_leaf) * weighted < leaf_cost(max_leaf) * leaves * area;
}

static inline bool is_cut(float plane) { return plane > -INFINITY && plane < INFINITY; }

// Decides about every cell: leaf if few box centres lie in it, cut if that pays, else, in k-d trees,
// another axis in the next round. frugal: no cut may add references. sums[j G + g] for chunk g of the cells: nodes,
// cells and references of the next level, references of leaves, their blocks, leaf records, leaves; depths[g] = most
// cuts above a part. Launch: G items.
kernel void bvh_judge_cells(global SpaceCell* restrict cells, const uint cell_count, global const uint* restrict prefix,
                            global const uint* restrict offsets, const uint max_leaf, const uint max_owned,
                            const uint frugal, global CellVerdict* restrict verdicts, global uint* restrict sums,
                            global uint* restrict depths) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  uint sum[HR_CELL_SUMS];
  for (uint j = 0; j < HR_CELL_SUMS; j++) sum[j] = 0;
  uint depth = 0;
  const uint end = chunk_begin(cell_count, g + 1, groups);
  for (uint c = chunk_begin(cell_count, g, groups); c < end; c++) {
    SpaceCell cell = cells[c];
    uint count[HR_COUNTERS];
    for (uint k = 0; k < HR_COUNTERS; k++) {
      count[k] = count_before(prefix, offsets, groups, cell_count, c + 1, k) -
                 count_before(prefix, offsets, groups, cell_count, c, k);
    }
    int action = HR_VERDICT_LEAF;
    if (count[HR_CELL_PARTS] > max_owned) {
#if HR_ACCEL == HR_ACCEL_OCTREE
      const bool has_plane = is_cut(cell.plane.x) || is_cut(cell.plane.y) || is_cut(cell.plane.z);
      if (has_plane && cut_pays(&cell, count, max_leaf, frugal)) action = HR_VERDICT_CUT;
#else
      if (cell.tried != HR_ALL_AXES) {
        if (is_cut(along(cell.plane, cell.axis)) && cut_pays(&cell, count, max_leaf, frugal)) {
          action = HR_VERDICT_CUT;
        } else {
          cells[c].tried = cell.tried | 1u << cell.axis;
          if ((cell.tried | 1u << cell.axis) != HR_ALL_AXES) action = HR_VERDICT_KEEP;
        }
      }
#endif
    }
    verdicts[c].action = action;
    if (action == HR_VERDICT_CUT) {
      sum[HR_SUM_NODES]++;
      depth = max(depth, cell.depth + 1);
      for (uint k = 0; k < HR_CELL_PARTS; k++) {
        sum[HR_SUM_CELLS] += count[k] > 0;
        sum[HR_SUM_REFERENCES] += count[k];
      }
    } else if (action == HR_VERDICT_KEEP) {
      sum[HR_SUM_CELLS]++;
      sum[HR_SUM_REFERENCES] += cell.references;
    } else {
      const uint blocks = (cell.references + HR_L - 1) / HR_L;
      sum[HR_SUM_LEAF_REFERENCES] += cell.references;
      sum[HR_SUM_BLOCKS] += blocks;
      sum[HR_SUM_RECORDS] += blocks >= HR_MANY_BLOCKS;
      sum[HR_SUM_LEAVES]++;
    }
  }
  for (uint j = 0; j < HR_CELL_SUMS; j++) sums[j * groups + g] = sum[j];
  depths[g] = depth;
}

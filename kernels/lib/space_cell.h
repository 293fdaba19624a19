// Trees of cells (octree, k-d tree, median k-d tree): what their builders share. A cell lists every primitive that
// touches it, so a primitive may stand in many. References are places in the Morton order of the primitives, in that
// order in each cell.
#ifndef HR_LIB_SPACE_CELL_H
#define HR_LIB_SPACE_CELL_H

#include "lib/accel_layout.h"
#include "lib/cell_layout.h"
#include "lib/vec.h"

// Parts a cell is cut into at once: octants, bit a of whose number says above along axis a; or below and above.
#if HR_ACCEL == HR_ACCEL_OCTREE
#define HR_CELL_PARTS 8
#else
#define HR_CELL_PARTS 2
#endif

#define HR_OWNED                                                                                      \
  0x80000000u /* in a reference: the primitive's box centre lies in this cell; each has one such cell \
               */
#define HR_ALL_AXES 7u

// A cell of the level at hand.
typedef struct SpaceCell {
  float4 lo;        // [m]
  float4 hi;        // [m]
  float4 plane;     // where it is to be cut along each axis [m]; outside of it or infinite: not
  uint first;       // of its references
  uint references;  // how many
  uint axis;        // that a k-d tree cuts next
  uint tried;       // bit a: cutting along axis a did not pay
  uint lattice[3];  // the Morton cell that it belongs to, in steps of the finest lattice
  uint level[3];    // bits of the code that are used up, along each axis
  uint median;      // place in the Morton order of the owned primitive in the middle (median k-d tree)
  uint depth;
} SpaceCell;

#define HR_VERDICT_LEAF 0
#define HR_VERDICT_KEEP 1 /* as it is to the next round, where another axis is tried */
#define HR_VERDICT_CUT 2

typedef struct CellVerdict {
  int action;
  uint parts;  // k-d tree: axis
  uint pad0, pad1;
  uint first[8];  // where the references of each part go (leaf, keep: of all in [0])
} CellVerdict;

// The host allocates them by words (host/bvh/cell_trees.cpp).
typedef char SpaceCellHas24Words[sizeof(SpaceCell) == 96 ? 1 : -1];
typedef char CellVerdictHas12Words[sizeof(CellVerdict) == 48 ? 1 : -1];

// What a level adds up to (bvh_judge_cells).
#define HR_SUM_NODES 0
#define HR_SUM_CELLS 1
#define HR_SUM_REFERENCES 2
#define HR_SUM_LEAF_REFERENCES 3
#define HR_SUM_BLOCKS 4
#define HR_SUM_RECORDS 5
#define HR_SUM_LEAVES 6
#define HR_CELL_SUMS 7

// Counts of references by part, and of owned ones, run through all references of a level, by chunks. At each cell's
// first reference the count within its chunk is kept, with the number of the chunk.
#define HR_COUNTERS (HR_CELL_PARTS + 1)
#define HR_PREFIX_WORDS (HR_COUNTERS + 1)

// Count k before cell c; `offsets`: the chunks' totals after an exclusive scan, counter by counter.
static inline uint count_before(global const uint* prefix, global const uint* offsets, uint groups, uint cell_count,
                                uint c, uint k) {
  if (c == cell_count) return offsets[(k + 1) * groups];
  global const uint* own = prefix + (ulong)c * HR_PREFIX_WORDS;
  return own[k] + offsets[k * groups + own[HR_COUNTERS]];
}

// The cell of reference r.
static inline uint cell_of_reference(global const SpaceCell* cells, uint cell_count, uint r) {
  uint least = 0, end = cell_count;
  while (end - least > 1) {
    const uint middle = (least + end) / 2;
    if (cells[middle].first <= r) {
      least = middle;
    } else {
      end = middle;
    }
  }
  return least;
}

static inline float along(float4 v, uint axis) { return axis == 0 ? v.x : (axis == 1 ? v.y : v.z); }

static inline void set_along(float4* v, uint axis, float value) {
  if (axis == 0) v->x = value;
  if (axis == 1) v->y = value;
  if (axis == 2) v->z = value;
}

static inline float box_centre(Box box, uint axis) { return 0.5f * along(box.lo, axis) + 0.5f * along(box.hi, axis); }

// Does the owned primitive at `place` of the Morton order lie above the cell's cut along `axis`?
static inline bool centre_is_above(const SpaceCell* cell, uint axis, ulong key, uint place, uint axis_bits,
                                   uint index_bits, Box box) {
#if HR_ACCEL == HR_ACCEL_KDTREE_MEDIAN
  const float centre = box_centre(box, axis), plane = along(cell->plane, axis);
  return centre > plane || (centre == plane && place >= cell->median);
#else
  const uint bit = 3 * (axis_bits - 1 - cell->level[axis]) + 2 - axis;  // x is highest
  return (key >> (index_bits + bit) & 1) != 0;
#endif
}

// The part's box.
static inline Box part_box(const SpaceCell* cell, uint part) {
  Box box = {cell->lo, cell->hi};
#if HR_ACCEL == HR_ACCEL_OCTREE
  for (uint a = 0; a < 3; a++) {
    const float plane = clamp(along(cell->plane, a), along(cell->lo, a), along(cell->hi, a));
    if (part >> a & 1) {
      set_along(&box.lo, a, plane);
    } else {
      set_along(&box.hi, a, plane);
    }
  }
#else
  const float plane = along(cell->plane, cell->axis);
  if (part == 1) {
    set_along(&box.lo, cell->axis, plane);
  } else {
    set_along(&box.hi, cell->axis, plane);
  }
#endif
  return box;
}

#endif

// Trees of cells, level by level: where each cell is cut. Octree and k-d tree cut where Morton codes do, in the middle
// of the cell that a prefix of the code stands for (Karras 2012, section 5: the radix tree's levels are the k-d tree's,
// every third the octree's); their lattice has cubic cells. The median k-d tree halves the primitives' box centres
// along the cell's longest axis.
#include "lib/chunk.h"
#include "lib/space_cell.h"

// The first cell, which holds everything; all references. Launch: G items.
kernel void bvh_start_cells(global SpaceCell* restrict cells, global uint* restrict references, const uint count,
                            const float4 lo, const float4 hi) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint end = chunk_begin(count, g + 1, groups);
  for (uint i = chunk_begin(count, g, groups); i < end; i++) references[i] = i | HR_OWNED;
  if (g > 0) return;
  SpaceCell root;
  root.lo = lo;
  root.hi = hi;
  root.plane = (float4)(INFINITY);
  root.first = 0;
  root.references = count;
  root.axis = 0;
  root.tried = 0;
  for (uint a = 0; a < 3; a++) {
    root.lattice[a] = 0;
    root.level[a] = 0;
  }
  root.median = 0;
  root.depth = 0;
  cells[0] = root;
}

// Lattice plane in the middle of the cell's Morton cell. grid_lo: the lattice's origin, w = its finest step [m].
static inline float middle_plane(const SpaceCell* cell, uint axis, float4 grid_lo, uint to_middle) {
#pragma OPENCL FP_CONTRACT OFF
  return along(grid_lo, axis) + (float)(cell->lattice[axis] + to_middle) * grid_lo.w;
}

// Sets the cell's plane along `axis`, +-infinite if all of the cell lies below or above it or the code is used up.
// Returns whether it cuts the cell.
static inline bool set_plane(SpaceCell* cell, uint axis, float4 grid_lo, uint axis_bits) {
  set_along(&cell->plane, axis, INFINITY);
  if (cell->level[axis] >= axis_bits) return false;
  const float plane = middle_plane(cell, axis, grid_lo, 1u << (axis_bits - 1 - cell->level[axis]));
  const bool cuts = plane > along(cell->lo, axis) && plane < along(cell->hi, axis);
  set_along(&cell->plane, axis, cuts ? plane : (plane <= along(cell->lo, axis) ? -INFINITY : INFINITY));
  return cuts;
}

// The cell lies wholly on one side of the plane: on to the next bit of the code along this axis.
static inline void skip_level(SpaceCell* cell, uint axis, uint axis_bits) {
  if (along(cell->plane, axis) < 0) cell->lattice[axis] += 1u << (axis_bits - 1 - cell->level[axis]);
  cell->level[axis]++;
}

// Octree: the next level whose planes cut the cell. k-d tree: the next axis, in the order of the code's bits, that has
// a level which cuts the cell and that was not tried in vain. Launch: G items.
kernel void bvh_choose_planes(global SpaceCell* restrict cells, const uint cell_count, const float4 grid_lo,
                              const uint axis_bits) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint end = chunk_begin(cell_count, g + 1, groups);
  for (uint c = chunk_begin(cell_count, g, groups); c < end; c++) {
    SpaceCell cell = cells[c];
#if HR_ACCEL == HR_ACCEL_OCTREE
    for (;;) {
      const bool x = set_plane(&cell, 0, grid_lo, axis_bits), y = set_plane(&cell, 1, grid_lo, axis_bits);
      const bool z = set_plane(&cell, 2, grid_lo, axis_bits);
      if (x || y || z || cell.level[0] >= axis_bits) break;
      for (uint a = 0; a < 3; a++) skip_level(&cell, a, axis_bits);
    }
#else
    for (uint turn = 0; turn < 3; turn++) {
      const uint a = cell.axis;
      if (!(cell.tried >> a & 1)) {
        while (!set_plane(&cell, a, grid_lo, axis_bits) && cell.level[a] < axis_bits) skip_level(&cell, a, axis_bits);
        if (cell.level[a] < axis_bits) break;
        cell.tried |= 1u << a;
      }
      cell.axis = a == 2 ? 0 : a + 1;
    }
#endif
    cells[c] = cell;
  }
}

// Median k-d tree, first step: each cell's longest axis that was not tried in vain. Launch: G items.
kernel void bvh_choose_longest_axes(global SpaceCell* restrict cells, const uint cell_count) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint end = chunk_begin(cell_count, g + 1, groups);
  for (uint c = chunk_begin(cell_count, g, groups); c < end; c++) {
    const uint tried = cells[c].tried;
    const float4 size = cells[c].hi - cells[c].lo;
    float longest = -1.0f;
    for (uint a = 0; a < 3; a++) {
      if (tried >> a & 1 || !(along(size, a) > longest)) continue;
      longest = along(size, a);
      cells[c].axis = a;
    }
  }
}

// totals[g] = owned references of chunk g. Launch: G items.
kernel void bvh_count_owned(global const uint* restrict references, const uint reference_count,
                            global uint* restrict totals) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint end = chunk_begin(reference_count, g + 1, groups);
  uint owned = 0;
  for (uint r = chunk_begin(reference_count, g, groups); r < end; r++) owned += references[r] >> 31;
  totals[g] = owned;
}

// Numbers in the order of floats.
static inline uint ordered_bits(float x) {
  const uint bits = as_uint(x == 0 ? 0.0f : x);
  return bits ^ (bits >> 31 ? 0xffffffffu : 0x80000000u);
}

// For each owned reference: its box centre along its cell's axis, above its place; the place's cell; and where each
// cell's owned references begin, owned_first[cell_count] being their number. Launch: G items, as bvh_count_owned.
kernel void bvh_key_centres(global const SpaceCell* restrict cells, const uint cell_count,
                            global const uint* restrict references, const uint reference_count,
                            global const ulong* restrict keys, global const Box* restrict boxes, const uint index_bits,
                            global const uint* restrict offsets, global uint* restrict owned_first,
                            global uint* restrict place_cell, global ulong* restrict centre_keys) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint begin = chunk_begin(reference_count, g, groups), end = chunk_begin(reference_count, g + 1, groups);
  if (g == 0) owned_first[cell_count] = offsets[groups];
  if (begin == end) return;
  uint out = offsets[g];
  uint c = cell_of_reference(cells, cell_count, begin);
  for (uint r = begin; r < end; r++) {
    while (c + 1 < cell_count && cells[c + 1].first <= r) c++;
    if (cells[c].first == r) owned_first[c] = out;
    if (!(references[r] & HR_OWNED)) continue;
    const uint place = references[r] & ~HR_OWNED;
    const Box box = boxes[(uint)(keys[place] & ((1ul << index_bits) - 1))];
    place_cell[place] = c;
    centre_keys[out++] = (ulong)ordered_bits(box_centre(box, cells[c].axis)) << index_bits | place;
  }
}

// The same in order of centres: now keys that bring each cell's together. Launch: G items.
kernel void bvh_key_cells(global ulong* restrict centre_keys, const uint count, const uint index_bits,
                          global const uint* restrict place_cell) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint end = chunk_begin(count, g + 1, groups);
  for (uint i = chunk_begin(count, g, groups); i < end; i++) {
    const ulong place = centre_keys[i] & ((1ul << index_bits) - 1);
    centre_keys[i] = (ulong)place_cell[place] << index_bits | place;
  }
}

// Median k-d tree, last step: the plane through the centre in the middle of the cell's own. Launch: G items.
kernel void bvh_choose_medians(global SpaceCell* restrict cells, const uint cell_count,
                               global const uint* restrict owned_first, global const ulong* restrict centre_keys,
                               global const ulong* restrict keys, global const Box* restrict boxes,
                               const uint index_bits) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const ulong mask = (1ul << index_bits) - 1;
  const uint end = chunk_begin(cell_count, g + 1, groups);
  for (uint c = chunk_begin(cell_count, g, groups); c < end; c++) {
    const uint first = owned_first[c], owned = owned_first[c + 1] - first, axis = cells[c].axis;
    float plane = INFINITY;
    if (owned > 0) {
      const uint place = (uint)(centre_keys[first + owned / 2] & mask);
      const float centre = box_centre(boxes[(uint)(keys[place] & mask)], axis);
      if (centre > along(cells[c].lo, axis) && centre < along(cells[c].hi, axis)) plane = centre;
      cells[c].median = place;
    }
    if (axis == 0) cells[c].plane.x = plane;
    if (axis == 1) cells[c].plane.y = plane;
    if (axis == 2) cells[c].plane.z = plane;
  }
}

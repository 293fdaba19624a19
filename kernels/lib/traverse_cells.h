// Traversal of a tree of cells by a single ray, front to back. A cell's visit is an interval of the ray; both ends of
// every comparison are closed and padded as slabs are (lib/intersect.h), so no ray slips between cells, and a ray in a
// cell's side visits both neighbours. A primitive stands in every cell it touches and may be met in several; what is
// found in one cell does not end the search before all cells that the ray enters sooner have been visited.
#ifndef HR_LIB_TRAVERSE_CELLS_H
#define HR_LIB_TRAVERSE_CELLS_H

#include "lib/cell_layout.h"
#include "lib/leaf_block.h"

// The part of the ray in a cell that waits.
typedef struct CellVisit {
  real t_in, t_out;
  int reference;
} CellVisit;

static inline global const float* cell_node(const SceneView* view, int node) {
  return view->accel_nodes + HR_CELL_HEADER_WORDS + (ulong)(uint)node * HR_CELL_NODE_WORDS;
}

// Where the ray meets a plane across `axis`. Subtract first, multiply after, as for slabs.
static inline real meet_plane(real plane, real origin, real inverse) {
#pragma OPENCL FP_CONTRACT OFF
  return (plane - origin) * inverse;
}

// The part of the ray before t_far in the root's cell; false if there is none.
static inline bool visit_root(const SceneView* view, const Ray* ray, real t_far, CellVisit* visit) {
#pragma OPENCL FP_CONTRACT OFF
  global const float* header = view->accel_nodes;
  const real3 lo = (real3)(header[0], header[1], header[2]), hi = (real3)(header[3], header[4], header[5]);
  const real3 t_lo = (lo - ray->origin) * ray->inverse, t_hi = (hi - ray->origin) * ray->inverse;
  const real3 in = min(t_lo, t_hi), out = max(t_lo, t_hi);
  visit->t_in = max(max(ray->t_min, in.x), max(in.y, in.z));
  visit->t_out = min(min(out.x, out.y), min(out.z, t_far));
  visit->reference = ((global const int*)header)[HR_HEADER_ROOT];
  return visit->t_in <= visit->t_out * HR_SLAB_PAD && visit->reference != HR_NO_CHILD;
}

// The blocks of a leaf.
static inline global const float* leaf_blocks(const SceneView* view, int reference, uint* blocks) {
  const uint leaf = (uint)~reference;
  *blocks = leaf & 15u;
  if (*blocks != HR_MANY_BLOCKS) return block_at(view, leaf >> 4);
  global const uint* words = (global const uint*)view->accel_nodes;
  global const uint* record = words + words[HR_HEADER_RECORDS] + 2 * (leaf >> 4);
  *blocks = record[1];
  return block_at(view, record[0]);
}

#if HR_ACCEL == HR_ACCEL_OCTREE
#include "lib/traverse_octree.h"
#else
#include "lib/traverse_kdtree.h"
#endif

// The nearest visit on the stack that begins no farther than t_far; false if there is none.
static inline bool next_visit(const CellVisit* stack, uint* size, real t_far, CellVisit* visit) {
  while (*size > 0) {
    *visit = stack[--*size];
    if (visit->t_in <= t_far * HR_SLAB_PAD) return true;
  }
  return false;
}

// Makes *best the closest hit if there is one closer.
static inline void traverse_cells_closest(const SceneView* view, const Ray* ray, const Skip* skip, Hit* best) {
  CellVisit stack[HR_TRAVERSAL_STACK], visit;
  uint size = 0;
  if (!visit_root(view, ray, best->t, &visit)) return;
  for (;;) {
    if (visit.reference >= 0) {
      if (descend_cell(view, ray, &visit, stack, &size)) continue;
    } else {
      uint blocks;
      global const float* block = leaf_blocks(view, visit.reference, &blocks);
      for (; blocks > 0; blocks--, block += HR_BLOCK_ROWS * HR_L) {
        intersect_block_closest(world_numbers(view), block, ray, skip, best);
      }
    }
    if (!next_visit(stack, &size, best->t, &visit)) return;
  }
}

static inline bool traverse_cells_any(const SceneView* view, const Ray* ray, const Skip* skip) {
  CellVisit stack[HR_TRAVERSAL_STACK], visit;
  uint size = 0;
  if (!visit_root(view, ray, ray->t_max, &visit)) return false;
  for (;;) {
    if (visit.reference >= 0) {
      if (descend_cell(view, ray, &visit, stack, &size)) continue;
    } else {
      uint blocks;
      global const float* block = leaf_blocks(view, visit.reference, &blocks);
      for (; blocks > 0; blocks--, block += HR_BLOCK_ROWS * HR_L) {
        if (intersect_block_any(world_numbers(view), block, ray, skip)) return true;
      }
    }
    if (!next_visit(stack, &size, ray->t_max, &visit)) return false;
  }
}

#endif

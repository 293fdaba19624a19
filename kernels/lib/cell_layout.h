// How trees of cells lie in accel_nodes, whose words are 4 bytes:
//   header: float lo[3], hi[3] of the root's cell [m]; int root; int first leaf record, in words.
//   nodes, numbered from 0. k-d tree: float plane [m]; int below, above; int axis. Octree: float plane_x, plane_y,
//     plane_z [m], unused; int child[8], bit a of whose number says above along axis a. An infinite plane cuts nothing.
//   leaf records of leaves with many blocks: first block, blocks.
// A child >= 0 is a node, -1 nothing, else a leaf: ~(first block << 4 | blocks) or, with HR_MANY_BLOCKS in the low
// bits, ~(leaf record << 4 | HR_MANY_BLOCKS). Blocks are those of the BVH (shared/bvh_types.h).
#ifndef HR_LIB_CELL_LAYOUT_H
#define HR_LIB_CELL_LAYOUT_H

#include "lib/accel_layout.h"
#include "shared/bvh_types.h"

#define HR_CELL_HEADER_WORDS 8u
#define HR_HEADER_ROOT 6u
#define HR_HEADER_RECORDS 7u
#define HR_MANY_BLOCKS 15u
#define HR_NO_CHILD (-1)

#if HR_ACCEL == HR_ACCEL_OCTREE
#define HR_CELL_NODE_WORDS 12u
#define HR_CELL_FIRST_CHILD 4u
#else
#define HR_CELL_NODE_WORDS 4u
#define HR_CELL_FIRST_CHILD 1u
#endif

#endif

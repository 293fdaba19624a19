// How the binary tree is cut into nodes of W children (bvh/cut.cl), and the children of such a node.
//
// cuts[n], 3 bits for each j from 2 to W: how many of j children the left side of binary node n gets where n hangs in a
// wide node as up to j children; 0: as up to j - 1. For j = W: n is a wide node itself. With HR_CUT_LEAF, n as one
// child is a leaf.
#ifndef HR_BVH_CUT_H
#define HR_BVH_CUT_H

#include "bvh/binary_node.h"
#include "lib/accel_layout.h"
#include "lib/lanes.h"

#define HR_CUT_LEAF 0x80000000u
#define HR_CUT_SHIFT(j) (3u * ((j)-2u))
// What it takes to come to a leaf, and each of its blocks, in visits of a node: as measured on a CPU, where coming to a
// leaf is a branch that was not foreseen.
#define HR_LEAF_COST 0.4f
#define HR_BLOCK_COST 0.6f
#define HR_LARGE_LEAF 1e-3f /* of the cost of a node that every ray enters; smaller leaves are never worth opening */

typedef struct Children {
  int reference[HR_W];
  uint primitives[HR_W];
  Box box[HR_W];
  bool leaf[HR_W];
  uint size;
} Children;

static inline void swap_children(Children* c, uint i, uint j) {
  const int reference = c->reference[i];
  const uint primitives = c->primitives[i];
  const Box box = c->box[i];
  const bool leaf = c->leaf[i];
  c->reference[i] = c->reference[j];
  c->primitives[i] = c->primitives[j];
  c->box[i] = c->box[j];
  c->leaf[i] = c->leaf[j];
  c->reference[j] = reference;
  c->primitives[j] = primitives;
  c->box[j] = box;
  c->leaf[j] = leaf;
}

// Rays that ask for any hit take the entered children from the last lane to the first, so what is most likely to stop
// them soon goes last: few primitives in a large box, as they are large then (surface by expected cost: Nah and Manocha
// 2014, "SATO: Surface Area Traversal Order for Shadow Ray Tracing").
static inline void order_children(Children* c) {
  float worth[HR_W];
  for (uint i = 0; i < c->size; i++) {
    worth[i] = half_area(c->box[i], 1.0f) / (float)c->primitives[i];
    for (uint j = i; j > 0 && worth[j - 1] > worth[j]; j--) {
      const float w = worth[j];
      worth[j] = worth[j - 1];
      worth[j - 1] = w;
      swap_children(c, j, j - 1);
    }
  }
}

static inline uint cut_split(uint cut, uint j) { return cut >> HR_CUT_SHIFT(j) & 7u; }

// The children, in no order, of the wide node that binary node `reference` is. A tree that is one leaf has itself as
// only child.
static inline void gather_children(global const BinaryNode* binary, global const uint* cuts, int reference,
                                   uint primitives, Box bounds, Children* c) {
  uint ways[HR_W];
  c->size = 1;
  c->reference[0] = reference;
  c->primitives[0] = primitives;
  c->box[0] = bounds;
  ways[0] = HR_W;
  for (uint i = 0; i < c->size;) {
    const int at = c->reference[i];
    const uint cut = at < 0 ? HR_CUT_LEAF : cuts[at];
    uint j = ways[i], split = 0;
    while (j > 1 && split == 0) split = cut_split(cut, j--);
    if (split == 0) {
      c->leaf[i++] = (cut & HR_CUT_LEAF) != 0;
      continue;
    }
    const uint last = c->size++;
    const BinaryNode node = binary[at];
    c->reference[i] = (int)node.child.x;
    c->primitives[i] = node.child.z;
    c->box[i] = left_box(node);
    ways[i] = split;
    c->reference[last] = (int)node.child.y;
    c->primitives[last] = node.child.w;
    c->box[last] = right_box(node);
    ways[last] = j + 1 - split;
    if ((int)node.child.x >= 0) HR_PREFETCH(binary + node.child.x);
    if ((int)node.child.y >= 0) HR_PREFETCH(binary + node.child.y);
  }
}

#endif

// The binary tree's top, its largest nodes, in an array of its own: small enough for the cache, with links upwards.
#ifndef HR_BVH_TOP_TREE_H
#define HR_BVH_TOP_TREE_H

#include "bvh/binary_node.h"
#include "lib/accel_layout.h"
#include "lib/lanes.h"

static inline Box top_box(global const TopNode* top, int node) {
  const Box b = {top[node].lo, top[node].hi};
  return b;
}

static inline int sibling_of(global const TopNode* top, int node) {
  const int parent = top[node].parent;
  return top[parent].left == node ? top[parent].right : top[parent].left;
}

// `by` takes the place of `node` below its parent.
static inline void replace_child(global TopNode* top, int parent, int node, int by) {
  if (top[parent].left == node) {
    top[parent].left = by;
  } else {
    top[parent].right = by;
  }
  top[by].parent = parent;
}

static inline void set_children(global TopNode* top, int parent, int left, int right) {
  top[parent].left = left;
  top[parent].right = right;
  top[left].parent = parent;
  top[right].parent = parent;
}

// New boxes from `node` upwards, until one stays as it was. By how much surfaces grew in all.
static inline float refit_upwards(global TopNode* top, int node, float scale) {
  float growth = 0.0f;
  for (; node >= 0; node = top[node].parent) {
    const Box old = top_box(top, node);
    const Box now = box_union(top_box(top, top[node].left), top_box(top, top[node].right));
    if (all(now.lo == old.lo) && all(now.hi == old.hi)) break;
    growth += half_area(now, scale) - half_area(old, scale);
    top[node].lo = now.lo;
    top[node].hi = now.hi;
  }
  return growth;
}

#endif

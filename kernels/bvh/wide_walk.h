// The walk through a region's wide nodes, parents first, that counts them and writes them.
#ifndef HR_BVH_WIDE_WALK_H
#define HR_BVH_WIDE_WALK_H

#include "bvh/cut.h"

// Subtrees wait smallest on top, so one with p larger siblings waiting has at most 1 / (p + 1) of its parent's
// primitives: 7 log_8 2^32 entries are enough for any tree.
#define HR_WALK_STACK 96

typedef struct Waiting {
  int root;
  uint primitives;
  uint node;
  uint load;  // entries on a traversal's stack when it comes here
} Waiting;

typedef struct WideWalk {
  Waiting waiting[HR_WALK_STACK];
  uint size;
  uint nodes, blocks;  // met so far
  uint stack;          // most entries a traversal's stack can hold
} WideWalk;

static inline uint leaf_blocks(uint primitives) { return (primitives + HR_L - 1) / HR_L; }

// How a node refers to the leaf whose blocks start at `block`.
static inline int leaf_reference(uint block, uint primitives) { return (int)~(block << 4 | leaf_blocks(primitives)); }

static inline WideWalk start_walk(global const BinaryNode* binary, const CollapseRegion* region) {
  // Builders number a subtree's nodes one after another, the root last: read them in order, not one by one as met.
  for (uint i = 0; i < region->primitives && (int)i <= region->root; i++) HR_PREFETCH(binary + (region->root - (int)i));
  WideWalk walk;
  walk.waiting[0].root = region->root;
  walk.waiting[0].primitives = region->primitives;
  walk.waiting[0].node = 0;
  walk.waiting[0].load = region->stack_load;
  walk.size = 1;
  walk.nodes = 1;
  walk.blocks = 0;
  walk.stack = 1;
  return walk;
}

// The next node: its number in the region, its children (ordered if that matters), and how it refers to them.
static inline uint step_walk(WideWalk* walk, global const BinaryNode* binary, global const uint* cuts, bool ordered,
                             Children* c, int* child) {
  const Waiting at = walk->waiting[--walk->size];
  const Box unused = {(float4)(0.0f), (float4)(0.0f)};
  gather_children(binary, cuts, at.root, at.primitives, unused, c);
  if (ordered) order_children(c);
  walk->stack = max(walk->stack, at.load + c->size);
  const uint first = walk->size;
  for (uint i = 0; i < c->size; i++) {
    if (c->leaf[i]) {
      child[i] = leaf_reference(walk->blocks, c->primitives[i]);
      walk->blocks += leaf_blocks(c->primitives[i]);
      continue;
    }
    uint place = walk->size++;
    for (; place > first && walk->waiting[place - 1].primitives < c->primitives[i]; place--) {
      walk->waiting[place] = walk->waiting[place - 1];
    }
    walk->waiting[place].root = c->reference[i];
    walk->waiting[place].primitives = c->primitives[i];
    walk->waiting[place].node = i;
    walk->waiting[place].load = at.load + c->size - 1;
  }
  // Numbered by size: a ray that starts in several children's boxes looks first where most primitives are.
  for (uint k = first; k < walk->size; k++) {
    child[walk->waiting[k].node] = (int)walk->nodes;
    walk->waiting[k].node = walk->nodes++;
  }
  return at.node;
}

static inline void write_node(global float* p, const Children* c, const int* child) {
  for (uint i = 0; i < HR_W; i++) {
    const bool used = i < c->size;
    const float4 lo = used ? c->box[i].lo : (float4)(INFINITY);
    const float4 hi = used ? c->box[i].hi : (float4)(-INFINITY);
    p[i] = lo.x;
    p[HR_W + i] = hi.x;
    p[2 * HR_W + i] = lo.y;
    p[3 * HR_W + i] = hi.y;
    p[4 * HR_W + i] = lo.z;
    p[5 * HR_W + i] = hi.z;
    ((global int*)p)[HR_NODE_CHILD_ROW * HR_W + i] = used ? child[i] : -1;
    ((global int*)p)[7 * HR_W + i] = 0;
  }
}

#endif

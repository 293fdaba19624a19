// From the binary tree to nodes of W children: of the children at hand the one with the largest surface is opened until
// W are there (Wald, Benthin, Boulos 2008, "Getting Rid of Packets"; greedy). A subtree of at most max_leaf primitives
// becomes a leaf. One item opens the top until there are enough subtrees for all others, each of which writes a draft
// into its own region; a scan over the regions then says where everything goes. No atomics: the same scene gives the
// same bytes.
#include "lib/accel_layout.h"
#include "lib/lanes.h"
#include "shared/bvh_types.h"

// Subtrees wait smallest on top, so one with p larger siblings waiting has at most 1 / (p + 1) of its parent's
// primitives: 7 log_8 2^32 entries are enough for any tree.
#define HR_COLLAPSE_STACK 96
#define HR_LEAF_STACK (HR_MAX_LEAF_BLOCKS * HR_L)

typedef struct Children {
  int reference[HR_W];
  uint primitives[HR_W];
  Box box[HR_W];
  uint size;
} Children;

// One region as it grows.
typedef struct Draft {
  global const BinaryNode* binary;
  global float* nodes;       // of the region
  global uint* leaf_order;   // primitives in leaf order
  global uint* descriptors;  // of blocks: first primitive << 4 | primitives, in the region
  uint node_count, block_count, leaf_count, stack;
} Draft;

static inline float half_area(Box b) {
  const float4 d = b.hi - b.lo;
  return d.x * d.y + (d.x + d.y) * d.z;
}

static inline Box left_box(BinaryNode n) {
  const Box b = {(float4)(n.x.x, n.y.x, n.z.x, 0.0f), (float4)(n.x.y, n.y.y, n.z.y, 0.0f)};
  return b;
}

static inline Box right_box(BinaryNode n) {
  const Box b = {(float4)(n.x.z, n.y.z, n.z.z, 0.0f), (float4)(n.x.w, n.y.w, n.z.w, 0.0f)};
  return b;
}

// The up to W children of binary node `reference`. A tree of at most max_leaf primitives has itself as only child.
static inline void gather_children(global const BinaryNode* binary, int reference, uint primitives, Box bounds,
                                   uint max_leaf, Children* c) {
  float area[HR_W];
  c->size = 1;
  c->reference[0] = reference;
  c->primitives[0] = primitives;
  c->box[0] = bounds;
  area[0] = INFINITY;
  for (uint opened = 0;;) {
    if (c->primitives[opened] <= max_leaf) return;  // only the whole tree gets here
    const BinaryNode node = binary[c->reference[opened]];
    const uint last = c->size++;
    c->reference[opened] = (int)node.child.x;
    c->primitives[opened] = node.child.z;
    c->box[opened] = left_box(node);
    area[opened] = node.child.z > max_leaf ? half_area(c->box[opened]) : -1.0f;
    c->reference[last] = (int)node.child.y;
    c->primitives[last] = node.child.w;
    c->box[last] = right_box(node);
    area[last] = node.child.w > max_leaf ? half_area(c->box[last]) : -1.0f;
    if (c->reference[opened] >= 0) HR_PREFETCH(binary + c->reference[opened]);
    if (c->reference[last] >= 0) HR_PREFETCH(binary + c->reference[last]);
    if (c->size == HR_W) return;
    float largest = -1.0f;
    for (uint i = 0; i < c->size; i++) {
      // What is too large for a float, or has no size at all, can still be opened.
      const bool larger = area[i] != -1.0f && (largest == -1.0f || area[i] > largest);
      if (larger) opened = i;
      largest = larger ? area[i] : largest;
    }
    if (largest == -1.0f) return;
  }
}

// Puts the primitives below a binary node into a leaf; returns the leaf's reference.
static inline int draft_leaf(Draft* draft, int reference, uint primitives) {
  int stack[HR_LEAF_STACK];
  uint size = 0, next = draft->leaf_count;
  for (int at = reference;;) {
    if (at < 0) {
      draft->leaf_order[next++] = (uint)~at;
      if (size == 0) break;
      at = stack[--size];
    } else {
      const uint4 child = draft->binary[at].child;
      stack[size++] = (int)child.y;
      at = (int)child.x;
    }
  }
  const uint blocks = (primitives + HR_L - 1) / HR_L;
  for (uint b = 0; b < blocks; b++) {
    const uint first = b * HR_L;
    draft->descriptors[draft->block_count + b] = (draft->leaf_count + first) << 4 | min(primitives - first, (uint)HR_L);
  }
  const int leaf = (int)~(draft->block_count << 4 | blocks);
  draft->block_count += blocks;
  draft->leaf_count = next;
  return leaf;
}

// Writes one wide node; inner children get the references in `inner`, filled by the caller before.
static inline void draft_node(Draft* draft, uint node, const Children* c, const int* reference) {
  global float* p = draft->nodes + (ulong)node * HR_NODE_WORDS(HR_W);
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
    ((global int*)p)[HR_NODE_CHILD_ROW * HR_W + i] = used ? reference[i] : -1;
    ((global int*)p)[7 * HR_W + i] = 0;
  }
}

// Opens the top of the tree, most primitives first, until at least `target` subtrees wait or none has more than
// min_primitives; these become regions 1, 2, ... root[0]: the binary tree. totals[0] = number of regions.
// Launch: 1 item.
kernel void bvh_collapse_top(global const BinaryNode* restrict binary, global const int* restrict root,
                             const uint primitives, const float4 lo, const float4 hi, global float* draft_nodes,
                             global uint* leaf_order, global uint* descriptors, global CollapseRegion* regions,
                             global uint* restrict totals, const uint max_leaf, const uint target,
                             const uint min_primitives) {
  Draft draft = {binary, draft_nodes, leaf_order, descriptors, 0, 0, 0, 1};
  uint waiting = 1;
  regions[1].root = root[0];
  regions[1].primitives = primitives;
  regions[1].stack_load = 0;
  regions[1].parent_slot = 0;
  Box bounds = {lo, hi};
  bool is_root = true;
  while (waiting > 0 && waiting < target) {
    uint most = 1;
    for (uint i = 2; i <= waiting; i++) {
      if (regions[i].primitives > regions[most].primitives) most = i;
    }
    CollapseRegion at;
    at.root = regions[most].root;
    at.primitives = regions[most].primitives;
    at.stack_load = regions[most].stack_load;
    at.parent_slot = regions[most].parent_slot;
    if (at.primitives <= min_primitives && !is_root) break;
    // Only what is set so far.
    regions[most].root = regions[waiting].root;
    regions[most].primitives = regions[waiting].primitives;
    regions[most].stack_load = regions[waiting].stack_load;
    regions[most].parent_slot = regions[waiting].parent_slot;
    waiting--;
    Children c;
    gather_children(binary, at.root, at.primitives, bounds, max_leaf, &c);
    const uint node = draft.node_count++;
    if (!is_root) ((global int*)draft_nodes)[at.parent_slot] = (int)node;
    is_root = false;
    draft.stack = max(draft.stack, at.stack_load + c.size);
    int reference[HR_W];
    for (uint i = 0; i < c.size; i++) {
      reference[i] = -1;
      if (c.primitives[i] <= max_leaf) {
        reference[i] = draft_leaf(&draft, c.reference[i], c.primitives[i]);
      } else {
        waiting++;
        regions[waiting].root = c.reference[i];
        regions[waiting].primitives = c.primitives[i];
        regions[waiting].stack_load = at.stack_load + c.size - 1;
        regions[waiting].parent_slot = node * HR_NODE_WORDS(HR_W) + HR_NODE_CHILD_ROW * HR_W + i;
      }
    }
    draft_node(&draft, node, &c, reference);
  }
  regions[0].primitives = draft.leaf_count;
  regions[0].nodes = draft.node_count;
  regions[0].blocks = draft.block_count;
  regions[0].stack = draft.stack;
  regions[0].draft_node = 0;
  regions[0].first_leaf = 0;
  uint next_node = draft.node_count, next_leaf = draft.leaf_count;
  for (uint i = 1; i <= waiting; i++) {
    ((global int*)draft_nodes)[regions[i].parent_slot] = HR_REGION_FLAG | (int)i;
    regions[i].draft_node = next_node;
    regions[i].first_leaf = next_leaf;
    // Every node has W children or only leaves, which hold more than max_leaf primitives.
    next_node += (regions[i].primitives - 1) / min((uint)HR_W - 1, max_leaf) + 1;
    next_leaf += regions[i].primitives;
  }
  totals[0] = waiting + 1;
}

typedef struct Waiting {
  int root;
  uint primitives;
  uint node;
  uint load;
} Waiting;

// Collapses region g + 1 into its draft. Launch: one item a region that may be.
kernel void bvh_collapse_regions(global const BinaryNode* restrict binary, global float* draft_nodes,
                                 global uint* leaf_order, global uint* descriptors, global CollapseRegion* regions,
                                 global const uint* restrict totals, const uint max_leaf) {
  const uint g = (uint)get_global_id(0) + 1;
  if (g >= totals[0]) return;
  const CollapseRegion region = regions[g];
  Draft draft = {binary,
                 draft_nodes + (ulong)region.draft_node * HR_NODE_WORDS(HR_W),
                 leaf_order + region.first_leaf,
                 descriptors + region.first_leaf,
                 1,
                 0,
                 0,
                 1};
  Waiting stack[HR_COLLAPSE_STACK];
  uint size = 1;
  stack[0].root = region.root;
  stack[0].primitives = region.primitives;
  stack[0].node = 0;
  stack[0].load = region.stack_load;
  const Box unused = {(float4)(0.0f), (float4)(0.0f)};
  while (size > 0) {
    const Waiting at = stack[--size];
    Children c;
    gather_children(binary, at.root, at.primitives, unused, max_leaf, &c);
    draft.stack = max(draft.stack, at.load + c.size);
    int reference[HR_W];
    const uint first = size;
    for (uint i = 0; i < c.size; i++) {
      if (c.primitives[i] <= max_leaf) {
        reference[i] = draft_leaf(&draft, c.reference[i], c.primitives[i]);
        continue;
      }
      reference[i] = (int)draft.node_count++;
      uint place = size++;
      for (; place > first && stack[place - 1].primitives < c.primitives[i]; place--) stack[place] = stack[place - 1];
      stack[place].root = c.reference[i];
      stack[place].primitives = c.primitives[i];
      stack[place].node = (uint)reference[i];
      stack[place].load = at.load + c.size - 1;
    }
    draft_node(&draft, at.node, &c, reference);
  }
  regions[g].nodes = draft.node_count;
  regions[g].blocks = draft.block_count;
  regions[g].stack = draft.stack;
}

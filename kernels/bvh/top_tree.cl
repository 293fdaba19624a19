// The top of the binary tree moves into an array of its own, where bvh/reinsert.cl improves it, and back.
#include "bvh/top_tree.h"

#define HR_TOP_ROUNDS \
  64u /* each halves the surface that is opened: a float has no more than 2^64 between useful sizes */

// Opens the nodes of largest surface, until there are `capacity` nodes or no surface left. count[0] = how many.
// Launch: 1 item.
kernel void bvh_open_top(global const BinaryNode* restrict binary, global const int* restrict root,
                         const uint primitives, const float4 lo, const float4 hi, const float scale,
                         global TopNode* restrict top, global uint* restrict count, const uint capacity) {
  top[0].lo = lo;
  top[0].hi = hi;
  top[0].left = -1;
  top[0].right = -1;
  top[0].parent = -1;
  top[0].reference = root[0];
  top[0].primitives = primitives;
  top[0].target = -1;
  uint size = 1;
  const Box bounds = {lo, hi};
  float least = half_area(bounds, scale);
  for (uint round = 0; round < HR_TOP_ROUNDS && size + 2 <= capacity; round++) {
    least *= 0.5f;
    for (uint i = 0; i < size && size + 2 <= capacity; i++) {
      if (top[i].left >= 0 || top[i].reference < 0 || !(half_area(top_box(top, (int)i), scale) > least)) continue;
      const BinaryNode node = binary[top[i].reference];
      const Box box[2] = {left_box(node), right_box(node)};
      const int reference[2] = {(int)node.child.x, (int)node.child.y};
      const uint below[2] = {node.child.z, node.child.w};
      for (uint k = 0; k < 2; k++) {
        global TopNode* child = top + size + k;
        child->lo = box[k].lo;
        child->hi = box[k].hi;
        child->left = -1;
        child->right = -1;
        child->reference = reference[k];
        child->primitives = below[k];
        child->target = -1;
      }
      set_children(top, (int)i, (int)size, (int)size + 1);
      size += 2;
    }
  }
  count[0] = size;
}

// The top back into the binary tree: new nodes from `first` on, children before parents, root[0] the last of them;
// node_ranges[range] = these nodes. Old ones that nothing refers to stay behind. Launch: 1 item.
kernel void bvh_close_top(global TopNode* restrict top, global BinaryNode* restrict binary, const uint first,
                          global uint2* restrict node_ranges, const uint range, global int* restrict root) {
  uint next = first;
  int at = 0;
  bool from_below = false;
  // Depth first by the links: down to the left, over to the right, up.
  while (at >= 0) {
    if (!from_below && top[at].left >= 0) {
      at = top[at].left;
      continue;
    }
    if (from_below) {
      const int left = top[at].left, right = top[at].right;
      const Box a = top_box(top, left), b = top_box(top, right);
      BinaryNode node;
      node.x = (float4)(a.lo.x, a.hi.x, b.lo.x, b.hi.x);
      node.y = (float4)(a.lo.y, a.hi.y, b.lo.y, b.hi.y);
      node.z = (float4)(a.lo.z, a.hi.z, b.lo.z, b.hi.z);
      node.child =
          (uint4)((uint)top[left].reference, (uint)top[right].reference, top[left].primitives, top[right].primitives);
      binary[next] = node;
      top[at].reference = (int)next++;
      top[at].primitives = top[left].primitives + top[right].primitives;
    }
    const int parent = top[at].parent;
    const bool was_left = parent >= 0 && top[parent].left == at;
    from_below = !was_left;
    at = was_left ? top[parent].right : parent;
  }
  node_ranges[range] = (uint2)(first, next);
  root[0] = top[0].reference;
}

// Nodes of the tree's top move to where they cost less (Meister and Bittner 2018, "Parallel Reinsertion for Bounding
// Volume Hierarchy Optimization"): clustering along a curve errs most for what is large, which most rays meet. The
// search runs in parallel over a tree that stands still; then one item moves the nodes, one after another, as far as it
// still pays. No atomics: the same scene gives the same bytes.
#include "bvh/top_tree.h"

// Subtrees that wait to be searched. What finds no room is not searched: a place is missed, the tree stays true.
#define HR_SEARCH_STACK 32u

// The best place for a node: the gain in surface, and the node that becomes its sibling.
typedef struct Place {
  float gain;
  int target;
} Place;

// Looks below `start` for a place for a node with this box; `gain`: what taking it from where it is, and to here, has
// saved so far.
static inline void search_below(global const TopNode* top, int start, float start_gain, Box box, float area,
                                float scale, Place* best) {
  int waiting[HR_SEARCH_STACK];
  float gains[HR_SEARCH_STACK];
  uint size = 0;
  int at = start;
  float gain = start_gain;
  for (;;) {
    // No place below costs less than the node's own surface.
    if (gain - area > best->gain) {
      const float old_area = half_area(top_box(top, at), scale);
      const float here = gain - half_area(box_union(top_box(top, at), box), scale);
      if (here > best->gain) {
        best->gain = here;
        best->target = at;
      }
      if (top[at].left >= 0 && here + old_area - area > best->gain) {
        gain = here + old_area;
        if (size < HR_SEARCH_STACK) {
          waiting[size] = top[at].right;
          gains[size++] = gain;
        }
        at = top[at].left;
        continue;
      }
    }
    if (size == 0) return;
    at = waiting[--size];
    gain = gains[size];
  }
}

// top[n].target of every stride-th node n from `first` on: where it would cost least, -1 if where it is. Launch: G
// items.
kernel void bvh_find_places(global TopNode* top, global const uint* restrict count, const float scale, const uint first,
                            const uint stride) {
  for (uint n = first + stride * (uint)get_global_id(0); n < count[0]; n += stride * (uint)get_global_size(0)) {
    const int parent = top[n].parent;
    Place best = {0.0f, -1};
    if (parent > 0) {
      const Box box = top_box(top, (int)n);
      const float area = half_area(box, scale);
      const int sibling = sibling_of(top, (int)n);
      // Without the node its parent vanishes, and the ancestors shrink to `rest`.
      float gain = half_area(top_box(top, parent), scale);
      Box rest = top_box(top, sibling);
      if (top[sibling].left >= 0) {
        const float below = gain + half_area(rest, scale) - half_area(box_union(rest, box), scale);
        search_below(top, top[sibling].left, below, box, area, scale, &best);
        search_below(top, top[sibling].right, below, box, area, scale, &best);
      }
      for (int at = parent; at > 0; at = top[at].parent) {
        // Beside the ancestor, which holds `rest` alone by now, or somewhere below the ancestor's sibling.
        const float here = gain - half_area(box_union(rest, box), scale);
        if (at != parent && here > best.gain) {
          best.gain = here;
          best.target = at;
        }
        const int other = sibling_of(top, at);
        search_below(top, other, gain, box, area, scale, &best);
        rest = box_union(rest, top_box(top, other));
        gain += half_area(top_box(top, top[at].parent), scale) - half_area(rest, scale);
      }
    }
    top[n].target = best.target;
  }
}

// Moves these nodes, one after another, to their targets, unless moves before it have made that impossible or worse.
// The root stays the root. Launch: 1 item.
kernel void bvh_move_nodes(global TopNode* restrict top, global const uint* restrict count, const float scale,
                           const uint first, const uint stride) {
  for (int n = (int)first; n < (int)count[0]; n += (int)stride) {
    const int target = top[n].target, parent = top[n].parent;
    if (target <= 0 || parent <= 0 || target == parent || target == sibling_of(top, n)) continue;
    int above = target;
    while (above > 0 && above != n) above = top[above].parent;
    if (above == n) continue;
    const int left = top[parent].left, right = top[parent].right, sibling = left == n ? right : left;
    const int from = top[parent].parent;
    const float old_area = half_area(top_box(top, parent), scale);
    // The parent moves with the node and becomes that of the target.
    replace_child(top, from, parent, sibling);
    const int to = top[target].parent;
    replace_child(top, to, target, parent);
    set_children(top, parent, target, n);
    const Box box = box_union(top_box(top, target), top_box(top, n));
    top[parent].lo = box.lo;
    top[parent].hi = box.hi;
    float growth = half_area(box, scale) - old_area;
    growth += refit_upwards(top, to, scale);
    growth += refit_upwards(top, from, scale);
    if (growth < 0.0f) continue;
    replace_child(top, to, parent, target);
    replace_child(top, from, sibling, parent);
    set_children(top, parent, left, right);
    refit_upwards(top, parent, scale);
    refit_upwards(top, to, scale);
    refit_upwards(top, from, scale);
  }
}

// The binary tree's nodes as boxes, and what a box costs.
#ifndef HR_BVH_BINARY_NODE_H
#define HR_BVH_BINARY_NODE_H

#include "shared/bvh_types.h"

static inline Box left_box(BinaryNode n) {
  const Box b = {(float4)(n.x.x, n.y.x, n.z.x, 0.0f), (float4)(n.x.y, n.y.y, n.z.y, 0.0f)};
  return b;
}

static inline Box right_box(BinaryNode n) {
  const Box b = {(float4)(n.x.z, n.y.z, n.z.z, 0.0f), (float4)(n.x.w, n.y.w, n.z.w, 0.0f)};
  return b;
}

static inline Box box_union(Box a, Box b) {
  const Box u = {min(a.lo, b.lo), max(a.hi, b.hi)};
  return u;
}

static inline uint primitives_below(global const BinaryNode* binary, int reference) {
  return reference < 0 ? 1 : binary[reference].child.z + binary[reference].child.w;
}

// Half the surface; `scale` keeps it in a float's range: 1 / the scene's longest side.
static inline float half_area(Box b, float scale) {
  const float4 d = (b.hi - b.lo) * scale;
  return d.x * d.y + (d.x + d.y) * d.z;
}

// How often a ray that starts somewhere in the scene's box enters box b: half of the rays whose lines meet it start
// beyond it, but none of those that start inside (Fabianowski et al. 2009, "A Cost Metric for Scene-Interior Ray
// Origins"). A wall thus costs half of what its surface says, a box of the same surface full of air does not.
// What stands before a box keeps some of the others away, HR_REACHED are left: with all of them, a leaf of all walls,
// which holds every ray, seems as good as leaves of their own, which few rays come to.
// metric: x = scale of lengths, y and z = 1 / the scaled scene's half surface and volume; w is more than nothing, as an
// empty box still takes a lane. In units of twice the root's probability, 1.
#define HR_REACHED 0.7f
static inline float entry_cost(Box b, float4 metric) {
  const float4 d = (b.hi - b.lo) * metric.x;
  return HR_REACHED * (d.x * d.y + (d.x + d.y) * d.z) * metric.y + d.x * d.y * d.z * metric.z + metric.w;
}

#endif

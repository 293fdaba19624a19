// The binary bounding volume hierarchy and the queries it answers.
#ifndef HR_SHARED_BVH_TYPES_H
#define HR_SHARED_BVH_TYPES_H

#include "shared/scalar.h"

HR_SHARED_BEGIN

// Both children's boxes and references in one cache line. lo.w holds the child's reference as int bits:
// >= 0 an inner node, < 0 the leaf ~reference. A tree of one primitive has it on both sides; the tree of none has a leaf
// of NaNs, which no ray meets.
typedef struct BvhNode {
  float4 left_lo;
  float4 left_hi;
  float4 right_lo;
  float4 right_hi;
} BvhNode;

// One primitive, in Morton order. Triangle: vertices a, b, c. Sphere: a = centre, b.x = radius.
// a.w holds the primitive's index as uint bits; indices from the triangle count on are spheres.
typedef struct BvhLeaf {
  float4 a;
  float4 b;
  float4 c;
} BvhLeaf;

// What one chunk of primitives contributes to the scene's bounds (bvh/bounds.cl).
typedef struct BoundsPartial {
  float4 lo;           // of the boxes [m]
  float4 hi;
  float4 centroid_lo;  // of the box centres [m]
  float4 centroid_hi;
  uint valid;       // primitives that go into the tree
  uint non_finite;  // dropped: a vertex is NaN or infinite
  uint degenerate;  // dropped: zero area, or a radius that is not positive
  uint pad;
} BoundsPartial;

// A ray for Accel::intersect and Accel::occluded. Hits count in the open interval (t_min, t_max).
typedef struct QueryRay {
  float4 origin;     // xyz [m], w = t_min
  float4 direction;  // xyz, any length but zero, w = t_max [in lengths of direction]
} QueryRay;

// Its closest hit; primitive = HR_NO_PRIMITIVE for a miss.
typedef struct QueryHit {
  float t;         // [in lengths of direction]
  float u;         // barycentric weight of the triangle's second vertex
  float v;         // ... of the third
  uint primitive;  // triangles in input order, then spheres, then planes
} QueryHit;

#define HR_NO_PRIMITIVE 0xffffffffu

HR_SHARED_END

#endif

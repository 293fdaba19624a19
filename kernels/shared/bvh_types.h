// The binary bounding volume hierarchy and the queries it answers.
#ifndef HR_SHARED_BVH_TYPES_H
#define HR_SHARED_BVH_TYPES_H

#include "shared/scalar.h"

HR_SHARED_BEGIN

// Both children's boxes, an axis a vector, and their references, in one cache line (Aila and Laine 2009). A reference
// is
// >= 0 for an inner node and ~index for a leaf. A tree of one primitive has it on both sides; the tree of none has a
// leaf of NaNs, which no ray meets. References stand apart from the boxes: an index read as a float is a denormal
// number, and vector code that drags it through a multiplication loses a hundred cycles on some processors.
typedef struct BvhNode {
  float4 x;  // left lo, left hi, right lo, right hi [m]
  float4 y;
  float4 z;
  uint4 child;  // left, right, 0, 0 (int bits)
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
  float4 lo;  // of the boxes [m]
  float4 hi;
  float4 centroid_lo;  // of the box centres [m]
  float4 centroid_hi;
  uint valid;       // primitives that go into the tree
  uint non_finite;  // dropped: a vertex is NaN or infinite
  uint degenerate;  // dropped: zero area, or a radius that is not positive
  uint pad;
} BoundsPartial;

// A ray for RayQueries. Hits count in the open interval (t_min, t_max), t_min >= 0; the direction's length must lie in
// [1e-15, 1e15], beyond which products of three factors leave the range of a float.
typedef struct QueryRay {
  float4 origin;     // xyz [m], w = t_min
  float4 direction;  // xyz, w = t_max [in lengths of direction]
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

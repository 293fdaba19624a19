// The bounding volume hierarchy: how it is built, how it is laid out for traversal, and the queries it answers.
#ifndef HR_SHARED_BVH_TYPES_H
#define HR_SHARED_BVH_TYPES_H

#include "shared/scalar.h"

HR_SHARED_BEGIN

// Bounds of one primitive or of all. A primitive that does not go into the tree has lo = +inf, hi = -inf.
typedef struct Box {
  float4 lo;  // [m]
  float4 hi;
} Box;

// A node of the binary tree that builders make and the collapse reads: both children's boxes, an axis a vector, and
// their references: >= 0 for a node, ~primitive for a leaf. References stand apart from the boxes: an index read as a
// float is a denormal number, and vector code that drags it through a multiplication loses a hundred cycles on some
// processors.
typedef struct BinaryNode {
  float4 x;  // left lo, left hi, right lo, right hi [m]
  float4 y;
  float4 z;
  uint4 child;  // left, right (int bits), primitives below left, below right
} BinaryNode;

// The traversed tree has nodes of W children (2, 4 or 8: the device profile's width), 8 W words each:
//   float lo_x[W], hi_x[W], lo_y[W], hi_y[W], lo_z[W], hi_z[W]; int child[W]; uint unused[W].
// child >= 0 is a node, child < 0 a leaf, ~(first block << 4 | blocks), or ~((instance + 1) << 4). A lane without child
// has an empty box (lo = +inf, hi = -inf), which no ray enters.
#define HR_NODE_WORDS(width) (8 * (width))
#define HR_NODE_CHILD_ROW 6 /* of W words each */

// A leaf holds blocks of L primitives (L: the profile's lanes), 10 L words each, a row of L a quantity. Triangles:
//   rows 0-2 vertex a, 3-5 and 6-8 vertices b and c (watertight test) or edges a - b and c - a (fast test) [m].
// Spheres: rows 0-2 centre, row 3 radius [m]. Shapes: their number says all. Row 9: primitive (uint bits),
// HR_NO_PRIMITIVE in unused lanes.
#define HR_BLOCK_ROWS 10
#define HR_BLOCK_PRIMITIVE_ROW 9
#define HR_MAX_LEAF_BLOCKS 15

#define HR_REGION_FLAG 0x40000000 /* in a draft of the top: child is a region */

// A node of the binary tree's top while its nodes move (bvh/top_tree.h). Node 0 is the root.
typedef struct TopNode {
  float4 lo;  // [m]
  float4 hi;
  int left;  // of the top; -1: not opened, all below stays as it is
  int right;
  int parent;       // -1: the root
  int reference;    // in the binary tree: node or ~primitive
  uint primitives;  // below
  int target;       // node to become the sibling of; -1: none
  uint pad0;
  uint pad1;
} TopNode;

// A part of the tree that one work-item collapses. Region 0 is the top, the others hang below it.
typedef struct CollapseRegion {
  int root;          // binary node
  uint primitives;   // below it
  uint stack_load;   // entries on a traversal's stack when it comes to the root
  uint parent_slot;  // word of the top's draft that refers to it
  uint nodes;        // how many it has
  uint blocks;
  uint stack;       // most entries a traversal's stack can hold in it
  uint final_node;  // where its nodes and blocks go
  uint final_block;
  uint pad0;
  uint pad1;
  uint pad2;
} CollapseRegion;

// What one chunk of primitives contributes to the scene's bounds (bvh/morton.cl).
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
  float u;         // barycentric weight of the triangle's second vertex; of a shape, HR_PART_...
  float v;         // ... of the third
  uint primitive;  // triangles in input order, then spheres, shapes, planes, and the triangles of all instances
} QueryHit;

#define HR_NO_PRIMITIVE 0xffffffffu

HR_SHARED_END

#endif

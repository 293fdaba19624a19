// The compiled-in parameters of the acceleration structure. The host passes them as it built the tree
// (host/bvh/accel_config.hpp); the defaults only serve to compile a file by itself.
#ifndef HR_LIB_ACCEL_LAYOUT_H
#define HR_LIB_ACCEL_LAYOUT_H

#define HR_ACCEL_BVH 0
#define HR_ACCEL_OCTREE 1
#define HR_ACCEL_KDTREE 2
#define HR_ACCEL_KDTREE_MEDIAN 3
#ifndef HR_ACCEL
#define HR_ACCEL HR_ACCEL_BVH /* the kind of tree */
#endif
#ifndef HR_BVH_WIDTH
#define HR_BVH_WIDTH 8 /* children a node: 2, 4, 8 */
#endif
#ifndef HR_LEAF_LANES
#define HR_LEAF_LANES 8 /* primitives a block: 1, 2, 4, 8 */
#endif
#ifndef HR_TRIANGLE_WATERTIGHT
#define HR_TRIANGLE_WATERTIGHT 1 /* 0: the fast test */
#endif
#ifndef HR_TRAVERSAL_STACK
#define HR_TRAVERSAL_STACK 128 /* entries; at least what the collapse found necessary */
#endif
#ifndef HR_NODE_CHUNKS
#define HR_NODE_CHUNKS 1 /* arrays that hold the BVH's nodes, at most 8 (lib/tree_chunks.h) */
#define HR_NODE_CHUNK_SHIFT 31
#endif
#ifndef HR_BLOCK_CHUNKS
#define HR_BLOCK_CHUNKS 1 /* arrays that hold its blocks */
#define HR_BLOCK_CHUNK_SHIFT 31
#endif
#ifndef HR_EXPLICIT_VECTORS
#define HR_EXPLICIT_VECTORS 1 /* 0: loops over lanes, for devices that run one item a lane */
#endif

#define HR_W HR_BVH_WIDTH
#define HR_L HR_LEAF_LANES

#endif

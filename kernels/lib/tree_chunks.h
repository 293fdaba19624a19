// Where the wide BVH's nodes and blocks lie: in one array each, accel_nodes and accel_blocks, or, where the device
// allows no allocation so large, in several. A chunk then has 2^shift of them, the last one what is left; chunks behind
// the first are called accel_nodes_1 and so on. Every access goes through a function made here; compiled for one chunk,
// its address is that of a plain array. A chunk of blocks ends with the first blocks of the next one, so that a leaf's
// blocks can be read one after another.
#ifndef HR_LIB_TREE_CHUNKS_H
#define HR_LIB_TREE_CHUNKS_H

#include "lib/accel_layout.h"
#include "lib/lanes.h"
#include "shared/bvh_types.h"

// DO(array, i) for each chunk behind the first.
#define HR_BEHIND_FIRST_1(DO, array)
#define HR_BEHIND_FIRST_2(DO, array) DO(array, 1)
#define HR_BEHIND_FIRST_3(DO, array) HR_BEHIND_FIRST_2(DO, array) DO(array, 2)
#define HR_BEHIND_FIRST_4(DO, array) HR_BEHIND_FIRST_3(DO, array) DO(array, 3)
#define HR_BEHIND_FIRST_5(DO, array) HR_BEHIND_FIRST_4(DO, array) DO(array, 4)
#define HR_BEHIND_FIRST_6(DO, array) HR_BEHIND_FIRST_5(DO, array) DO(array, 5)
#define HR_BEHIND_FIRST_7(DO, array) HR_BEHIND_FIRST_6(DO, array) DO(array, 6)
#define HR_BEHIND_FIRST_8(DO, array) HR_BEHIND_FIRST_7(DO, array) DO(array, 7)
#define HR_MORE_NODES(DO) HR_PASTE(HR_BEHIND_FIRST_, HR_NODE_CHUNKS)(DO, accel_nodes)
#define HR_MORE_BLOCKS(DO) HR_PASTE(HR_BEHIND_FIRST_, HR_BLOCK_CHUNKS)(DO, accel_blocks)
#define HR_MORE_CHUNKS(DO) HR_MORE_NODES(DO) HR_MORE_BLOCKS(DO)

// What DO may be: a kernel's parameters (each ends with a comma), members, values in a list that has begun.
#define HR_CHUNK_READ(array, i) global const float* restrict array##_##i,
#define HR_CHUNK_WRITTEN(array, i) global float* restrict array##_##i,
#define HR_CHUNK_MEMBER(array, i) global const float* array##_##i;
#define HR_CHUNK_WRITTEN_MEMBER(array, i) global float* array##_##i;
#define HR_CHUNK_VALUE(array, i) , array##_##i
#define HR_NODE_PICK(array, i) \
  if (number >> HR_NODE_CHUNK_SHIFT == i) at = tree->array##_##i;
#define HR_BLOCK_PICK(array, i) \
  if (number >> HR_BLOCK_CHUNK_SHIFT == i) at = tree->array##_##i;

#if HR_NODE_CHUNKS > 1
#define HR_NODE_CHUNK_MASK ((1u << HR_NODE_CHUNK_SHIFT) - 1)
#else
#define HR_NODE_CHUNK_MASK 0xffffffffu
#endif
#if HR_BLOCK_CHUNKS > 1
#define HR_BLOCK_CHUNK_MASK ((1u << HR_BLOCK_CHUNK_SHIFT) - 1)
#else
#define HR_BLOCK_CHUNK_MASK 0xffffffffu
#endif

// Defines name(tree, number), the address of a node or a block; `pointer` says whether it may be written.
#define HR_DEFINE_NODE_AT(name, Tree, pointer)                              \
  static inline pointer name(const Tree* tree, uint number) {               \
    pointer at = tree->accel_nodes;                                         \
    HR_MORE_NODES(HR_NODE_PICK)                                             \
    return at + (ulong)(number & HR_NODE_CHUNK_MASK) * HR_NODE_WORDS(HR_W); \
  }
#define HR_DEFINE_BLOCK_AT(name, Tree, pointer)                                 \
  static inline pointer name(const Tree* tree, uint number) {                   \
    pointer at = tree->accel_blocks;                                            \
    HR_MORE_BLOCKS(HR_BLOCK_PICK)                                               \
    return at + (ulong)(number & HR_BLOCK_CHUNK_MASK) * (HR_BLOCK_ROWS * HR_L); \
  }

// For kernels that write them: NodeArrays nodes = {HR_NODE_ARRAYS}; and written_node(&nodes, number).
typedef struct NodeArrays {
  global float* accel_nodes;
  HR_MORE_NODES(HR_CHUNK_WRITTEN_MEMBER)
} NodeArrays;

typedef struct BlockArrays {
  global float* accel_blocks;
  HR_MORE_BLOCKS(HR_CHUNK_WRITTEN_MEMBER)
} BlockArrays;

#define HR_NODE_ARRAYS accel_nodes HR_MORE_NODES(HR_CHUNK_VALUE)
#define HR_BLOCK_ARRAYS accel_blocks HR_MORE_BLOCKS(HR_CHUNK_VALUE)

HR_DEFINE_NODE_AT(written_node, NodeArrays, global float*)
HR_DEFINE_BLOCK_AT(written_block, BlockArrays, global float*)

#endif

// The binary tree over sorted primitives, by clustering along the hierarchy of their Morton codes.
//
// The radix tree over sorted keys is the Cartesian tree of the prefixes that neighbours share (Karras 2012), so one
// sweep with a stack closes its nodes bottom-up: a range is closed when the prefix to its right is shorter than the one
// to its left. A closed node does not become a tree node at once: it gathers the clusters of both halves, and when they
// are more than `limit`, nearest neighbours are merged until at most `keep` are left (Benthin et al. 2024, "H-PLOC").
// With limit = keep = 1 the result is the radix tree itself (LBVH). A range that reaches over the chunk's ends stays
// pending; bvh_join_chunks closes what the chunks left. No atomics, no races.
#include "bvh/arena.h"

// Sweeps chunk g of the sorted keys. Left behind: its pending clusters in arena g; pending[g HR_SWEEP_DEPTH + e] =
// (clusters, left prefix) of pending range e; pending_count[g] ranges. Nodes are numbered from the chunk's first
// primitive on, children before parents; node_ranges[g] = first, end. Launch: G items.
kernel void bvh_cluster_chunks(global const ulong* restrict keys, const uint index_bits, const uint count,
                               global const Box* restrict boxes, global BinaryNode* restrict nodes,
                               global float* restrict arenas, const uint arena_capacity, global int2* restrict pending,
                               global uint* restrict pending_count, global uint2* restrict node_ranges,
                               const uint limit, const uint keep) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint begin = chunk_begin(count, g, groups), end = chunk_begin(count, g + 1, groups);
  const ulong index_mask = (1ul << index_bits) - 1;
  Arena arena = open_arena(arenas, g, arena_capacity, nodes, begin);
  Sweep sweep;
  sweep.size = 0;
  for (uint i = begin; i < end; i++) {
    const int left = i > 0 ? shared_prefix(keys, i) : -1;
    close_ranges(&arena, &sweep, left, limit, keep);
    open_range(&arena, &sweep, left);
    const uint primitive = (uint)(keys[i] & index_mask);
    const Box box = boxes[primitive];
    push_cluster(&arena, box.lo, box.hi, ~primitive, 1);
  }
  if (end > begin) close_ranges(&arena, &sweep, end < count ? shared_prefix(keys, end) : -1, limit, keep);
  for (uint e = 0; e < sweep.size; e++) {
    const uint next = e + 1 < sweep.size ? sweep.start[e + 1] : arena.end;
    pending[g * HR_SWEEP_DEPTH + e] = (int2)((int)(next - sweep.start[e]), sweep.left[e]);
  }
  pending_count[g] = sweep.size;
  node_ranges[g] = (uint2)(begin, arena.next_node);
}

// Joins what `groups` chunks left into one tree, in an arena of its own; nodes are numbered from `count` on. With limit
// 1 the ranges are closed as in a chunk, else all clusters are merged along the Morton order (Meister and Bittner 2018,
// "Parallel Locally-Ordered Clustering"): the top of the tree is where that order errs most. root[0] = its reference;
// node_ranges[groups] = its nodes. Launch: 1 item.
kernel void bvh_join_chunks(const uint count, global BinaryNode* restrict nodes, global float* arenas,
                            const uint arena_capacity, global float* join_arena, const uint join_capacity,
                            global const int2* restrict pending, global const uint* restrict pending_count,
                            global uint2* restrict node_ranges, const uint groups, const uint limit, const uint keep,
                            global int* restrict root) {
  Arena arena = open_arena(join_arena, 0, join_capacity, nodes, count);
  Sweep sweep;
  sweep.size = 0;
  for (uint g = 0; g < groups; g++) {
    const Arena source = open_arena(arenas, g, arena_capacity, nodes, 0);
    global const uint* words = (global const uint*)source.rows;
    uint from = 0;
    for (uint e = 0; e < pending_count[g]; e++) {
      const int2 range = pending[g * HR_SWEEP_DEPTH + e];
      if (limit == 1) {
        close_ranges(&arena, &sweep, range.y, limit, keep);
        open_range(&arena, &sweep, range.y);
      }
      for (uint c = 0; c < (uint)range.x; c++, from++) {
        global const float* p = source.rows + from;
        const uint s = source.stride;
        push_cluster(&arena, (float4)(p[0], p[s], p[2 * s], 0.0f), (float4)(p[3 * s], p[4 * s], p[5 * s], 0.0f),
                     words[6 * s + from], words[7 * s + from]);
      }
    }
  }
  if (limit == 1) close_ranges(&arena, &sweep, -1, limit, keep);
  reduce_clusters(&arena, 0, 1, HR_JOIN_RADIUS);
  root[0] = (int)((global uint*)arena.rows)[6 * arena.stride];
  node_ranges[groups] = (uint2)(count, arena.next_node);
}

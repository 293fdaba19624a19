// What clustering along the Morton order works on: the pending ranges of a sweep and the clusters they hold.
#ifndef HR_BVH_ARENA_H
#define HR_BVH_ARENA_H

#include "lib/chunk.h"
#include "shared/bvh_types.h"

#define HR_SWEEP_DEPTH 130u /* 64 growing and 64 shrinking prefixes, and the one at hand */
#define HR_CHUNK_RADIUS 16u /* neighbours looked at to either side, a multiple of 16 */
#ifndef HR_JOIN_RADIUS
#define HR_JOIN_RADIUS 128u /* the same for the top of the tree, where a bad pair costs most */
#endif
#define HR_ARENA_ROWS 9u
#define HR_ARENA_GUARD 32u /* floats on both sides of a row that vector loads may touch */

#ifndef HR_EXPLICIT_VECTORS
#define HR_EXPLICIT_VECTORS 1
#endif

// Clusters of the pending ranges, one row a component: lo x, y, z, hi x, y, z, reference, primitives; and a row for the
// nearest neighbours while they are merged.
typedef struct Arena {
  global float* rows;
  uint stride;
  uint end;
  global BinaryNode* nodes;
  uint next_node;
} Arena;

// Pending ranges: where their clusters start, and the prefix they share with what lies left of them.
typedef struct Sweep {
  uint start[HR_SWEEP_DEPTH];
  int left[HR_SWEEP_DEPTH];
  uint size;
} Sweep;

// Arena `index` of several with room for `capacity` clusters each.
static inline Arena open_arena(global float* arenas, uint index, uint capacity, global BinaryNode* nodes,
                               uint first_node) {
  Arena a;
  a.stride = capacity + 2 * HR_ARENA_GUARD;
  a.rows = arenas + (ulong)index * HR_ARENA_ROWS * a.stride + HR_ARENA_GUARD;
  a.end = 0;
  a.nodes = nodes;
  a.next_node = first_node;
  return a;
}

static inline void push_cluster(Arena* a, float4 lo, float4 hi, uint reference, uint primitives) {
  global float* p = a->rows + a->end;
  p[0] = lo.x;
  p[a->stride] = lo.y;
  p[2 * a->stride] = lo.z;
  p[3 * a->stride] = hi.x;
  p[4 * a->stride] = hi.y;
  p[5 * a->stride] = hi.z;
  ((global uint*)p)[6 * a->stride] = reference;
  ((global uint*)p)[7 * a->stride] = primitives;
  a->end++;
}

#if HR_EXPLICIT_VECTORS

static inline float least16(float16 v) {
  const float8 a = min(v.lo, v.hi);
  const float4 b = min(a.lo, a.hi);
  const float2 c = min(b.lo, b.hi);
  return min(c.x, c.y);
}

static inline uint least_uint16(uint16 v) {
  const uint8 a = min(v.lo, v.hi);
  const uint4 b = min(a.lo, a.hi);
  const uint2 c = min(b.lo, b.hi);
  return min(c.x, c.y);
}

// Half the surface of the unions of cluster i with clusters `from` .. from + 15. What overflows counts as huge.
static inline float16 union_areas(const Arena* a, uint i, int from) {
  global const float* p = a->rows + i;
  global const float* q = a->rows + from;
  const uint s = a->stride;
  const float16 dx = max(vload16(0, q + 3 * s), (float16)(p[3 * s])) - min(vload16(0, q), (float16)(p[0]));
  const float16 dy = max(vload16(0, q + 4 * s), (float16)(p[4 * s])) - min(vload16(0, q + s), (float16)(p[s]));
  const float16 dz = max(vload16(0, q + 5 * s), (float16)(p[5 * s])) - min(vload16(0, q + 2 * s), (float16)(p[2 * s]));
  return min((float16)(FLT_MAX), dx * dy + (dx + dy) * dz);
}

// The cluster within `radius` places (a multiple of 16) of i in [begin, end) whose union with i has the least surface;
// equals are told apart by the lesser i ^ j, which both partners see alike, so some pair is always mutual.
static inline uint nearest_cluster(const Arena* a, uint begin, uint end, uint i, uint radius) {
  const int16 lane = (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const uint16 none = (uint16)(0xffffffffu);
  float least = INFINITY;
  uint best = 0xffffffffu;
  for (uint r = 0; r < radius; r += 16) {
    const int16 j_after = lane + (int)(i + 1 + r), j_before = lane + ((int)i - 16 - (int)r);
    const int16 valid_after = j_after < (int16)((int)end), valid_before = j_before >= (int16)((int)begin);
    const float16 after = select((float16)(INFINITY), union_areas(a, i, min((int)(i + 1 + r), (int)end)), valid_after);
    const float16 before =
        select((float16)(INFINITY), union_areas(a, i, max((int)i - 16 - (int)r, (int)begin - 16)), valid_before);
    const float here = least16(min(after, before));
    if (!(here <= least)) continue;
    const uint16 x_after = select(none, as_uint16(j_after) ^ i, after == (float16)(here));
    const uint16 x_before = select(none, as_uint16(j_before) ^ i, before == (float16)(here));
    const uint x = least_uint16(min(x_after, x_before));
    best = here < least ? x : min(best, x);
    least = here;
  }
  return best ^ i;
}

#else

static inline float union_area(const Arena* a, uint i, uint j) {
  global const float* p = a->rows + i;
  global const float* q = a->rows + j;
  const uint s = a->stride;
  const float dx = max(q[3 * s], p[3 * s]) - min(q[0], p[0]);
  const float dy = max(q[4 * s], p[4 * s]) - min(q[s], p[s]);
  const float dz = max(q[5 * s], p[5 * s]) - min(q[2 * s], p[2 * s]);
  return min(FLT_MAX, dx * dy + (dx + dy) * dz);
}

static inline uint nearest_cluster(const Arena* a, uint begin, uint end, uint i, uint radius) {
  float least = INFINITY;
  uint best = 0xffffffffu;
  for (uint j = i > begin + radius ? i - radius : begin; j < min(end, i + radius + 1); j++) {
    if (j == i) continue;
    const float area = union_area(a, i, j);
    if (area < least || (area == least && (i ^ j) < best)) {
      least = area;
      best = i ^ j;
    }
  }
  return best ^ i;
}

#endif

// A tree node of clusters i and j; the union takes place `out` of the arena.
static inline void merge_clusters(Arena* a, uint i, uint j, uint out) {
  const uint s = a->stride;
  float box_i[6], box_j[6];
  for (uint k = 0; k < 6; k++) {
    box_i[k] = a->rows[k * s + i];
    box_j[k] = a->rows[k * s + j];
  }
  global uint* words = (global uint*)a->rows;
  const uint count_i = words[7 * s + i], count_j = words[7 * s + j];
  BinaryNode node;
  node.x = (float4)(box_i[0], box_i[3], box_j[0], box_j[3]);
  node.y = (float4)(box_i[1], box_i[4], box_j[1], box_j[4]);
  node.z = (float4)(box_i[2], box_i[5], box_j[2], box_j[5]);
  node.child = (uint4)(words[6 * s + i], words[6 * s + j], count_i, count_j);
  a->nodes[a->next_node] = node;
  for (uint k = 0; k < 3; k++) {
    a->rows[k * s + out] = min(box_i[k], box_j[k]);
    a->rows[(k + 3) * s + out] = max(box_i[k + 3], box_j[k + 3]);
  }
  words[6 * s + out] = a->next_node++;
  words[7 * s + out] = count_i + count_j;
}

static inline void move_cluster(Arena* a, uint from, uint to) {
  if (from == to) return;
  for (uint k = 0; k < 8; k++) a->rows[k * a->stride + to] = a->rows[k * a->stride + from];
}

// Merges mutual nearest neighbours among clusters [begin, end) of the arena's top until at most `keep` are left.
static inline void reduce_clusters(Arena* a, uint begin, uint keep, uint radius) {
  global uint* nearest = (global uint*)a->rows + 8 * a->stride;
  while (a->end - begin > keep) {
    if (a->end - begin == 2) {
      merge_clusters(a, begin, begin + 1, begin);
      a->end = begin + 1;
      return;
    }
    for (uint i = begin; i < a->end; i++) nearest[i] = nearest_cluster(a, begin, a->end, i, radius);
    uint out = begin;
    for (uint i = begin; i < a->end; i++) {
      const uint j = nearest[i];
      const bool mutual = nearest[j] == i;
      if (mutual && j < i) continue;
      if (mutual) {
        merge_clusters(a, i, j, out++);
      } else {
        move_cluster(a, i, out++);
      }
    }
    a->end = out;
  }
}

// Closes every range whose right neighbour shares less with it (`right` bits) than its left one. A range whose left
// part belongs to a range further left cannot be closed here.
static inline void close_ranges(Arena* a, Sweep* sweep, int right, uint limit, uint keep) {
  while (sweep->size >= 2) {
    const uint top = sweep->size - 1;
    if (sweep->left[top] <= right || sweep->left[top] <= sweep->left[top - 1]) return;
    sweep->size = top;
    if (a->end - sweep->start[top - 1] > limit) reduce_clusters(a, sweep->start[top - 1], keep, HR_CHUNK_RADIUS);
  }
}

static inline void open_range(const Arena* a, Sweep* sweep, int left) {
  sweep->start[sweep->size] = a->end;
  sweep->left[sweep->size] = left;
  sweep->size++;
}

static inline int shared_prefix(global const ulong* keys, uint i) { return (int)clz(keys[i - 1] ^ keys[i]); }

#endif

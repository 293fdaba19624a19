// The radix sort of radix_sort.cl for GPUs: a work-group takes a chunk of the array tile by tile, and brings each tile
// into order in local memory before it writes it out (Satish, Harris, Garland 2009, "Designing Efficient Sorting
// Algorithms for Manycore GPUs"), two bits of the digit at a time. Stable; no order hangs on an atomic.
#include "lib/chunk.h"
#include "lib/group.h"

#define HR_GROUP_RADIX 256u /* 8 bits a digit */
// Keys an item holds at a time: a tile takes at most 16 KiB of local memory.
#define HR_SORT_KEYS (HR_LOCAL_SIZE <= 256 ? 8 : 2048 / HR_LOCAL_SIZE)
#define HR_SORT_TILE (HR_SORT_KEYS * HR_LOCAL_SIZE)

static inline uint digit_of(ulong key, uint shift, uint digit_bits) {
  return (uint)(key >> shift) & ((1u << digit_bits) - 1);
}

// counts[digit * (G + 1) + g] = keys of chunk g with that digit. Launch: G work-groups.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void group_sort_count_digits(
    global const ulong* restrict keys, global uint* restrict counts, const uint shift, const uint digit_bits,
    const uint count) {
  local uint histogram[HR_GROUP_RADIX];
  const uint g = (uint)get_group_id(0), groups = (uint)get_num_groups(0), item = (uint)get_local_id(0);
  for (uint d = item; d < HR_GROUP_RADIX; d += HR_LOCAL_SIZE) histogram[d] = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint end = chunk_begin(count, g + 1, groups);
  for (uint i = chunk_begin(count, g, groups) + item; i < end; i += HR_LOCAL_SIZE) {
    atomic_inc(&histogram[digit_of(keys[i], shift, digit_bits)]);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint d = item; d < 1u << digit_bits; d += HR_LOCAL_SIZE) counts[d * (groups + 1) + g] = histogram[d];
}

// Sorts the tile by the bits of `mask` (1 or 3) from `shift` on. An item takes neighbouring keys; what it counts of
// the four values lies side by side in a ulong, 16 bits each, so that one scan adds up all of them.
static inline void split_tile(local ulong* tile, local ulong* sums, uint shift, uint mask) {
  const uint first = (uint)get_local_id(0) * HR_SORT_KEYS;
  ulong key[HR_SORT_KEYS];
  ulong mine = 0, all;
  for (uint k = 0; k < HR_SORT_KEYS; k++) {
    key[k] = tile[first + k];
    mine += 1ul << 16 * ((uint)(key[k] >> shift) & mask);
  }
  const ulong before = group_exclusive_scan(sums, mine, &all);
  ulong places = before + (all << 16) + (all << 32) + (all << 48);  // behind the smaller values of the whole tile
  for (uint k = 0; k < HR_SORT_KEYS; k++) {
    const uint field = 16 * ((uint)(key[k] >> shift) & mask);
    tile[(uint)(places >> field) & 0xffffu] = key[k];
    places += 1ul << field;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

// offset[d] = where the chunk's keys of digit d begin: behind all smaller digits and behind earlier chunks.
static inline void load_offsets(local uint* offset, local ulong* sums, global const uint* counts, uint radix) {
  const uint g = (uint)get_group_id(0), row = (uint)get_num_groups(0) + 1;
  uint sum = 0;
  for (uint first = 0; first < radix; first += HR_LOCAL_SIZE) {
    const uint d = first + (uint)get_local_id(0);
    ulong total;
    const uint before = (uint)group_exclusive_scan(sums, d < radix ? counts[d * row + row - 1] : 0, &total);
    if (d < radix) offset[d] = sum + before + counts[d * row + g];
    sum += (uint)total;
  }
}

// Moves every key to its place; counts: each digit's row after parallel_scan_rows. Launch: G work-groups.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void group_sort_scatter(
    global const ulong* restrict keys, global ulong* restrict keys_out, global const uint* restrict counts,
    const uint shift, const uint digit_bits, const uint count) {
  local ulong tile[HR_SORT_TILE], sums[HR_LOCAL_SIZE];
  local uint offset[HR_GROUP_RADIX], start[HR_GROUP_RADIX];
  const uint g = (uint)get_group_id(0), groups = (uint)get_num_groups(0), item = (uint)get_local_id(0);
  load_offsets(offset, sums, counts, 1u << digit_bits);
  const uint end = chunk_begin(count, g + 1, groups);
  for (uint begin = chunk_begin(count, g, groups); begin < end; begin += HR_SORT_TILE) {
    const uint size = min(end - begin, (uint)HR_SORT_TILE);
    // What lies beyond the chunk has the largest digit and comes last, so it stays behind the keys.
    for (uint i = item; i < HR_SORT_TILE; i += HR_LOCAL_SIZE) tile[i] = i < size ? keys[begin + i] : ~0ul;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint b = 0; b < digit_bits; b += 2) split_tile(tile, sums, shift + b, digit_bits - b > 1 ? 3 : 1);
    for (uint i = item; i < size; i += HR_LOCAL_SIZE) {
      const uint d = digit_of(tile[i], shift, digit_bits);
      if (i == 0 || d != digit_of(tile[i - 1], shift, digit_bits)) start[d] = i;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = item; i < size; i += HR_LOCAL_SIZE) {
      const uint d = digit_of(tile[i], shift, digit_bits);
      keys_out[offset[d] + i - start[d]] = tile[i];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = item; i < size; i += HR_LOCAL_SIZE) {  // the last key of each digit moves its offset on
      const uint d = digit_of(tile[i], shift, digit_bits);
      if (i + 1 == size || d != digit_of(tile[i + 1], shift, digit_bits)) offset[d] += i + 1 - start[d];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
}

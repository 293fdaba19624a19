// Least significant digit radix sort of 64-bit keys, stable: count, scan (scan.cl), scatter for each digit. One
// work-item takes one chunk of the array and keeps its histogram in private memory: what CPUs like.
#include "lib/chunk.h"

#define HR_MAX_RADIX 2048u /* 11 bits a digit */

// counts[digit * G + g] = keys of chunk g with that digit. Launch: G items.
kernel void sort_count_digits(global const ulong* restrict keys, global uint* restrict counts, const uint shift,
                              const uint digit_bits, const uint count) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint radix = 1u << digit_bits;
  uint histogram[HR_MAX_RADIX];
  for (uint d = 0; d < radix; d++) histogram[d] = 0;
  const uint end = chunk_begin(count, g + 1, groups);
  for (uint i = chunk_begin(count, g, groups); i < end; i++) histogram[(uint)(keys[i] >> shift) & (radix - 1)]++;
  for (uint d = 0; d < radix; d++) counts[d * groups + g] = histogram[d];
}

// Moves every key to its place; offsets = counts after an exclusive scan. Launch: G items.
kernel void sort_scatter(global const ulong* restrict keys, global ulong* restrict keys_out,
                         global const uint* restrict offsets, const uint shift, const uint digit_bits,
                         const uint count) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint radix = 1u << digit_bits;
  uint place[HR_MAX_RADIX];
  for (uint d = 0; d < radix; d++) place[d] = offsets[d * groups + g];
  const uint end = chunk_begin(count, g + 1, groups);
  for (uint i = chunk_begin(count, g, groups); i < end; i++) {
    const ulong key = keys[i];
    keys_out[place[(uint)(key >> shift) & (radix - 1)]++] = key;
  }
}

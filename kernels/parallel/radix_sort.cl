// Least significant digit radix sort of 64-bit keys with 32-bit values, stable: count, scan (scan.cl), scatter for each
// 8-bit digit. One work-item takes one chunk of the array and keeps its histogram in private memory.

#define HR_RADIX 256u

static inline uint sort_chunk_begin(uint n, uint g, uint groups) { return (uint)((ulong)n * g / groups); }

// counts[digit * G + g] = keys of chunk g with that digit. Launch: G items.
kernel void sort_count_digits(global const ulong* restrict keys, global uint* restrict counts, const uint shift,
                              const uint count) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  uint histogram[HR_RADIX];
  for (uint d = 0; d < HR_RADIX; d++) histogram[d] = 0;
  const uint end = sort_chunk_begin(count, g + 1, groups);
  for (uint i = sort_chunk_begin(count, g, groups); i < end; i++) {
    histogram[(uint)(keys[i] >> shift) & (HR_RADIX - 1)]++;
  }
  for (uint d = 0; d < HR_RADIX; d++) counts[d * groups + g] = histogram[d];
}

// Moves every key and value to its place; offsets = counts after an exclusive scan. Launch: G items.
kernel void sort_scatter(global const ulong* restrict keys, global const uint* restrict values,
                         global ulong* restrict keys_out, global uint* restrict values_out,
                         global const uint* restrict offsets, const uint shift, const uint count) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  uint place[HR_RADIX];
  for (uint d = 0; d < HR_RADIX; d++) place[d] = offsets[d * groups + g];
  const uint end = sort_chunk_begin(count, g + 1, groups);
  for (uint i = sort_chunk_begin(count, g, groups); i < end; i++) {
    const ulong key = keys[i];
    const uint to = place[(uint)(key >> shift) & (HR_RADIX - 1)]++;
    keys_out[to] = key;
    values_out[to] = values[i];
  }
}

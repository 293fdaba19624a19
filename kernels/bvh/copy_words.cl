// Parts of a tree from one buffer to another: trees that are joined, blocks that stand in two chunks.

// to[first + i] = from[begin + i] for i < count. Launch: G items.
kernel void bvh_copy_words(global const float* restrict from, const ulong begin, const ulong count, const ulong first,
                           global float* restrict to) {
  const ulong g = get_global_id(0), groups = get_global_size(0);
  const ulong share = (count + groups - 1) / groups, end = min(count, (g + 1) * share);
  for (ulong i = g * share; i < end; i++) to[first + i] = from[begin + i];
}

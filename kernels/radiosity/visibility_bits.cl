// Bit matrices of pairs, stride x stride bits in rows of words: mirrored, grown over neighbours, told apart.
#include "shared/radiosity_types.h"

// 32 x 32 bits mirrored at their diagonal (Warren 2012, Hacker's Delight, 7-3).
static inline void transpose_block(uint* a) {
  uint mask = 0x0000ffffu;
  for (uint step = 16; step != 0; step >>= 1, mask ^= mask << step) {
    for (uint k = 0; k < 32; k = ((k | step) + 1) & ~step) {
      const uint t = (a[k] >> step ^ a[k | step]) & mask;
      a[k | step] ^= t;
      a[k] ^= t << step;
    }
  }
}

// bits[j][i] = bits[i][j] for i < j. Launch: (stride / 32)^2 items, a block of 32 x 32 each.
kernel void radiosity_mirror_bits(global uint* restrict bits, const uint words) {
  const uint x = (uint)get_global_id(0) % words, y = (uint)get_global_id(0) / words;
  if (y >= words || x < y) return;
  uint a[32], b[32];
  for (uint k = 0; k < 32; k++) a[k] = b[k] = bits[(ulong)(32 * y + k) * words + x];
  transpose_block(b);
  for (uint k = 0; k < 32; k++) {
    if (x == y) {
      bits[(ulong)(32 * y + k) * words + x] = a[k] | b[k];
    } else {
      bits[(ulong)(32 * x + k) * words + y] = b[k];
    }
  }
}

// grown[j][i] = bits[i][j] or that of any neighbour of i: twice, it has grown by the neighbours of both and is
// the right way round again. Launch: (stride / 32)^2 items.
kernel void radiosity_grow_bits(global const uint* restrict bits, global const uint* restrict neighbours,
                                const uint count, const uint words, global uint* restrict grown) {
  const uint x = (uint)get_global_id(0) % words, y = (uint)get_global_id(0) / words;
  if (y >= words) return;
  uint a[32];
  for (uint k = 0; k < 32; k++) {
    const uint i = 32 * y + k;
    a[k] = bits[(ulong)i * words + x];
    for (uint n = 0; n < 3 && i < count; n++) {
      const uint other = neighbours[3 * i + n];
      if (other != HR_NO_SIDE) a[k] |= bits[(ulong)other * words + x];
    }
  }
  transpose_block(a);
  for (uint k = 0; k < 32; k++) grown[(ulong)(32 * x + k) * words + y] = a[k];
}

// partial = pairs with both answers around them, or cut, or `every` one; visible = the rest of those seen; counts[i] =
// partial pairs j > i. `partial` comes in as the grown hidden ones. Launch: one item a side.
kernel void radiosity_tell_pairs(global const uint* restrict grown_visible, global const uint* restrict hidden,
                                 global const uint* restrict cut, const uint every, const uint count, const uint words,
                                 global uint* restrict visible, global uint* restrict partial,
                                 global uint* restrict counts) {
  const uint i = (uint)get_global_id(0);
  if (i >= count) return;
  uint sum = 0;
  for (uint w = 0; w < words; w++) {
    const ulong at = (ulong)i * words + w;
    const uint around = every != 0 ? 0xffffffffu : grown_visible[at] & partial[at];
    const uint some = ((visible[at] | hidden[at]) & around) | cut[at];
    partial[at] = some;
    visible[at] &= ~some;
    const uint above = 32 * w > i ? 0xffffffffu : (32 * w + 31 > i ? 0xfffffffeu << (i - 32 * w) : 0u);
    sum += popcount(some & above);
  }
  counts[i] = sum;
}

// columns[starts[i] ...] = the partial pairs j > i of side i, ascending. Launch: one item a side.
kernel void radiosity_list_partial(global const uint* restrict partial, global const uint* restrict starts,
                                   const uint count, const uint words, global uint* restrict columns) {
  const uint i = (uint)get_global_id(0);
  if (i >= count) return;
  uint at = starts[i];
  for (uint w = i / 32; w < words; w++) {
    for (uint rest = partial[(ulong)i * words + w]; rest != 0; rest &= rest - 1) {
      const uint j = 32 * w + (31u - clz(rest & (~rest + 1u)));
      if (j <= i) continue;
      columns[at++] = j;
    }
  }
}

// Listed pairs j > i of side i that let everything through become visible instead of partial; what is below the
// diagonal is left to radiosity_mirror_bits. Launch: one item a side.
kernel void radiosity_settle_pairs(global const uint* restrict starts, global const uint* restrict columns,
                                   global const float* restrict shares, const uint count, const uint words,
                                   global uint* restrict visible, global uint* restrict partial) {
  const uint i = (uint)get_global_id(0);
  if (i >= count) return;
  const ulong row = (ulong)i * words;
  const uint above = i % 32 == 31 ? 0u : 0xfffffffeu << i % 32;
  visible[row + i / 32] &= above;
  partial[row + i / 32] &= above;
  for (uint k = starts[i]; k < starts[i + 1]; k++) {
    if (shares[k] < 1) continue;
    const uint bit = 1u << columns[k] % 32;
    visible[row + columns[k] / 32] |= bit;
    partial[row + columns[k] / 32] &= ~bit;
  }
}

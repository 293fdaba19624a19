// How far factors are from reciprocity, A_i F_ij = A_j F_ji.
#include "lib/chunk.h"
#include "lib/vec.h"
#include "radiosity/factors.h"
#include "radiosity/row_search.h"
#include "shared/radiosity_types.h"

// Rows that are gone through together: what lies side by side in another row is then looked for once.
#define HR_ROWS_TOGETHER 32u

// Of the entries of one block's rows whose columns are rows of another block: largest[g] = (max A_i F_ij, max |A_i F_ij
// - A_j F_ji|) over chunk g, kept if larger than before. `place`: of a side in its block, HR_NO_SIDE elsewhere; the
// other block's sides lie in [other_first, other_end). Launch: G items.
kernel void radiosity_compare_transpose(global const uint* restrict rows, global const uint* restrict starts,
                                        global const uint* restrict columns, HR_FACTORS(values), const uint row_count,
                                        global const uint* restrict other_starts,
                                        global const uint* restrict other_columns, HR_FACTORS(other_values),
                                        global const uint* restrict place, const uint other_first, const uint other_end,
                                        global const float4* restrict normals, global float2* restrict largest) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  float2 most = largest[g];
  const uint end = chunk_begin(row_count, g + 1, groups);
  for (uint first = chunk_begin(row_count, g, groups); first < end; first += HR_ROWS_TOGETHER) {
    const uint count = min(HR_ROWS_TOGETHER, end - first);
    uint next[HR_ROWS_TOGETHER];  // of each row, the entry that comes next
    for (uint t = 0; t < count; t++) {
      next[t] = first_entry(columns, starts[first + t], starts[first + t + 1], other_first);
    }
    for (uint side = other_first; side < other_end; side++) {
      const uint j = place[side];
      if (j == HR_NO_SIDE) continue;
      const uint other_begin = other_starts[j], other_stop = other_starts[j + 1];
      uint back = other_stop;  // in its row, the entry of the next of ours; here: not looked for yet
      for (uint t = 0; t < count; t++) {
        const uint k = first + t, row_end = starts[k + 1];
        uint i = next[t];
        while (i < row_end && columns[i] < side) i++;
        next[t] = i;
        if (i >= row_end || columns[i] != side) continue;
        if (back >= other_stop || other_columns[back] != rows[k]) {
          back = first_entry(other_columns, other_begin, other_stop, rows[k]);
        }
        const float there = normals[rows[k] / 2].w * HR_FACTOR(values, k, i);
        float here = 0;
        if (back < other_stop && other_columns[back] == rows[k]) {
          here = normals[side / 2].w * HR_FACTOR(other_values, j, back);
          back++;  // most often the next row's
        }
        most = max(most, (float2)(max(there, here), fabs(there - here)));
      }
    }
  }
  largest[g] = most;
}

// How far factors are from reciprocity, A_i F_ij = A_j F_ji.
#include "lib/chunk.h"
#include "lib/vec.h"
#include "radiosity/factors.h"
#include "radiosity/row_search.h"
#include "shared/radiosity_types.h"

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
  for (uint k = chunk_begin(row_count, g, groups); k < end; k++) {
    const float area = normals[rows[k] / 2].w;
    for (uint i = first_entry(columns, starts[k], starts[k + 1], other_first);
         i < starts[k + 1] && columns[i] < other_end; i++) {
      const uint j = place[columns[i]];
      if (j == HR_NO_SIDE) continue;
      const uint back = first_entry(other_columns, other_starts[j], other_starts[j + 1], rows[k]);
      const float there = area * HR_FACTOR(values, k, i);
      float here = 0;
      if (back < other_starts[j + 1] && other_columns[back] == rows[k]) {
        here = normals[columns[i] / 2].w * HR_FACTOR(other_values, j, back);
      }
      most = max(most, (float2)(max(there, here), fabs(there - here)));
    }
  }
  largest[g] = most;
}

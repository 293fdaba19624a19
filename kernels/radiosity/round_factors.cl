// Form factors in half precision: a row's values are scaled so that the largest lies near the top of half's range, and
// rounded to the nearest, ties to even.
#define HR_HALF_FACTORS 1
#include "radiosity/factors.h"
#include "radiosity/wide_sum.h"

#define HR_HALF_TOP 14 /* rows' largest values become 2^14 to 2^15, of at most 65504 */

// Row rows[k] of F_ij, or with `exchange` of A_i F_ij, as halves and a scale, F_ij = halves scales[k]. A scale holds
// 1 / A_i in the latter case: what is rounded is the same number for both sides of a pair, and so symmetric after it.
// changes[k], d = rounded F_ij - F_ij in single: x largest |d| / F_ij, y the sum of these, z of |d|, w of d. Launch:
// row_count items.
kernel void radiosity_round_row(global const uint* restrict rows, global const uint* restrict starts,
                                global const float* restrict values, const uint row_count,
                                global const float4* restrict normals, const uint exchange,
                                global half* restrict halves, global float* restrict scales,
                                global float4* restrict changes) {
  const uint k = (uint)get_global_id(0);
  if (k >= row_count) return;
  float most = 0;
  for (uint e = starts[k]; e < starts[k + 1]; e++) most = max(most, values[e]);
  const int exponent = most > 0 ? ilogb(most) - HR_HALF_TOP : 0;
  const float area = exchange ? normals[rows[k] / 2].w : 1.0f;
  const float scale = ldexp(1.0f, exponent) / area;
  float largest = 0;
  wide4 sum = wide_of((real4)(0));
  for (uint e = starts[k]; e < starts[k + 1]; e++) {
    vstore_half_rte(ldexp(values[e], -exponent), e, halves);
    const float before = values[e] / area, change = half_factor(halves, scale, e) - before;
    const float relative = before > 0 ? fabs(change) / before : 0.0f;
    largest = max(largest, relative);
    sum = wide_add_product(sum, real4_of((float4)(relative, fabs(change), change, 0)), (real4)(1));
  }
  scales[k] = scale;
  const real4 total = wide_value(sum);
  changes[k] = (float4)(largest, (float)total.x, (float)total.y, (float)total.z);
}

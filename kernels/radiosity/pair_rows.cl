// From exchange areas of a batch of rows to sparse rows, and the least symmetric change that closes closed rows.
#include "radiosity/pair_sides.h"

static inline bool has_bit(global const uint* bits, uint stride, uint i, uint j) {
  return (bits[((ulong)i * stride + j) / 32] >> j % 32 & 1u) != 0;
}

// Where the partial pair i < j is listed.
static inline uint find_partial(global const uint* starts, global const uint* columns, uint i, uint j) {
  uint low = starts[i], high = starts[i + 1];
  while (high - low > 1) {
    const uint middle = low + (high - low) / 2;
    if (columns[middle] <= j) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return low;
}

// dense becomes what gets through. counts[row] = pairs left; sums[side] = sums of the row's exchange and of its errors
// [m^2]: x all, y quadrature, z rays, w: what partly hidden pairs exchange. Launch: one item a row.
kernel void radiosity_apply_visibility(global const uint* restrict visible, global const uint* restrict partial,
                                       global const uint* restrict starts, global const uint* restrict columns,
                                       global const float* restrict shares, global const float* restrict errors,
                                       const uint stride, const uint first, const uint row_count,
                                       global float* restrict dense, global uint* restrict counts,
                                       global float4* restrict sums) {
  const uint at = (uint)get_global_id(0);
  if (at >= row_count) return;
  const uint i = first + at;
  float4 sum = (float4)(0.0f), lost = sum;  // compensated (Kahan 1965)
  uint count = 0;
  for (uint j = 0; j < stride; j++) {
    const ulong place = (ulong)at * stride + j;
    float g = dense[place];
    if (g == 0) continue;
    float error = 0, mixed = 0;
    if (has_bit(partial, stride, i, j)) {
      const uint k = find_partial(starts, columns, min(i, j), max(i, j));
      error = g * errors[k];
      g *= shares[k];
      mixed = g;
    } else if (!has_bit(visible, stride, i, j)) {
      g = 0;
    }
    dense[place] = g;
    if (g > 0) count++;
    const float4 term = (float4)(g, g * HR_PAIR_FAR_ERROR, error, mixed) - lost;
    const float4 next = sum + term;
    lost = (next - sum) - term;
    sum = next;
  }
  counts[at] = count;
  sums[i] = sum;
}

// sums[row groups + k] = what may be wrong with the exchange of side first + begin + row with all of area k: x the
// bound of the quadrature's error [m^2], y the variance of its rays [m^4], z what its partly hidden pairs would
// exchange with nothing in the way [m^2]. `dense`: what pairs would exchange, from side `first` on. sums are 0 before.
// Launch: one item a row.
kernel void radiosity_sum_pair_errors(global const uint* restrict visible, global const uint* restrict partial,
                                      global const uint* restrict starts, global const uint* restrict columns,
                                      global const float* restrict shares, global const float* restrict errors,
                                      const uint stride, const uint first, const uint begin, const uint row_count,
                                      global const float* restrict dense, global const uint* restrict groups_of,
                                      const uint groups, global float4* restrict sums) {
  const uint row = (uint)get_global_id(0);
  if (row >= row_count) return;
  const uint at = begin + row, i = first + at;
  for (uint j = 0; j < stride; j++) {
    const float g = dense[(ulong)at * stride + j];
    if (g == 0) continue;
    float4 term = (float4)(g * HR_PAIR_FAR_ERROR, 0.0f, 0.0f, 0.0f);
    if (has_bit(partial, stride, i, j)) {
      const uint k = find_partial(starts, columns, min(i, j), max(i, j));
      const float error = g * errors[k];
      term = (float4)(term.x * shares[k], error * error, g, 0.0f);
    } else if (!has_bit(visible, stride, i, j)) {
      continue;
    }
    sums[(ulong)row * groups + groups_of[j]] += term;
  }
}

// Row `row` becomes columns and values [starts[row], ...): sides and exchange areas. Launch: one item a row.
kernel void radiosity_emit_pairs(global const float* restrict dense, global const uint* restrict ids,
                                 global const uint* restrict starts, const uint stride, const uint row_count,
                                 global uint* restrict columns, global float* restrict values) {
  const uint at = (uint)get_global_id(0);
  if (at >= row_count) return;
  uint out = starts[at];
  for (uint j = 0; j < stride; j++) {
    const float g = dense[(ulong)at * stride + j];
    if (g == 0) continue;
    columns[out] = ids[j];
    values[out++] = g;
  }
}

// sums[rows[k]] = sum over j of G_ij scales[j], i = rows[k]. Launch: row_count items.
kernel void radiosity_sum_scaled(global const uint* restrict rows, global const uint* restrict starts,
                                 global const uint* restrict columns, global const float* restrict values,
                                 const uint row_count, global const float* restrict scales,
                                 global float* restrict sums) {
  const uint k = (uint)get_global_id(0);
  if (k >= row_count) return;
  float sum = 0, lost = 0;
  for (uint e = starts[k]; e < starts[k + 1]; e++) {
    const float term = values[e] * scales[columns[e]] - lost, next = sum + term;
    lost = (next - sum) - term;
    sum = next;
  }
  sums[rows[k]] = sum;
}

// Exchange areas are scaled, (s_i s_j) G_ij, and with as_factors divided by A_i: F_ij. Launch: row_count items.
kernel void radiosity_scale_pairs(global const uint* restrict rows, global const uint* restrict starts,
                                  global const uint* restrict columns, const uint row_count,
                                  global const float* restrict scales, global const float4* restrict normals,
                                  const uint as_factors, global float* restrict values) {
  const uint k = (uint)get_global_id(0);
  if (k >= row_count) return;
  const uint i = rows[k];
  const float scale = scales[i], area = as_factors ? normals[i / 2].w : 1.0f;
  for (uint e = starts[k]; e < starts[k + 1]; e++) values[e] = (scale * scales[columns[e]]) * values[e] / area;
}

// What cannot be, counted in factors that were computed row by row (hemicubes), and where they differ from what pairs
// exchange.
#include "radiosity/pair_sides.h"
#include "shared/radiosity_types.h"

#define HR_GUARD_ROUNDING 1.00001f
#define HR_GUARD_DIFFERS 0.01f /* of the pair's factor */

// Entries of rows[k] against laws that hold for each alone: x: F > 1, y: A_i F_ij > min(A_i, A_j), z: more than with
// nothing in the way, by over 1 % (dense: exchange of side first + row of it with nothing in the way; rows outside the
// batch are left). active[side] = its number in the table, or HR_NO_SIDE. Launch: row_count items.
kernel void radiosity_check_entries(global const uint* restrict rows, global const uint* restrict starts,
                                    global const uint* restrict columns, global const float* restrict values,
                                    const uint row_count, global const uint* restrict active,
                                    global const float4* restrict normals, global const float* restrict dense,
                                    const uint stride, const uint first, const uint batch,
                                    global uint4* restrict broken) {
  const uint k = (uint)get_global_id(0);
  if (k >= row_count) return;
  const uint i = active[rows[k]];
  if (i < first || i >= first + batch) return;
  const float area = normals[rows[k] / 2].w;
  uint4 count = (uint4)(0);
  for (uint e = starts[k]; e < starts[k + 1]; e++) {
    const float f = values[e], other = normals[columns[e] / 2].w;
    if (f > HR_GUARD_ROUNDING) count.x++;
    if (area * f > min(area, other) * HR_GUARD_ROUNDING) count.y++;
    const uint j = active[columns[e]];
    if (j == HR_NO_SIDE || area * f > dense[(ulong)(i - first) * stride + j] * (1 + HR_GUARD_DIFFERS)) count.z++;
  }
  broken[i] = count;
}

// Entries that are more than 1 % off what the pair exchanges, by cause: x proximity (the sides are close for their
// size), y visibility (partly hidden), z aliasing (the pair is seen by fewer than 64 rays), w: the rest (a point
// stands for the side). `dense`: what gets through; `finest`: the largest factor of a cell. Launch: row_count items.
kernel void radiosity_find_causes(global const uint* restrict rows, global const uint* restrict starts,
                                  global const uint* restrict columns, global const float* restrict values,
                                  const uint row_count, global const uint* restrict active,
                                  global const float* restrict sides, global const uint* restrict partial,
                                  global const float* restrict dense, const uint stride, const uint first,
                                  const uint batch, const float finest, global uint4* restrict causes) {
  const uint k = (uint)get_global_id(0);
  if (k >= row_count) return;
  const uint i = active[rows[k]];
  if (i < first || i >= first + batch) return;
  uint4 count = (uint4)(0);
  const PairRow row = load_pair_row(sides, stride, i);
  for (uint e = starts[k]; e < starts[k + 1]; e++) {
    const uint j = active[columns[e]];
    if (j == HR_NO_SIDE) continue;
    const float f = dense[(ulong)(i - first) * stride + j] / row.area;
    if (fabs(values[e] - f) <= HR_GUARD_DIFFERS * f) continue;
    float distance2 = 0;
    for (uint c = 0; c < 3; c++) {
      const float d = HR_SIDE_VALUE(HR_SIDE_CENTER + c, j) - row.center[c];
      distance2 += d * d;
    }
    const float reach = HR_PAIR_MIDDLE * (row.radius + HR_SIDE_VALUE(HR_SIDE_RADIUS, j));
    if (distance2 < reach * reach) {
      count.x++;
    } else if (partial[((ulong)i * stride + j) / 32] >> j % 32 & 1u) {
      count.y++;
    } else if (f < 64 * finest) {
      count.z++;
    } else {
      count.w++;
    }
  }
  causes[i] = count;
}

// residuals[i] = the largest |A_i F_ij - A_j F_ji| of its row [m^2] against rows of the second block (numbers:
// place[side] = row there, or HR_NO_SIDE), if above what is there. Launch: row_count items.
kernel void radiosity_check_reciprocity(global const uint* restrict rows, global const uint* restrict starts,
                                        global const uint* restrict columns, global const float* restrict values,
                                        const uint row_count, global const uint* restrict place,
                                        global const uint* restrict other_starts,
                                        global const uint* restrict other_columns,
                                        global const float* restrict other_values,
                                        global const float4* restrict normals, global float* restrict residuals) {
  const uint k = (uint)get_global_id(0);
  if (k >= row_count) return;
  const uint i = rows[k];
  const float area = normals[i / 2].w;
  float worst = residuals[i];
  for (uint e = starts[k]; e < starts[k + 1]; e++) {
    const uint j = columns[e], row = place[j];
    if (row == HR_NO_SIDE) continue;
    uint low = other_starts[row], high = other_starts[row + 1];
    while (low < high) {
      const uint middle = low + (high - low) / 2;
      if (other_columns[middle] < i) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    const float back = low < other_starts[row + 1] && other_columns[low] == i ? other_values[low] : 0.0f;
    worst = max(worst, fabs(area * values[e] - normals[j / 2].w * back));
  }
  residuals[i] = worst;
}

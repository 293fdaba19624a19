// Exchange areas G_ij = A_i F_ij of pairs that face each other with nothing between, where points on both will do:
// Gauss's rules of 3 (degree 2) and of 7 points (degree 5) on a triangle (Radon 1948).
#include "radiosity/pair_sides.h"

#define HR_INVERSE_PI 0.318309886f
#define HR_FAR_COLUMNS 256u

// Points of the rule of 7: the center, then corner k at two scales. Of the rule of 3: 1/2.
constant float scale7[7] = {0.0f,         -0.410426192f, -0.410426192f, -0.410426192f,
                            0.696140478f, 0.696140478f,  0.696140478f};
constant float weight7[7] = {0.225f,       0.132394153f, 0.132394153f, 0.132394153f,
                             0.125939181f, 0.125939181f, 0.125939181f};
constant uint corner7[7] = {0, 0, 1, 2, 0, 1, 2};

// cos cos' / r^2 between points of the row and of the columns, but for the lengths in it.
static inline float16 exchange(const PairRow* row, const PairColumns* p, uint a, float scale_a, uint b, float scale_b) {
  float16 d[3];
  for (uint c = 0; c < 3; c++) d[c] = p->away[c] + (scale_b * p->corner[b][c] - scale_a * row->corner[a][c]);
  const float16 r2 = dot16(d[0], d[1], d[2], d[0], d[1], d[2]);
  const float16 h = fma((float16)(scale_b), p->heights[b], p->height),
                g = fma((float16)(scale_a), p->row_heights[a], p->row_height);
  return h * g / (r2 * r2);
}

static inline float16 rule3(const PairRow* row, const PairColumns* p) {
  float16 same = (float16)(0.0f), across = same;
  for (uint a = 0; a < 3; a++) {
    same += exchange(row, p, a, 0.5f, a, 0.5f);
    for (uint b = a + 1; b < 3; b++) {
      across += exchange(row, p, a, 0.5f, b, 0.5f) + exchange(row, p, b, 0.5f, a, 0.5f);
    }
  }
  return (same + across) * (1.0f / 9);
}

static inline float16 rule7(const PairRow* row, const PairColumns* p) {
  float16 sum = (float16)(0.0f);
  for (uint a = 0; a < 7; a++) {
    sum += weight7[a] * weight7[a] * exchange(row, p, corner7[a], scale7[a], corner7[a], scale7[a]);
    for (uint b = a + 1; b < 7; b++) {
      const float16 both = exchange(row, p, corner7[a], scale7[a], corner7[b], scale7[b]) +
                           exchange(row, p, corner7[b], scale7[b], corner7[a], scale7[a]);
      sum += weight7[a] * weight7[b] * both;
    }
  }
  return sum;
}

// dense[row stride + j] = G of sides first + row and j, 0 where they do not face each other, HR_PAIR_IS_NEAR where
// radiosity_pair_near has to see. Launch: row_count x columns / HR_FAR_COLUMNS items, a row's one after the other.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void radiosity_pair_far(
    global const float* restrict sides, const uint stride, const uint count, const float flatness, const uint first,
    const uint row_count, global float* restrict dense) {
  const uint blocks = (stride + HR_FAR_COLUMNS - 1) / HR_FAR_COLUMNS;
  const uint at = (uint)get_global_id(0) / blocks;
  if (at >= row_count) return;
  const uint begin = (uint)get_global_id(0) % blocks * HR_FAR_COLUMNS, end = min(begin + HR_FAR_COLUMNS, stride);
  const PairRow row = load_pair_row(sides, stride, first + at);
  for (uint j = begin; j < end; j += 16) {
    const PairColumns p = load_pair_columns(sides, stride, &row, j, flatness);
    float16 g = (float16)(0.0f);
    if (any_lane16(p.facing)) {
      const float16 reach = HR_SIDE_VALUES(HR_SIDE_RADIUS, j) + row.radius;
      const float16 ratio2 = p.distance2 / (reach * reach);
      const int16 far = p.whole & (ratio2 >= HR_PAIR_FAR * HR_PAIR_FAR);
      const int16 middle = p.whole & ~far & (ratio2 >= HR_PAIR_MIDDLE * HR_PAIR_MIDDLE);
      if (any_lane16(far)) g = select(g, rule3(&row, &p), far);
      if (any_lane16(middle)) g = select(g, rule7(&row, &p), middle);
      g = max(g, (float16)(0.0f)) * (row.area * HR_SIDE_VALUES(HR_SIDE_AREA, j)) * HR_INVERSE_PI;
      g = select(g, (float16)(HR_PAIR_IS_NEAR), p.facing & ~far & ~middle);
    }
    vstore16(g, 0, dense + (ulong)at * stride + j);
  }
}

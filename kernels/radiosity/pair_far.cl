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
static inline floatp exchange(const PairRow* row, const PairColumns* p, uint a, float scale_a, uint b, float scale_b) {
  floatp d[3];
  for (uint c = 0; c < 3; c++) d[c] = p->away[c] + (scale_b * p->corner[b][c] - scale_a * row->corner[a][c]);
  const floatp r2 = dot_lanes(d[0], d[1], d[2], d[0], d[1], d[2]);
  const floatp h = fma((floatp)(scale_b), p->heights[b], p->height),
               g = fma((floatp)(scale_a), p->row_heights[a], p->row_height);
  // A product, which is rounded before it is added to: on NVIDIA's a quotient is not.
  return h * g * (1.0f / (r2 * r2));
}

static inline floatp rule3(const PairRow* row, const PairColumns* p) {
  floatp same = (floatp)(0.0f), across = same;
  for (uint a = 0; a < 3; a++) {
    same += exchange(row, p, a, 0.5f, a, 0.5f);
    for (uint b = a + 1; b < 3; b++) {
      across += exchange(row, p, a, 0.5f, b, 0.5f) + exchange(row, p, b, 0.5f, a, 0.5f);
    }
  }
  return (same + across) * (1.0f / 9);
}

static inline floatp rule7(const PairRow* row, const PairColumns* p) {
  floatp sum = (floatp)(0.0f);
  for (uint a = 0; a < 7; a++) {
    sum += weight7[a] * weight7[a] * exchange(row, p, corner7[a], scale7[a], corner7[a], scale7[a]);
    for (uint b = a + 1; b < 7; b++) {
      const floatp both = exchange(row, p, corner7[a], scale7[a], corner7[b], scale7[b]) +
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
  for (uint j = begin; j < end; j += HR_P) {
    const PairColumns p = load_pair_columns(sides, stride, &row, j, flatness);
    floatp g = (floatp)(0.0f);
    if (any_lane(p.facing)) {
      const floatp reach = HR_SIDE_VALUES(HR_SIDE_RADIUS, j) + row.radius;
      const floatp ratio2 = p.distance2 / (reach * reach);
      const intp far = p.whole & (ratio2 >= HR_PAIR_FAR * HR_PAIR_FAR);
      const intp middle = p.whole & no_lanes(far) & (ratio2 >= HR_PAIR_MIDDLE * HR_PAIR_MIDDLE);
      if (any_lane(far)) g = choose(g, rule3(&row, &p), far);
      if (any_lane(middle)) g = choose(g, rule7(&row, &p), middle);
      g = max(g, (floatp)(0.0f)) * (row.area * HR_SIDE_VALUES(HR_SIDE_AREA, j)) * HR_INVERSE_PI;
      g = choose(g, (floatp)(HR_PAIR_IS_NEAR), p.facing & no_lanes(far | middle));
    }
    store_lanes(g, dense + (ulong)at * stride + j);
  }
}

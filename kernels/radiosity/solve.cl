// The radiosity system B_i = E_i + rho_i H_i + tau_i H_i', H_i = sum_j F_ij B_j what arrives on side i, H_i' on the
// other side of the same triangle. Four columns are solved together: red, green, blue, and w: the system (I - rho F -
// tau F') w = 1 with the largest rho and tau of the three, whose solution bounds the error (host/radiosity/solver.hpp).
#include "radiosity/factors.h"
#include "radiosity/row_search.h"
#include "radiosity/wide_sum.h"
#include "shared/radiosity_types.h"

#ifndef HR_LOCAL_SIZE
#define HR_LOCAL_SIZE 64
#endif

// One chunk of the matrix: rows[k] has columns and values [starts[k], starts[k + 1]).
// incident[rows[k]] = H of it, for k in [first, first + count). Launch: count items.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void radiosity_gather(
    global const uint* restrict rows, global const uint* restrict starts, global const uint* restrict columns,
    HR_FACTORS(values), const uint first, const uint count, global const real4* restrict radiosity,
    global wide4* restrict incident) {
  if (get_global_id(0) >= count) return;
  const uint k = first + (uint)get_global_id(0);
  wide4 sum = wide_of((real4)(0));
  for (uint i = starts[k]; i < starts[k + 1]; i++) {
    sum = wide_add_product(sum, radiosity[columns[i]], (real4)((real)HR_FACTOR(values, k, i)));
  }
  incident[rows[k]] = sum;
}

// residual[s] = E + rho H + tau H' - B. Launch: count items.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void radiosity_residual(
    global const float4* restrict emission, global const float4* restrict reflectance,
    global const float4* restrict transmittance, global const wide4* restrict incident,
    global const real4* restrict radiosity, const uint count, global real4* restrict residual) {
  const uint s = (uint)get_global_id(0);
  if (s >= count) return;
  wide4 sum = wide_add_scaled(wide_of(real4_of(emission[s])), real4_of(reflectance[s]), incident[s]);
  sum = wide_add_scaled(sum, real4_of(transmittance[s]), incident[s ^ 1u]);
  sum = wide_add_product(sum, radiosity[s], (real4)(-1));
  residual[s] = wide_value(sum);
}

// Jacobi: B += r. Launch: count items.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void radiosity_add(
    global real4* restrict radiosity, global const real4* restrict residual, const uint count) {
  const uint s = (uint)get_global_id(0);
  if (s < count) radiosity[s] += residual[s];
}

// Gauss-Seidel: B of the rows just gathered, from the newest B of the others; a side's own factor is taken out, the
// columns w like the colours. Launch: count items, `rows` from `first` on.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void radiosity_relax(
    global const uint* restrict rows, const uint first, const uint count, global const float4* restrict emission,
    global const float4* restrict reflectance, global const float4* restrict transmittance,
    global const wide4* restrict incident, global const float* restrict own, global real4* restrict radiosity) {
  if (get_global_id(0) >= count) return;
  const uint s = rows[first + (uint)get_global_id(0)];
  const real4 reflects = real4_of(reflectance[s]);
  const real4 others = wide_value(incident[s]) - radiosity[s] * (real4)((real)own[s]);
  radiosity[s] =
      (real4_of(emission[s]) + reflects * others + real4_of(transmittance[s]) * wide_value(incident[s ^ 1u])) /
      ((real4)(1) - reflects * (real4)((real)own[s]));
}

// Of the sides with rows: own = F_ii, 0 for what is flat; sums = sum_j F_ij, no number where one of them is none; least
// = the smallest of the row, of those that are numbers, or 0. Launch: row_count items.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void radiosity_find_row_facts(
    global const uint* restrict rows, global const uint* restrict starts, global const uint* restrict columns,
    HR_FACTORS(values), const uint row_count, global float* restrict own, global float* restrict sums,
    global float* restrict least) {
  const uint k = (uint)get_global_id(0);
  if (k >= row_count) return;
  const uint end = starts[k + 1];
  float4 smallest = (float4)(0);
  wide4 sum = wide_of((real4)(0));
  for (uint i = starts[k]; i < end; i += 4) {
    float4 four = (float4)(HR_FACTOR(values, k, i), 0, 0, 0);
    if (i + 4 <= end) {
      four = HR_FACTORS4(values, k, i);
    } else {
      if (i + 1 < end) four.y = HR_FACTOR(values, k, i + 1);
      if (i + 2 < end) four.z = HR_FACTOR(values, k, i + 2);
    }
    smallest = min(smallest, four);
    sum = wide_add_product(sum, real4_of(four), (real4)(1));
  }
  const uint place = first_entry(columns, starts[k], end, rows[k]);
  own[rows[k]] = place < end && columns[place] == rows[k] ? HR_FACTOR(values, k, place) : 0;
  sums[rows[k]] = (float)wide_sum_columns(sum);
  least[rows[k]] = min(min(smallest.x, smallest.y), min(smallest.z, smallest.w));
}

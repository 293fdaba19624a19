// The radiosity system B_i = E_i + rho_i H_i + tau_i H_i', H_i = sum_j F_ij B_j what arrives on side i, H_i' on the
// other side of the same triangle. Four columns are solved together: red, green, blue, and w: the system (I - rho F)
// w = 1 with the largest rho of the three, whose solution bounds the error (host/radiosity/solver.hpp).
#include "lib/vec.h"
#include "shared/radiosity_types.h"

// One chunk of the matrix: rows[k] has columns and values [starts[k], starts[k + 1]).
// incident[rows[k]] = H of it, for k in [first, first + count). Launch: count items.
kernel void radiosity_gather(global const uint* restrict rows, global const uint* restrict starts,
                             global const uint* restrict columns, global const float* restrict values, const uint first,
                             const uint count, global const real4* restrict radiosity,
                             global real4* restrict incident) {
  if (get_global_id(0) >= count) return;
  const uint k = first + (uint)get_global_id(0);
  real4 sum = (real4)(0);
  for (uint i = starts[k]; i < starts[k + 1]; i++) sum += radiosity[columns[i]] * (real4)((real)values[i]);
  incident[rows[k]] = sum;
}

// residual[s] = E + rho H + tau H' - B. Launch: count items.
kernel void radiosity_residual(global const float4* restrict emission, global const float4* restrict reflectance,
                               global const float4* restrict transmittance, global const real4* restrict incident,
                               global const real4* restrict radiosity, const uint count,
                               global real4* restrict residual) {
  const uint s = (uint)get_global_id(0);
  if (s >= count) return;
  const float4 e = emission[s], rho = reflectance[s], tau = transmittance[s];
  residual[s] = (real4)((real)e.x, (real)e.y, (real)e.z, (real)e.w) +
                (real4)((real)rho.x, (real)rho.y, (real)rho.z, (real)rho.w) * incident[s] +
                (real4)((real)tau.x, (real)tau.y, (real)tau.z, (real)tau.w) * incident[s ^ 1u] - radiosity[s];
}

// y += a x. Launch: count items.
kernel void radiosity_add(global real4* restrict y, global const real4* restrict x, const float a, const uint count) {
  const uint s = (uint)get_global_id(0);
  if (s < count) y[s] += x[s] * (real4)((real)a);
}

// Gauss-Seidel: B of the rows just gathered, from the newest B of the others; a side's own factor is taken out, the
// columns w like the colours. Launch: count items, `rows` from `first` on.
kernel void radiosity_relax(global const uint* restrict rows, const uint first, const uint count,
                            global const float4* restrict emission, global const float4* restrict reflectance,
                            global const float4* restrict transmittance, global const real4* restrict incident,
                            global const float* restrict own, global real4* restrict radiosity) {
  if (get_global_id(0) >= count) return;
  const uint s = rows[first + (uint)get_global_id(0)];
  const float4 e = emission[s], rho = reflectance[s], tau = transmittance[s];
  const real4 reflects = (real4)((real)rho.x, (real)rho.y, (real)rho.z, (real)rho.w);
  const real4 shines = (real4)((real)e.x, (real)e.y, (real)e.z, (real)e.w);
  const real4 passes = (real4)((real)tau.x, (real)tau.y, (real)tau.z, (real)tau.w);
  const real4 others = incident[s] - radiosity[s] * (real4)((real)own[s]);
  radiosity[s] =
      (shines + reflects * others + passes * incident[s ^ 1u]) / ((real4)(1) - reflects * (real4)((real)own[s]));
}

// own[rows[k]] = F_ii, 0 for what is flat. Launch: row_count items.
kernel void radiosity_find_own(global const uint* restrict rows, global const uint* restrict starts,
                               global const uint* restrict columns, global const float* restrict values,
                               const uint row_count, global float* restrict own) {
  const uint k = (uint)get_global_id(0);
  if (k >= row_count) return;
  float found = 0;
  for (uint i = starts[k]; i < starts[k + 1]; i++) {
    if (columns[i] == rows[k]) found = values[i];
  }
  own[rows[k]] = found;
}

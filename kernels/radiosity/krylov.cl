// What conjugate gradients and GMRES are made of, for T = I - rho F - tau F' and vectors of a real4 a side (red, green,
// blue, w), each column with scalars of its own.
#include "lib/chunk.h"
#include "radiosity/wide_sum.h"
#include "shared/radiosity_types.h"

#ifndef HR_LOCAL_SIZE
#define HR_LOCAL_SIZE 64
#endif

// y = T x, from incident = F x. Launch: count items.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void radiosity_apply(
    global const float4* restrict reflectance, global const float4* restrict transmittance,
    global const wide4* restrict incident, global const real4* restrict x, const uint count, global real4* restrict y) {
  const uint s = (uint)get_global_id(0);
  if (s >= count) return;
  wide4 sum = wide_add_scaled(wide_of(x[s]), -real4_of(reflectance[s]), incident[s]);
  y[s] = wide_value(wide_add_scaled(sum, -real4_of(transmittance[s]), incident[s ^ 1u]));
}

// partials[g] = sum of weights x y over chunk g, in order. Launch: G items.
kernel void radiosity_dot(global const real4* restrict x, global const real4* restrict y,
                          global const real4* restrict weights, const uint count, global real4* restrict partials) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint end = chunk_begin(count, g + 1, groups);
  real4 sum = (real4)(0);
  for (uint s = chunk_begin(count, g, groups); s < end; s++) sum += weights[s] * x[s] * y[s];
  partials[g] = sum;
}

// y = a x + b y, columns apart. Launch: count items.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void radiosity_combine(const real4 a,
                                                                                         global const real4* x,
                                                                                         const real4 b, global real4* y,
                                                                                         const uint count) {
  const uint s = (uint)get_global_id(0);
  if (s >= count) return;
  y[s] = a * x[s] + b * y[s];
}

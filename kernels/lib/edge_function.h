// On which side of a triangle's edges the origin of the plane lies, where rounding leaves it open.
#ifndef HR_LIB_EDGE_FUNCTION_H
#define HR_LIB_EDGE_FUNCTION_H

#include "lib/accel_layout.h"
#include "lib/vec.h"

// Twice the area of the triangle (0, p, q) in the sheared plane: its sign is exact unless it lies below 2^-48 of the
// products (or these below the normal range) and is zero then. The products' rounding errors by fma (Dekker 1971).
static inline real exact_edge_function(real px, real py, real qx, real qy) {
#pragma OPENCL FP_CONTRACT OFF
  const real a = px * qy, b = py * qx;
  return (a - b) + (fma(px, qy, -a) - fma(py, qx, -b));
}

#if HR_EXPLICIT_VECTORS

static inline float16 exact_edge_function16(float16 px, float16 py, float16 qx, float16 qy) {
#pragma OPENCL FP_CONTRACT OFF
  const float16 a = px * qy, b = py * qx;
  return (a - b) + (fma(px, qy, -a) - fma(py, qx, -b));
}

static inline int16 all_of_one_sign16(float16 a, float16 b, float16 c) {
  return (min(min(a, b), c) >= 0.0f) | (max(max(a, b), c) <= 0.0f);
}

#endif

#endif

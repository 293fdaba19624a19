// Sums of products that a residual is made of: in double where `real` is double, else in float-float
// (lib/double_float.h has the same for scalars), so that an error bound from them stays meaningful on devices without
// double.
#ifndef HR_RADIOSITY_WIDE_SUM_H
#define HR_RADIOSITY_WIDE_SUM_H

#include "lib/vec.h"

static inline real4 real4_of(float4 a) { return (real4)((real)a.x, (real)a.y, (real)a.z, (real)a.w); }

#ifdef HR_DOUBLE

typedef double4 wide4;

static inline wide4 wide_of(real4 a) { return a; }
static inline real4 wide_value(wide4 a) { return a; }
static inline wide4 wide_add_product(wide4 sum, real4 a, real4 b) { return sum + a * b; }
static inline wide4 wide_add_scaled(wide4 sum, real4 a, wide4 b) { return sum + a * b; }
static inline real wide_sum_columns(wide4 a) { return (a.x + a.y) + (a.z + a.w); }

#else

// Four unevaluated sums high + low with |low| <= ulp(high) / 2.
typedef struct wide4 {
  float4 high, low;
} wide4;

static inline wide4 wide_of(real4 a) {
  wide4 result;
  result.high = a;
  result.low = (float4)(0);
  return result;
}

static inline real4 wide_value(wide4 a) { return a.high; }

// Relative error below 3 u^2 + 13 u^3, u = 2^-24 (Joldes, Muller, Popescu 2017, algorithm 6).
static inline wide4 wide_add(wide4 a, wide4 b) {
#pragma OPENCL FP_CONTRACT OFF
  const float4 s = a.high + b.high, sb = s - a.high;
  const float4 s_low = (a.high - (s - sb)) + (b.high - sb);
  const float4 t = a.low + b.low, tb = t - a.low;
  const float4 t_low = (a.low - (t - tb)) + (b.low - tb);
  const float4 c = s_low + t;
  const float4 v = s + c, v_low = c - (v - s);
  const float4 w = t_low + v_low;
  wide4 result;
  result.high = v + w;
  result.low = w - (result.high - v);
  return result;
}

// The product is exact but for underflow.
static inline wide4 wide_add_product(wide4 sum, real4 a, real4 b) {
#pragma OPENCL FP_CONTRACT OFF
  wide4 product;
  product.high = a * b;
  product.low = fma(a, b, -product.high);
  return wide_add(sum, product);
}

static inline wide4 wide_add_scaled(wide4 sum, real4 a, wide4 b) {
  return wide_add_product(wide_add_product(sum, a, b.high), a, b.low);
}

static inline real wide_sum_columns(wide4 a) {
  wide4 other;
  other.high = a.high.zwxy;
  other.low = a.low.zwxy;
  a = wide_add(a, other);
  other.high = a.high.yxwz;
  other.low = a.low.yxwz;
  return wide_value(wide_add(a, other)).x;
}

#endif

#endif

// Float-float arithmetic: a number is the unevaluated sum of two floats, (high, low) with |low| <= ulp(high) / 2. For
// devices without double. Error bounds: Joldes, Muller, Popescu 2017, "Tight and rigorous error bounds for basic
// building blocks of double-word arithmetic"; all below 10 * 2^-48.
#ifndef HR_LIB_DOUBLE_FLOAT_H
#define HR_LIB_DOUBLE_FLOAT_H

#include "lib/divide.h"

// The exact sum of two floats with |a| >= |b| or a = 0 (Dekker 1971).
static inline float2 quick_two_sum(float a, float b) {
#pragma OPENCL FP_CONTRACT OFF
  const float s = a + b;
  return (float2)(s, b - (s - a));
}

// The exact sum of any two floats (Knuth, The Art of Computer Programming, vol. 2, 4.2.2).
static inline float2 two_sum(float a, float b) {
#pragma OPENCL FP_CONTRACT OFF
  const float s = a + b, bb = s - a;
  return (float2)(s, (a - (s - bb)) + (b - bb));
}

// The exact product, where its low part does not underflow.
static inline float2 two_product(float a, float b) {
#pragma OPENCL FP_CONTRACT OFF
  const float p = a * b;
  return (float2)(p, fma(a, b, -p));
}

// Algorithm 6 of the paper: relative error below 3 u^2 + 13 u^3, u = 2^-24.
static inline float2 df_add(float2 a, float2 b) {
#pragma OPENCL FP_CONTRACT OFF
  const float2 s = two_sum(a.x, b.x), t = two_sum(a.y, b.y);
  const float2 v = quick_two_sum(s.x, s.y + t.x);
  return quick_two_sum(v.x, t.y + v.y);
}

// Algorithm 12: relative error below 5 u^2.
static inline float2 df_mul(float2 a, float2 b) {
#pragma OPENCL FP_CONTRACT OFF
  const float2 p = two_product(a.x, b.x);
  const float low = fma(a.x, b.y, fma(a.y, b.x, a.y * b.y));
  return quick_two_sum(p.x, p.y + low);
}

// One Newton step after a division of the high parts, which need not be rounded correctly.
static inline float2 df_div(float2 a, float2 b) {
#pragma OPENCL FP_CONTRACT OFF
  const float q = (float)divide(a.x, b.x);
  const float2 rest = df_add(a, -df_mul(b, (float2)(q, 0.0f)));
  const float2 once = quick_two_sum(q, (float)divide(rest.x, b.x));
  const float2 rest2 = df_add(a, -df_mul(b, once));
  return df_add(once, (float2)((float)divide(rest2.x, b.x), 0.0f));
}

#endif

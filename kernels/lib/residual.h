// What rounding leaves out of sums, differences and products, exactly, where nothing underflows; and what is computed
// with it.
#ifndef HR_LIB_RESIDUAL_H
#define HR_LIB_RESIDUAL_H

#include "lib/vec.h"

// What a - b = difference + rest has rounded off (Knuth 1969, TwoSum).
static inline real3 rest_of_difference(real3 a, real3 b, real3 difference) {
#pragma OPENCL FP_CONTRACT OFF
  const real3 minus_b = difference - a;
  return (a - (difference - minus_b)) - (b + minus_b);
}

static inline real rest_of_sum(real a, real b, real sum) {
#pragma OPENCL FP_CONTRACT OFF
  const real b_there = sum - a;
  return (a - (sum - b_there)) + (b - b_there);
}

// a b - c d, within 1.5 ulps (Kahan; Jeannerod, Louvet, Muller 2013).
static inline real difference_of_products(real a, real b, real c, real d) {
#pragma OPENCL FP_CONTRACT OFF
  const real cd = c * d;
  return fma(a, b, -cd) - fma(c, d, -cd);
}

// A vector of twice the digits: high + low, where low is small beside the terms that high is made of.
typedef struct LongReal3 {
  real3 high, low;
} LongReal3;

static inline LongReal3 long_difference(real3 a, real3 b) {
#pragma OPENCL FP_CONTRACT OFF
  LongReal3 d;
  d.high = a - b;
  d.low = rest_of_difference(a, b, d.high);
  return d;
}

// Products of two low parts are left out.
static inline LongReal3 long_cross(LongReal3 a, LongReal3 b) {
#pragma OPENCL FP_CONTRACT OFF
  const real3 a1 = a.high.yzx, b1 = b.high.zxy, a2 = a.high.zxy, b2 = b.high.yzx;
  const real3 p = a1 * b1, q = a2 * b2;
  const real3 rests = fma(a1, b1, -p) - fma(a2, b2, -q);
  LongReal3 n;
  n.high = p - q;
  n.low = rest_of_difference(p, q, n.high) +
          (rests + ((a1 * b.low.zxy + a.low.yzx * b1) - (a2 * b.low.yzx + a.low.zxy * b2)));
  return n;
}

// Rounded once but for 2^-44 of the terms (Ogita, Rump, Oishi 2005, "Accurate Sum and Dot Product", Dot2).
static inline real long_dot(LongReal3 a, LongReal3 b) {
#pragma OPENCL FP_CONTRACT OFF
  const real3 p = a.high * b.high;
  const real3 rest = fma(a.high, b.high, -p) + (a.high * b.low + a.low * b.high);
  const real xy = p.x + p.y, sum = xy + p.z;
  return sum + ((rest_of_sum(p.x, p.y, xy) + rest_of_sum(xy, p.z, sum)) + (rest.x + rest.y + rest.z));
}

#endif

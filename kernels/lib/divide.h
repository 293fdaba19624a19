// Divide and square root. OpenCL lets a device err by 2.5 and 3 ulps; in strict builds they are rounded correctly on
// every device: by its own instructions where it promises so, else in double, which is wide enough for the second
// rounding to be harmless (Figueroa 1995, "When is double rounding innocuous?"), else by fused multiply-adds.
#ifndef HR_LIB_DIVIDE_H
#define HR_LIB_DIVIDE_H

#include "shared/scalar.h"

#if defined(HR_STRICT) && !defined(HR_ROUNDS_DIVIDE) && !defined(HR_DOUBLE) /* double always is */
#define HR_OWN_DIVIDE 1
#else
#define HR_OWN_DIVIDE 0
#endif

#if !HR_OWN_DIVIDE

static inline real divide(real a, real b) { return a / b; }
static inline real square_root(real a) { return sqrt(a); }

#elif defined(cl_khr_fp64) && !defined(HR_WITHOUT_DOUBLE)
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

static inline real divide(real a, real b) { return (real)((double)a / (double)b); }
static inline real square_root(real a) { return (real)sqrt((double)a); }

#else

#define HR_EXPONENT_BITS 0x7f800000u

static inline bool is_normal_real(real a) {
  const uint exponent = as_uint(a) & HR_EXPONENT_BITS;
  return exponent != 0 && exponent != HR_EXPONENT_BITS;
}

static inline int exponent_of(real a) { return (int)((as_uint(a) & HR_EXPONENT_BITS) >> 23) - 127; }

// a without its exponent, in [1, 2), signed.
static inline real mantissa_of(real a) { return as_float((as_uint(a) & ~HR_EXPONENT_BITS) | 0x3f800000u); }

// Markstein 1990, "Computation of elementary functions on the IBM RISC System/6000 processor": from a reciprocal that
// is right to the last bit, one step with an exact remainder gives the quotient. Quotients below the normal range are
// rounded twice.
static inline real divide(real a, real b) {
#pragma OPENCL FP_CONTRACT OFF
  if (!is_normal_real(a) || !is_normal_real(b)) return a / b;
  const real m = mantissa_of(a), n = mantissa_of(b);
  real y = 1 / n;
  y = fma(fma(-n, y, REAL(1.0)), y, y);
  y = fma(fma(-n, y, REAL(1.0)), y, y);
  real q = m * y;
  q = fma(fma(-n, q, m), y, q);
  q = fma(fma(-n, q, m), y, q);
  return ldexp(q, exponent_of(a) - exponent_of(b));
}

// The same for square roots: g converges to the root, h to half its reciprocal.
static inline real square_root(real a) {
#pragma OPENCL FP_CONTRACT OFF
  if (!is_normal_real(a) || a < 0) return sqrt(a);
  const int half_exponent = exponent_of(a) >> 1;
  const real m = ldexp(mantissa_of(a), exponent_of(a) - 2 * half_exponent);  // in [1, 4)
  const real y = 1 / sqrt(m);
  real g = m * y, h = REAL(0.5) * y;
  const real r = fma(-g, h, REAL(0.5));
  g = fma(g, r, g);
  h = fma(h, r, h);
  g = fma(fma(-g, g, m), h, g);
  g = fma(fma(-g, g, m), h, g);
  return ldexp(g, half_exponent);
}

#endif

static inline real3 divide3(real3 a, real b) {
#if HR_OWN_DIVIDE
  return (real3)(divide(a.x, b), divide(a.y, b), divide(a.z, b));
#else
  return a / b;
#endif
}

#endif

// Elementary functions. Strict builds use these polynomials of + - * / and integers, which give the same bits in scalar
// and vector code; fast builds take the device's own.
#ifndef HR_LIB_MATH_H
#define HR_LIB_MATH_H

#include "lib/vec.h"

// log2(x) for positive normal x: x = 2^e m with m in [sqrt(1/2), sqrt(2)), log m = 2 artanh((m-1)/(m+1)) as a series
// whose first dropped term is below 2^-28 relative.
static inline float strict_log2(float x) {
  const int bits = as_int(x);
  int exponent = (bits >> 23) - 127;
  float m = as_float((bits & 0x007fffff) | 0x3f800000);
  if (m > 1.41421356f) {
    m = 0.5f * m;
    exponent += 1;
  }
  const float s = divide(m - 1.0f, m + 1.0f);
  const float s2 = s * s;
  const float series = 1.0f + s2 * (1.0f / 3 + s2 * (1.0f / 5 + s2 * (1.0f / 7 + s2 * (1.0f / 9))));
  return (float)exponent + 2.88539008f * s * series;
}

// 2^x; zero below the normal range. Taylor series of exp on [-ln2/2, ln2/2], first dropped term below 2^-27.
static inline float strict_exp2(float x) {
  if (x < -126.0f) return 0.0f;
  const float whole = floor(x + 0.5f);
  const float r = (x - whole) * 0.693147181f;
  const float series =
      1.0f + r * (1.0f + r * (0.5f + r * (1.0f / 6 +
                                          r * (1.0f / 24 + r * (1.0f / 120 + r * (1.0f / 720 + r * (1.0f / 5040)))))));
  const int exponent = min((int)whole, 127);
  return series * as_float((exponent + 127) << 23);
}

#if defined(HR_STRICT) && !defined(HR_DOUBLE)
#define HR_OWN_FUNCTIONS 1
#else
#define HR_OWN_FUNCTIONS 0 /* double builds have no polynomials of their own: their bits are the device's */
#endif

// x^y for x in [0, 1] and y >= 0, with 0^0 = 1: a cosine lobe.
static inline real cosine_power(real x, real y) {
#if HR_OWN_FUNCTIONS
  if (y <= 0) return 1;
  if (x <= REAL(1.1754944e-38)) return 0;
  return strict_exp2(y * strict_log2(x));
#else
  return y <= 0 ? REAL(1.0) : pow(x, y);
#endif
}

// sin and cos of 2 pi u for u in [0, 1]. Taylor series on an octant, first dropped term below 2^-25.
static inline real2 sincos_turn(real u) {
#if HR_OWN_FUNCTIONS
  const real quarter = floor(4 * u + REAL(0.5));
  const real a = (4 * u - quarter) * REAL(1.5707963267948966);  // in [-pi/4, pi/4]
  const real a2 = a * a;
  const real s =
      a * (1 + a2 * (-REAL(1.0) / 6 + a2 * (REAL(1.0) / 120 + a2 * (-REAL(1.0) / 5040 + a2 * (REAL(1.0) / 362880)))));
  const real c = 1 + a2 * (-REAL(0.5) + a2 * (REAL(1.0) / 24 + a2 * (-REAL(1.0) / 720 + a2 * (REAL(1.0) / 40320))));
  const int q = (int)quarter & 3;
  return q == 0 ? (real2)(s, c) : (q == 1 ? (real2)(c, -s) : (q == 2 ? (real2)(-s, -c) : (real2)(-c, s)));
#else
  const real a = u * REAL(6.283185307179586);
  return (real2)(sin(a), cos(a));  // no sincos(): Oclgrind loses its pointer to private memory
#endif
}

#endif

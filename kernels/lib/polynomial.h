// Polynomials of one variable on [-1, 1] with a bound of their error: made from a tape along a ray, and searched for
// their smallest root. The same sources in several arithmetics: float (_f), and as HR_WIDE(name) one that is more
// precise than `real`: double (_d), float-float (_q) where there is no double or HR_WITHOUT_DOUBLE is defined, and in
// double builds double-double (_p).
//
// The error bound. A polynomial p~ stands for all p with sum |p_k - p~_k| <= error. On [-1, 1] that bounds the values,
// the coefficients of the Bernstein form, and what a term that is left out can add. With u the unit of rounding and
// |.| the sum of the coefficients' absolute values:
//   sum      E(a + b) = E(a) + E(b) + u |a + b|
//   product  E(a b)   = |a| E(b) + |b| E(a) + E(a) E(b) + (min(degrees) + 2) u |a| |b|
// (Higham 2002, (3.4) and 3.5), each with what may underflow, and raised by 64 units of float or double for the
// rounding of the bound itself.
#ifndef HR_LIB_POLYNOMIAL_H
#define HR_LIB_POLYNOMIAL_H

#include "lib/divide.h"
#include "lib/pair.h"
#include "lib/vec.h"
#include "shared/polynomial_types.h"
#include "shared/scene_types.h"

#ifdef cl_khr_fp64
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#endif

#define HR_UNIT_F 5.9604645e-8f /* 2^-24 */
#define HR_COEFFICIENTS (HR_MAX_DEGREE + 1)

// Places in [-1, 1] are counted in steps of 2^-39 from -1: exact in double and float-float, and in float down to the
// width that its search stops at.
#define HR_PLACE_BITS 40
#define HR_PLACE_END (1UL << HR_PLACE_BITS)

#define HR_FIND_NONE 0u    /* no root from the start of the search to its end */
#define HR_FIND_ROOT 1u    /* exactly one in [lo, hi]: signs at both ends certain and opposite */
#define HR_FIND_CLUSTER 2u /* at least one in [lo, hi], by the signs at the ends; perhaps three, or a triple one */
#define HR_FIND_OPEN 3u    /* perhaps roots in [lo, hi]: nearer to zero there than the error */

#define HR_PART_EMPTY 0u
#define HR_PART_ONE 1u
#define HR_PART_SPLIT 2u
#define HR_PART_NOISE 3u /* everywhere below the error: no use in dividing */

// Intervals that one search may look at. Those of the tests' hardest polynomials are below 200.
#define HR_SEARCH_LIMIT 512

#define HR_N(name) name##_f
#define HR_NUM float
#define HR_ERR float
#define HR_UNIT HR_UNIT_F
#define HR_TINY 6.1e-36f      /* 2^-117: 512 results of a product below the normal range */
#define HR_ROUND_UP 1.000004f /* 1 + 2^-18 */
#define HR_STEPS 16           /* halvings of [-1, 1] at most */
#define HR_PAIR_ERROR HR_UNIT /* of a constant, relative */
#define HR_OF(x) ((float)(x))
#define HR_OF_ERR(x) ((float)(x))
#define HR_SUM_OF(high, low) ((high) + (low))
#define HR_OF_PAIR(high, low) ((high) + (low))
#define HR_ADD(a, b) ((a) + (b))
#define HR_MUL(a, b) ((a) * (b))
#define HR_FMA(a, b, c) fma(a, b, c)
#define HR_DIV(a, b) ((float)divide(a, b))
#define HR_OF_SIGNED(x) (x)
#define HR_LDEXP(a, n) ldexp(a, n)
#define HR_HIGH(a) (a)
#include "lib/poly_all.def"

#ifdef HR_DOUBLE
#define HR_WIDE(name) name##_p
#define HR_WIDE_NUM double2
#define HR_WIDE_ERR double
#define HR_WIDE_OF(x) ((double2)((double)(x), 0.0))
#define HR_WIDE_HIGH(a) ((a).x)
#define HR_WIDE_REAL(a) ((a).x + (a).y)
#define HR_WIDE_LINEAR(a, b, c) dd_add(dd_mul(a, b), c)
#define HR_WIDE_QUOTIENT(a, b) dd_div(a, b)
#define HR_N(name) name##_p
#define HR_NUM double2
#define HR_ERR double
#define HR_UNIT 1.3e-31 /* 10 * 2^-106 */
#define HR_TINY 1e-290
#define HR_ROUND_UP 1.00000000000001
#define HR_STEPS 40
#define HR_PAIR_ERROR 0
#define HR_OF(x) ((double2)((double)(x), 0.0))
#define HR_OF_ERR(x) ((double)(x))
#define HR_SUM_OF(high, low) ((double2)((double)(high) + (double)(low), 0.0))
#define HR_OF_PAIR(high, low) HR_SUM_OF(high, low)
#define HR_ADD(a, b) dd_add(a, b)
#define HR_MUL(a, b) dd_mul(a, b)
#define HR_FMA(a, b, c) dd_add(dd_mul(a, b), c)
#define HR_DIV(a, b) dd_div(a, b)
#define HR_OF_SIGNED(x) ((double2)(x, 0.0))
#define HR_LDEXP(a, n) ldexp(a, n)
#define HR_HIGH(a) ((a).x)
#include "lib/poly_all.def"
#elif defined(cl_khr_fp64) && !defined(HR_WITHOUT_DOUBLE)
#define HR_WIDE(name) name##_d
#define HR_WIDE_NUM double
#define HR_WIDE_ERR double
#define HR_WIDE_OF(x) ((double)(x))
#define HR_WIDE_HIGH(a) (a)
#define HR_WIDE_REAL(a) ((real)(a))
#define HR_WIDE_LINEAR(a, b, c) fma(a, b, c)
#define HR_WIDE_QUOTIENT(a, b) ((a) / (b))
#define HR_N(name) name##_d
#define HR_NUM double
#define HR_ERR double
#define HR_UNIT 1.1102230246251566e-16 /* 2^-53 */
#define HR_TINY 1e-300
#define HR_ROUND_UP 1.00000000000001 /* 1 + 90 units */
#define HR_STEPS 40
#define HR_PAIR_ERROR 0
#define HR_OF(x) ((double)(x))
#define HR_OF_ERR(x) ((double)(x))
#define HR_SUM_OF(high, low) ((double)(high) + (double)(low))
#define HR_OF_PAIR(high, low) ((double)(high) + (double)(low))
#define HR_ADD(a, b) ((a) + (b))
#define HR_MUL(a, b) ((a) * (b))
#define HR_FMA(a, b, c) fma(a, b, c)
#define HR_DIV(a, b) ((a) / (b))
#define HR_OF_SIGNED(x) (x)
#define HR_LDEXP(a, n) ldexp(a, n)
#define HR_HIGH(a) (a)
#include "lib/poly_all.def"
#else
#define HR_WIDE(name) name##_q
#define HR_WIDE_NUM float2
#define HR_WIDE_ERR float
#define HR_WIDE_OF(x) ((float2)((float)(x), 0.0f))
#define HR_WIDE_HIGH(a) ((a).x)
#define HR_WIDE_REAL(a) ((real)(a).x + (real)(a).y)
#define HR_WIDE_LINEAR(a, b, c) df_add(df_mul(a, b), c)
#define HR_WIDE_QUOTIENT(a, b) df_div(a, b)
#define HR_N(name) name##_q
#define HR_NUM float2
#define HR_ERR float
#define HR_UNIT 3.6e-14f /* 10 * 2^-48 */
#define HR_TINY 6.1e-36f
#define HR_ROUND_UP 1.000004f
#define HR_STEPS 40
#define HR_PAIR_ERROR 0
#define HR_OF(x) ((float2)((float)(x), 0.0f))
#define HR_OF_ERR(x) ((float)(x))
#define HR_SUM_OF(high, low) df_quick_two_sum(high, low)
#define HR_OF_PAIR(high, low) ((float2)(high, low))
#define HR_ADD(a, b) df_add(a, b)
#define HR_MUL(a, b) df_mul(a, b)
#define HR_FMA(a, b, c) df_add(df_mul(a, b), c)
#define HR_DIV(a, b) df_div(a, b)
#define HR_OF_SIGNED(x) ((float2)(x, 0.0f))
#define HR_LDEXP(a, n) ldexp(a, n)
#define HR_HIGH(a) ((a).x)
#include "lib/poly_all.def"
#endif

#endif

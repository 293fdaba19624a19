// Small vector algebra over `real`, written out so that strict builds round the same everywhere.
#ifndef HR_LIB_VEC_H
#define HR_LIB_VEC_H

#include "lib/divide.h"
#include "shared/scalar.h"

#ifdef HR_STRICT
#pragma OPENCL FP_CONTRACT OFF
#endif

// Half the distance from 1 to the next real: the relative error of one rounded operation.
#ifdef HR_DOUBLE
#define HR_HALF_ULP 1.1102230246251565e-16
#else
#define HR_HALF_ULP 5.9604644775390625e-8f
#endif

// Bound of the relative error after n rounded operations (Higham 2002, lemma 3.1).
#define HR_GAMMA(n) ((n)*HR_HALF_ULP / (1 - (n)*HR_HALF_ULP))

static inline real dot3(real3 a, real3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

static inline real3 cross3(real3 a, real3 b) {
  return (real3)(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static inline real3 normalize3(real3 v) { return divide3(v, square_root(dot3(v, v))); }

// Unit normal of a triangle's edges, scaled first so that the square of a tiny area does not underflow.
static inline real3 normal_of_edges(real3 e1, real3 e2) {
  const real3 a = fabs(e1), b = fabs(e2);
  const real scale = divide(1, max(max(max(a.x, a.y), a.z), max(max(b.x, b.y), b.z)));
  return normalize3(cross3(e1 * scale, e2 * scale));
}

static inline real max_component(real3 v) { return max(max(v.x, v.y), v.z); }

// v's component along axis k in {0, 1, 2}.
static inline real pick(real3 v, int k) { return k == 0 ? v.x : (k == 1 ? v.y : v.z); }

// A float4 of the scene or of the launch parameters, as a position or colour.
static inline real3 param3(float4 v) { return (real3)(v.x, v.y, v.z); }

static inline real3 xyz(real4 v) { return v.xyz; }

static inline real4 vec4(real3 v, real w) { return (real4)(v.x, v.y, v.z, w); }

#endif

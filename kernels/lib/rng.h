// Counter-based random numbers: a hash of (pixel, sample, ordinal of the ray segment, dimension), so that the order in
// which slots run never changes an image. host/base/rng.hpp gives the same bits.
#ifndef HR_LIB_RNG_H
#define HR_LIB_RNG_H

#include "lib/vec.h"

#define HR_DIMENSION_PIXEL 0u
#define HR_DIMENSION_FIRST_LIGHT 1u
#define HR_DIMENSION_GATHER 0x80000000u  // beyond those of any light's samples

// pcg4d of Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020.
static inline uint4 rng_hash(uint4 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  v ^= v >> 16;
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  return v;
}

// 24 random bits as a real in [0, 1), exact in single precision.
static inline real rng_unit(uint bits) { return (real)(bits >> 8) * REAL(5.9604644775390625e-8); }

// First dimension of Sobol's sequence: van der Corput's, the bits of the index reversed. (A loop: some simulators lack
// the instruction that compilers make of the shift-and-mask form.)
static inline uint rng_sobol1(uint index) {
  uint result = 0;
  for (uint v = 1u << 31; index != 0; index >>= 1, v >>= 1) {
    if (index & 1u) result |= v;
  }
  return result;
}

// Second dimension of Sobol's sequence (Kollig and Keller 2002).
static inline uint rng_sobol2(uint index) {
  uint result = 0;
  for (uint v = 1u << 31; index != 0; index >>= 1, v ^= v >> 1) {
    if (index & 1u) result ^= v;
  }
  return result;
}

// Place of a sample inside its pixel, [0,1)^2: the centre if it is the only one, else a (0,2)-sequence scrambled per
// pixel, whose every prefix is well spread.
static inline real2 rng_pixel_offset(uint pixel, uint sample, uint samples, uint seed_key) {
  if (samples == 1) return (real2)(REAL(0.5), REAL(0.5));
  const uint4 scramble = rng_hash((uint4)(pixel, 0, 0, HR_DIMENSION_PIXEL ^ seed_key));
  return (real2)(rng_unit(rng_sobol1(sample) ^ scramble.x), rng_unit(rng_sobol2(sample) ^ scramble.y));
}

#endif

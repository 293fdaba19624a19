// The counter-based random numbers of kernels/lib/rng.h on the host, same bits: a hash of (pixel, sample, ordinal of
// the ray segment, dimension).
#pragma once

#include <array>
#include <cstdint>

#include "host/base/vec.hpp"

namespace hemiray {

/// Four words that are hashed together, and what comes out.
using RngWords = std::array<std::uint32_t, 4>;

/// Dimensions of a random number (its fourth word, xor the seed's key).
inline constexpr std::uint32_t kDimensionPixel = 0;
inline constexpr std::uint32_t kDimensionFirstLight = 1;

/// pcg4d of Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020.
constexpr RngWords rng_hash(RngWords v) {
  for (std::uint32_t& word : v) word = word * 1664525U + 1013904223U;
  v[0] += v[1] * v[3];
  v[1] += v[2] * v[0];
  v[2] += v[0] * v[1];
  v[3] += v[1] * v[2];
  for (std::uint32_t& word : v) word ^= word >> 16U;
  v[0] += v[1] * v[3];
  v[1] += v[2] * v[0];
  v[2] += v[0] * v[1];
  v[3] += v[1] * v[2];
  return v;
}

/// 24 random bits as a float in [0, 1), exact.
constexpr float rng_unit(std::uint32_t bits) { return static_cast<float>(bits >> 8U) * 0x1p-24F; }

/// First dimension of Sobol's sequence: van der Corput's, the bits of the index reversed.
constexpr std::uint32_t rng_sobol1(std::uint32_t index) {
  std::uint32_t result = 0;
  for (std::uint32_t v = 1U << 31U; index != 0; index >>= 1U, v >>= 1U) {
    if ((index & 1U) != 0) result |= v;
  }
  return result;
}

/// Second dimension of Sobol's sequence (Kollig and Keller 2002).
constexpr std::uint32_t rng_sobol2(std::uint32_t index) {
  std::uint32_t result = 0;
  for (std::uint32_t v = 1U << 31U; index != 0; index >>= 1U, v ^= v >> 1U) {
    if ((index & 1U) != 0) result ^= v;
  }
  return result;
}

/// Place of sample `sample` of `samples` inside its pixel, [0,1)^2: the centre if it is the only one, else a
/// (0,2)-sequence scrambled per pixel. `seed_key` is the seed times 0x9E3779B9.
inline Vec2 rng_pixel_offset(std::uint32_t pixel, std::uint32_t sample, std::uint32_t samples, std::uint32_t seed_key) {
  if (samples == 1) return Vec2(0.5F);
  const RngWords scramble = rng_hash({pixel, 0, 0, kDimensionPixel ^ seed_key});
  return {rng_unit(rng_sobol1(sample) ^ scramble[0]), rng_unit(rng_sobol2(sample) ^ scramble[1])};
}

}  // namespace hemiray

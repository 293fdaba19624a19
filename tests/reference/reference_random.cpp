// pcg4d and the scrambled (0,2)-sequence.
#include "tests/reference/reference_random.hpp"

namespace hemiray::reference {

namespace {

constexpr std::uint32_t kGoldenRatio = 0x9E3779B9U;
constexpr double kTwoPowMinus24 = 1.0 / 16777216.0;

double unit_double(std::uint32_t bits) { return static_cast<double>(bits >> 8U) * kTwoPowMinus24; }

void add_products(std::array<std::uint32_t, 4>& v) {
  v[0] += v[1] * v[3];
  v[1] += v[2] * v[0];
  v[2] += v[0] * v[1];
  v[3] += v[1] * v[2];
}

std::array<std::uint32_t, 4> hash_of(const RandomKey& key, std::uint32_t dimension) {
  return pcg4d({key.pixel, key.sample, key.ordinal, dimension ^ (key.seed * kGoldenRatio)});
}

std::uint32_t reversed_bits(std::uint32_t value) {
  std::uint32_t result = 0;
  for (int bit = 0; bit < 32; ++bit) {
    result = (result << 1U) | (value & 1U);
    value >>= 1U;
  }
  return result;
}

std::uint32_t sobol_second_dimension(std::uint32_t index) {
  std::uint32_t result = 0;
  for (std::uint32_t v = 1U << 31U; index != 0; index >>= 1U, v ^= v >> 1U) {
    if ((index & 1U) != 0) result ^= v;
  }
  return result;
}

}  // namespace

std::array<std::uint32_t, 4> pcg4d(std::array<std::uint32_t, 4> v) {
  for (std::uint32_t& word : v) word = word * 1664525U + 1013904223U;
  add_products(v);
  for (std::uint32_t& word : v) word ^= word >> 16U;
  add_products(v);
  return v;
}

DVec3 random3(const RandomKey& key, std::uint32_t dimension) {
  const auto words = hash_of(key, dimension);
  return {unit_double(words[0]), unit_double(words[1]), unit_double(words[2])};
}

glm::dvec2 pixel_jitter(const RandomKey& key, int samples_per_pixel) {
  if (samples_per_pixel == 1) return {0.5, 0.5};
  // One scramble a pixel: all its samples share it, so they stay stratified.
  const auto scramble = hash_of({key.pixel, 0, 0, key.seed}, 0);
  return {unit_double(reversed_bits(key.sample) ^ scramble[0]),
          unit_double(sobol_second_dimension(key.sample) ^ scramble[1])};
}

}  // namespace hemiray::reference

// The random numbers of the reference tracer: pcg4d (Jarzynski and Olano 2020) and the pixel filter's sample positions.
#pragma once

#include <array>
#include <cstdint>

#include "host/base/vec.hpp"

namespace hemiray::reference {

/// What a random number is keyed by; `ordinal` counts the ray segments of one pixel sample in the order they are
/// traced.
struct RandomKey {
  std::uint32_t pixel = 0;
  std::uint32_t sample = 0;
  std::uint32_t ordinal = 0;
  std::uint32_t seed = 0;
};

/// The hash itself: four words in, four words out.
std::array<std::uint32_t, 4> pcg4d(std::array<std::uint32_t, 4> v);

/// Three uniform numbers in [0,1) with 24 bits each.
DVec3 random3(const RandomKey& key, std::uint32_t dimension);

/// Where sample `key.sample` of `samples_per_pixel` lies inside its pixel, [0,1)^2: the centre for one sample, a
/// scrambled (0,2)-sequence otherwise.
glm::dvec2 pixel_jitter(const RandomKey& key, int samples_per_pixel);

}  // namespace hemiray::reference

// Sorts the rays of a wave by where they start and which way they go.
#pragma once

#include <cstdint>

#include "host/gpu/parallel.hpp"
#include "host/gpu/program.hpp"
#include "shared/scalar.h"

namespace hemiray {

class RaySorter {
 public:
  /// For queues of `slots` slots, in a scene with bounds lo, hi [m].
  RaySorter(Context& context, Parallel& parallel, std::uint32_t slots, const shared::float4& lo,
            const shared::float4& hi);

  /// Puts queue[first] .. queue[first + count - 1] into the order of their rays; `rays` are the arguments
  /// path_ray_origin and path_ray_direction. Throws DeviceError.
  void sort(const Buffer<std::uint32_t>& queue, std::uint32_t first, std::uint32_t count, const Arguments& rays);

 private:
  Context* context_;
  Parallel* parallel_;
  Program program_;
  std::uint32_t index_bits_;
  shared::float4 lo_, scale_;
  Buffer<std::uint64_t> keys_, keys_other_;
};

}  // namespace hemiray

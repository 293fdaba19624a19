// Parallel primitives that every effect uses: prefix sum and radix sort.
#pragma once

#include <cstdint>

#include "host/gpu/buffer.hpp"
#include "host/gpu/context.hpp"
#include "host/gpu/program.hpp"

namespace hemiray {

class Parallel {
 public:
  explicit Parallel(Context& context);

  /// values[0..count) becomes its exclusive prefix sum and values[count] the total; needs count + 1 elements.
  void exclusive_scan(Buffer<std::uint32_t>& values, std::uint32_t count);

  /// Sorts the first `count` keys ascending by their bits [first_bit, first_bit + bits); stable, so that a value in the
  /// low bits comes along. `scratch` has at least `count` elements; the arrays may have changed places afterwards.
  /// Launches 3 kernels per 11 bits and does not wait.
  void sort(Buffer<std::uint64_t>& keys, Buffer<std::uint64_t>& scratch, std::uint32_t count, unsigned first_bit,
            unsigned bits);

  [[nodiscard]] Program& program() { return program_; }

 private:
  Context* context_;
  Program program_;
  Buffer<std::uint32_t> counts_;  ///< of digits, by chunk
};

}  // namespace hemiray

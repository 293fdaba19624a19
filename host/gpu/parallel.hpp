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

  /// Sorts the first `count` keys ascending by their low `bits` bits, values along with them; stable. Launches
  /// 3 kernels per 8 bits; scratch of the arrays' size is taken and given back.
  void sort(Buffer<std::uint64_t>& keys, Buffer<std::uint32_t>& values, std::uint32_t count, unsigned bits);

  [[nodiscard]] Program& program() { return program_; }

 private:
  Context* context_;
  Program program_;
};

}  // namespace hemiray

// Parallel primitives that every effect uses: prefix sum and radix sort, each for work-items that keep to themselves
// (CPUs) and for work-groups (GPUs), as the device profile's sort_groups says. Both forms give the same.
#pragma once

#include <cstdint>

#include "host/gpu/buffer.hpp"
#include "host/gpu/context.hpp"
#include "host/gpu/program.hpp"

namespace hemiray {

/// Device memory that a Parallel holds [bytes].
std::uint64_t sort_bytes(const DeviceProfile& profile);

class Parallel {
 public:
  explicit Parallel(Context& context);

  /// values[0..count) becomes its exclusive prefix sum and values[count] the total; needs count + 1 elements.
  void exclusive_scan(Buffer<std::uint32_t>& values, std::uint32_t count);

  /// Sorts the first `count` keys ascending by their bits [first_bit, first_bit + bits); stable, so that a value in the
  /// low bits comes along. `scratch` has at least `count` elements; the arrays may have changed places afterwards.
  /// Launches 3 kernels per 11 bits, or per 8 where the profile has work-groups sort, and does not wait.
  void sort(Buffer<std::uint64_t>& keys, Buffer<std::uint64_t>& scratch, std::uint32_t count, unsigned first_bit,
            unsigned bits);

  [[nodiscard]] Program& program() { return program_; }

 private:
  [[nodiscard]] bool in_groups() const { return context_->profile().sort_groups > 0; }
  void launch_groups(const char* kernel, std::uint64_t groups, const Arguments& arguments);
  // One digit's pass, from the keys among its arguments to `out`.
  void sort_digit_by_items(const Arguments& digit, std::uint32_t radix, const Buffer<std::uint64_t>& out);
  void sort_digit_by_groups(const Arguments& digit, std::uint32_t radix, const Buffer<std::uint64_t>& out);

  Context* context_;
  Program program_;
  Buffer<std::uint32_t> counts_;  ///< of digits, by chunk
};

}  // namespace hemiray

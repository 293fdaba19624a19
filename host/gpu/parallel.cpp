#include "host/gpu/parallel.hpp"

#include <algorithm>
#include <utility>

namespace hemiray {
namespace {

constexpr unsigned kMaxDigitBits = 11;  // HR_MAX_RADIX of parallel/radix_sort.cl

}  // namespace

Parallel::Parallel(Context& context)
    : context_(&context),
      program_(context, "parallel", {"parallel/scan.cl", "parallel/radix_sort.cl"}, ProgramOptions{}),
      counts_(context, "sort counts", (std::size_t{1} << kMaxDigitBits) * context.profile().chunks + 1) {}

void Parallel::exclusive_scan(Buffer<std::uint32_t>& values, std::uint32_t count) {
  launch(*context_, program_.kernel("parallel_scan"), 1, arguments(arg("values", values), arg("count", count)));
}

void Parallel::sort(Buffer<std::uint64_t>& keys, Buffer<std::uint64_t>& scratch, std::uint32_t count,
                    unsigned first_bit, unsigned bits) {
  if (count < 2 || bits == 0) return;
  const std::uint32_t chunks = context_->profile().chunks;
  const unsigned passes = (bits + kMaxDigitBits - 1) / kMaxDigitBits;
  const unsigned digit_bits = (bits + passes - 1) / passes;
  for (unsigned done = 0; done < bits; done += digit_bits) {
    const std::uint32_t width = std::min(digit_bits, bits - done);
    const Arguments digit =
        arguments(arg("shift", std::uint32_t{first_bit + done}), arg("digit_bits", width), arg("count", count));
    launch(*context_, program_.kernel("sort_count_digits"), chunks,
           arguments(arg("keys", keys), arg("counts", counts_), digit));
    exclusive_scan(counts_, (1U << width) * chunks);
    launch(*context_, program_.kernel("sort_scatter"), chunks,
           arguments(arg("keys", keys), arg("keys_out", scratch), arg("offsets", counts_), digit));
    std::swap(keys, scratch);
  }
}

}  // namespace hemiray

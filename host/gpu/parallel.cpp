#include "host/gpu/parallel.hpp"

#include <algorithm>
#include <utility>

namespace hemiray {
namespace {

constexpr unsigned kDigitBits = 8;  // HR_RADIX of parallel/radix_sort.cl
constexpr std::uint32_t kRadix = 1U << kDigitBits;

}  // namespace

Parallel::Parallel(Context& context)
    : context_(&context),
      program_(context, "parallel", {"parallel/scan.cl", "parallel/radix_sort.cl"}, ProgramOptions{}) {}

void Parallel::exclusive_scan(Buffer<std::uint32_t>& values, std::uint32_t count) {
  launch(*context_, program_.kernel("parallel_scan"), 1, arguments(arg("values", values), arg("count", count)));
}

void Parallel::sort(Buffer<std::uint64_t>& keys, Buffer<std::uint32_t>& values, std::uint32_t count, unsigned bits) {
  if (count < 2) return;
  const std::uint32_t chunks = context_->profile().chunks;
  Buffer<std::uint64_t> keys_other(*context_, "sort keys", keys.size());
  Buffer<std::uint32_t> values_other(*context_, "sort values", values.size());
  Buffer<std::uint32_t> counts(*context_, "sort counts", std::size_t{kRadix} * chunks + 1);
  for (unsigned shift = 0; shift < bits; shift += kDigitBits) {
    launch(
        *context_, program_.kernel("sort_count_digits"), chunks,
        arguments(arg("keys", keys), arg("counts", counts), arg("shift", std::uint32_t{shift}), arg("count", count)));
    exclusive_scan(counts, kRadix * chunks);
    launch(*context_, program_.kernel("sort_scatter"), chunks,
           arguments(arg("keys", keys), arg("values", values), arg("keys_out", keys_other),
                     arg("values_out", values_other), arg("offsets", counts), arg("shift", std::uint32_t{shift}),
                     arg("count", count)));
    std::swap(keys, keys_other);
    std::swap(values, values_other);
  }
  context_->finish();  // the scratch must outlive the kernels
}

}  // namespace hemiray

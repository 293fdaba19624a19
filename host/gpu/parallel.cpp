#include "host/gpu/parallel.hpp"

#include <algorithm>
#include <utility>

namespace hemiray {
namespace {

constexpr unsigned kItemDigitBits = 11;  // HR_MAX_RADIX of parallel/radix_sort.cl
constexpr unsigned kGroupDigitBits = 8;  // HR_GROUP_RADIX of parallel/group_sort.cl

}  // namespace

std::uint64_t sort_bytes(const DeviceProfile& profile) {
  const std::uint64_t counts = profile.sort_groups > 0
                                   ? (std::uint64_t{1} << kGroupDigitBits) * (profile.sort_groups + 1)
                                   : (std::uint64_t{1} << kItemDigitBits) * profile.chunks + 1;
  return counts * sizeof(std::uint32_t);
}

Parallel::Parallel(Context& context)
    : context_(&context),
      program_(context, "parallel",
               {"parallel/scan.cl", in_groups() ? "parallel/group_sort.cl" : "parallel/radix_sort.cl"},
               ProgramOptions{}),
      counts_(context, "sort counts", sort_bytes(context.profile()) / sizeof(std::uint32_t)) {}

void Parallel::launch_groups(const char* kernel, std::uint64_t groups, const Arguments& arguments) {
  launch(*context_, program_.kernel(kernel), groups * context_->profile().local_size, arguments);
}

void Parallel::exclusive_scan(Buffer<std::uint32_t>& values, std::uint32_t count) {
  const Arguments array = arguments(arg("values", values), arg("count", count));
  if (in_groups()) {
    launch_groups("parallel_scan_rows", 1, array);
  } else {
    launch(*context_, program_.kernel("parallel_scan"), 1, array);
  }
}

void Parallel::sort(Buffer<std::uint64_t>& keys, Buffer<std::uint64_t>& scratch, std::uint32_t count,
                    unsigned first_bit, unsigned bits) {
  if (count < 2 || bits == 0) return;
  const unsigned most_bits = in_groups() ? kGroupDigitBits : kItemDigitBits;
  const unsigned passes = (bits + most_bits - 1) / most_bits;
  const unsigned digit_bits = (bits + passes - 1) / passes;
  for (unsigned done = 0; done < bits; done += digit_bits) {
    const std::uint32_t width = std::min(digit_bits, bits - done);
    const Arguments digit = arguments(arg("keys", keys), arg("shift", std::uint32_t{first_bit + done}),
                                      arg("digit_bits", width), arg("count", count));
    if (in_groups()) {
      sort_digit_by_groups(digit, 1U << width, scratch);
    } else {
      sort_digit_by_items(digit, 1U << width, scratch);
    }
    std::swap(keys, scratch);
  }
}

void Parallel::sort_digit_by_items(const Arguments& digit, std::uint32_t radix, const Buffer<std::uint64_t>& out) {
  const std::uint32_t chunks = context_->profile().chunks;
  launch(*context_, program_.kernel("sort_count_digits"), chunks, arguments(digit, arg("counts", counts_)));
  exclusive_scan(counts_, radix * chunks);
  launch(*context_, program_.kernel("sort_scatter"), chunks,
         arguments(digit, arg("keys_out", out), arg("offsets", counts_)));
}

void Parallel::sort_digit_by_groups(const Arguments& digit, std::uint32_t radix, const Buffer<std::uint64_t>& out) {
  const std::uint32_t groups = context_->profile().sort_groups;
  launch_groups("group_sort_count_digits", groups, arguments(digit, arg("counts", counts_)));
  launch_groups("parallel_scan_rows", radix, arguments(arg("values", counts_), arg("count", groups)));
  launch_groups("group_sort_scatter", groups, arguments(digit, arg("keys_out", out), arg("counts", counts_)));
}

}  // namespace hemiray

#include "host/path/ray_sorter.hpp"

#include <algorithm>
#include <bit>

#include "host/bvh/ray_codes.hpp"

namespace hemiray {

RaySorter::RaySorter(Context& context, Parallel& parallel, std::uint32_t slots, const shared::float4& lo,
                     const shared::float4& hi)
    : context_(&context),
      parallel_(&parallel),
      program_(context, "sort_rays", {"path/sort_rays.cl"}, ProgramOptions{0, false, ""}),
      index_bits_(static_cast<std::uint32_t>(std::bit_width(std::max(slots, 2U) - 1))),
      lo_(lo),
      scale_(ray_code_scale(lo, hi)),
      keys_(context, "ray keys", slots),
      keys_other_(context, "ray keys", slots) {}

void RaySorter::sort(const Buffer<std::uint32_t>& queue, std::uint32_t first, std::uint32_t count,
                     const Arguments& rays) {
  const std::uint32_t chunks = context_->profile().chunks;
  const Arguments run =
      arguments(arg("queue", queue), arg("first", first), arg("count", count), arg("index_bits", index_bits_));
  launch(*context_, program_.kernel("path_code_rays"), chunks,
         arguments(run, rays, arg("lo", lo_), arg("scale", scale_), arg("keys", keys_)));
  parallel_->sort(keys_, keys_other_, count, index_bits_, kRayCodeBits);
  launch(*context_, program_.kernel("path_order_queue"), chunks, arguments(run, arg("keys", keys_)));
}

}  // namespace hemiray

#include "host/path/wave_tracing.hpp"

#include <algorithm>

#include "host/base/error.hpp"

namespace hemiray {
namespace {

constexpr std::uint32_t kTileSide = 8;
// Packet kernels take about a second to compile: what tracing so many camera rays one by one takes longer by.
constexpr std::uint64_t kRaysWorthPackets = std::uint64_t{1} << 23;

}  // namespace

WaveTracing choose_tracing(const std::optional<RayGrouping>& chosen, const WaveFacts& facts, const Accel& accel,
                           const DeviceProfile& profile) {
  WaveTracing tracing;
  tracing.lo = accel.statistics().lo;
  tracing.hi = accel.statistics().hi;
  const bool possible = !facts.strict && !facts.double_precision && accel.config().has_packets();
  if (!chosen) {
    tracing.packets = possible && facts.common_origin && facts.camera_rays >= kRaysWorthPackets;
    tracing.sort_from = profile.sort_rays;
  } else if (*chosen == RayGrouping::packets) {
    if (!possible) {
      throw InputError(
          "--rays packets",
          "cannot be had with --strict, with --precision double, over trees of cells, nor where leaves are not laid "
          "out in vectors; take --rays single");
    }
    tracing.packets = true;
  } else if (*chosen == RayGrouping::sorted) {
    tracing.sort_from = 1;
  }
  return tracing;
}

std::vector<std::uint32_t> slots_by_tile(std::uint32_t first_pixel, std::uint32_t count, std::uint32_t width) {
  std::vector<std::uint32_t> slots;
  slots.reserve(count);
  const std::uint64_t begin = first_pixel, end = begin + count;
  for (std::uint64_t row = begin / width * width; row < end; row += std::uint64_t{kTileSide} * width) {
    for (std::uint32_t column = 0; column < width; column += kTileSide) {
      const std::uint32_t columns = std::min(kTileSide, width - column);
      for (std::uint64_t y = 0; y < kTileSide; y++) {
        const std::uint64_t line = row + y * width + column;
        const std::uint64_t from = std::max(line, begin), to = std::min(line + columns, end);
        for (std::uint64_t pixel = from; pixel < to; pixel++)
          slots.push_back(static_cast<std::uint32_t>(pixel - begin));
      }
    }
  }
  return slots;
}

}  // namespace hemiray

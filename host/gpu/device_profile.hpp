// What kernels are tuned by: one table per device class.
#pragma once

#include <cstdint>

#include "host/gpu/device.hpp"

namespace hemiray {

struct DeviceProfile {
  std::uint32_t local_size = 64;       ///< work-group size of item-a-thing kernels (compiled in)
  std::uint32_t chunks = 16;           ///< work-items of chunked kernels (sort, bounds)
  std::uint32_t chunk_local_size = 1;  ///< their work-group size
  std::uint32_t queue_chunks = 16;     ///< work-items of queue compaction
  std::uint32_t wave_slots = 65536;    ///< paths in flight
  /// The driver caches machine code itself, keyed by the source text, and would compile once more for a binary: then
  /// hemiray's program cache is left out.
  bool has_own_cache = false;
};

/// CPUs want few large chunks and waves that stay in the cache; GPUs want thousands of items in flight.
inline DeviceProfile profile_for(const DeviceInfo& device) {
  DeviceProfile profile;
  profile.has_own_cache = device.platform == "Portable Computing Language";
  if (device.kind == DeviceKind::gpu) {
    profile.chunks = 2048;
    profile.chunk_local_size = 32;
    profile.queue_chunks = 2048;
    profile.wave_slots = 1U << 20U;
  } else {
    profile.chunks = static_cast<std::uint32_t>(device.compute_units) * 4;
    profile.queue_chunks = profile.chunks;
  }
  return profile;
}

}  // namespace hemiray

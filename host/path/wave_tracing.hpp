// How the wavefront traces the rays of a wave, and in which order its slots go.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host/bvh/accel.hpp"
#include "host/bvh/ray_queries.hpp"
#include "host/gpu/device_profile.hpp"

namespace hemiray {

struct WaveTracing {
  /// Camera rays, and shadow rays where all lights are points, go in packets (kernels/path/packets.cl).
  bool packets = false;
  /// Waves of at least so many reflected and refracted rays are sorted first; 0: none.
  std::uint32_t sort_from = 0;
  shared::float4 lo{}, hi{};  ///< bounds of the scene [m], for sorting
};

/// What a render's rays look like, as far as it decides how they are traced.
struct WaveFacts {
  bool common_origin = false;     ///< of the camera's rays
  bool strict = false;            ///< single rays only: the same bits as the megakernel
  bool double_precision = false;  ///< single rays only: without vectors there are no packets
  std::uint64_t camera_rays = 0;  ///< in the whole render
};

/// `chosen` is the user's, for experiments; without it, what pays on the device for a render of that size. Throws
/// InputError for packets that cannot be had: in strict builds, in double precision, over trees of cells, without
/// explicit vectors.
WaveTracing choose_tracing(const std::optional<RayGrouping>& chosen, const WaveFacts& facts, const Accel& accel,
                           const DeviceProfile& profile);

/// Slots of the wave [first_pixel, + count) of an image `width` pixels wide, those of each 8 x 8 pixels after one
/// another: neighbours on the screen meet the same things.
std::vector<std::uint32_t> slots_by_tile(std::uint32_t first_pixel, std::uint32_t count, std::uint32_t width);

}  // namespace hemiray

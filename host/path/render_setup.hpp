// What a render is on any device: options checked, scene flattened, effects and memory known.
#pragma once

#include <cstdint>

#include "host/base/clock.hpp"
#include "host/gpu/device.hpp"
#include "host/gpu/device_profile.hpp"
#include "host/path/render.hpp"
#include "host/path/wave_tracing.hpp"
#include "host/scene/device_scene.hpp"
#include "host/scene/flat_scene.hpp"
#include "shared/params.h"

namespace hemiray {

/// Scene and options must outlive it.
struct RenderSetup {
  const Scene& scene;
  const RenderOptions& options;
  int width = 0, height = 0;  ///< [pixels]
  int depth = 0;              ///< bounces
  std::uint32_t pixels = 0;
  std::uint32_t features = 0;
  FlatScene flat;
  double flatten_ms = 0.0;

  /// Throws InputError for options out of range.
  RenderSetup(const Scene& scene, const RenderOptions& options);

  /// Paths in flight.
  [[nodiscard]] std::uint32_t slots(const DeviceProfile& profile) const;
  /// Peak device memory [bytes].
  [[nodiscard]] std::uint64_t predicted_bytes(const DeviceProfile& profile) const;
  /// Throws DeviceError if the render does not fit into `available` bytes of the device's memory.
  void check_memory(const DeviceInfo& device, std::uint64_t available) const;
  /// What its camera rays are like.
  [[nodiscard]] WaveFacts wave_facts() const;
  /// All but first_pixel, sample and slot_count.
  [[nodiscard]] shared::RenderParams params(const DeviceScene& device_scene) const;
};

/// A device's entry in the statistics before it has done anything.
DeviceStatistics statistics_of(const DeviceInfo& device, const RenderSetup& setup);

}  // namespace hemiray

// A scene rendered on a device: Whitted ray tracing, start to finished picture.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/base/image.hpp"
#include "host/bvh/accel.hpp"
#include "host/gpu/context.hpp"
#include "host/path/engine.hpp"
#include "host/scene/scene.hpp"

namespace hemiray {

struct RenderOptions {
  EngineKind engine = EngineKind::wavefront;
  int width = 0;   ///< [pixels]; 0: the scene's
  int height = 0;  ///< [pixels]; 0: the scene's
  int spp = 4;     ///< samples a pixel, >= 1
  int depth = -1;  ///< bounces; negative: the scene's
  std::uint32_t seed = 0;
  bool strict = false;  ///< same bits from both engines
  AccelOptions accel;

  std::function<void(double fraction, double rays_per_second)> on_progress;  ///< after each wave
  std::function<void()> on_first_pass;  ///< when the first sample of every pixel is done
  std::function<bool()> should_stop;    ///< asked after each pass; true ends the render with what is there
};

struct ProgramStatistics {
  std::string name;
  std::size_t kernels = 0;
  double build_ms = 0.0;
  bool cached = false;  ///< from hemiray's cache, or left to the driver's own
};

struct RenderStatistics {
  std::uint32_t features = 0;
  AccelStatistics accel;
  std::uint32_t planes = 0, lights = 0, emitters = 0;
  RayCounts rays;
  int passes = 0;
  bool interrupted = false;
  double upload_ms = 0.0;            ///< flattening the scene and copying it to the device
  double trace_ms = 0.0;             ///< wall time of all passes without compilation
  double launch_compile_ms = 0.0;    ///< spent by the driver on kernels at their first launch
  std::size_t kernels_compiled = 0;  ///< of these, how many it really compiled
  std::vector<ProgramStatistics> programs;
  std::vector<StageTime> stages;
  std::uint64_t predicted_device_bytes = 0;
  std::uint64_t peak_device_bytes = 0;
};

struct RenderResult {
  Image image;  ///< layers as Film::develop() says; metadata empty
  RenderStatistics statistics;
};

/// Renders `scene` on the context's device. Throws InputError for options out of range, DeviceError if the device fails
/// or is too small. Compiled kernels are in the cache afterwards.
RenderResult render_scene(Context& context, const Scene& scene, const RenderOptions& options);

}  // namespace hemiray

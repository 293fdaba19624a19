// All that one device needs to trace a scene's paths: scene, tree, engine.
#pragma once

#include <cstdint>
#include <memory>

#include "host/bvh/accel.hpp"
#include "host/gpu/context.hpp"
#include "host/path/engine.hpp"
#include "host/path/render.hpp"
#include "host/path/render_setup.hpp"
#include "host/scene/device_scene.hpp"

namespace hemiray {

class DeviceRender {
 public:
  /// Uploads the scene, builds the tree, compiles the kernels. Both must outlive it. Throws DeviceError.
  DeviceRender(Context& context, const RenderSetup& setup);

  /// Traces sample `pass` of pixels [first_pixel, + count), count <= slots(); `aov` are the arguments of the geometric
  /// layers. The sums are in engine().sums() then. Throws DeviceError.
  RayCounts trace(std::uint32_t pass, std::uint32_t first_pixel, std::uint32_t count, const Arguments& aov);

  [[nodiscard]] std::uint32_t slots() const { return slots_; }
  [[nodiscard]] PathEngine& engine() { return *engine_; }

  /// What was uploaded, built and compiled, and what it took so far: all of RenderStatistics but rays, passes,
  /// interrupted, trace_ms and devices.
  void describe(RenderStatistics& statistics);

 private:
  Context* context_;
  std::uint32_t slots_;
  std::uint64_t predicted_bytes_;
  double upload_start_;  // [ms]
  DeviceScene scene_;
  double upload_ms_;  // flattening too
  Parallel parallel_;
  AccelBuilder builder_;
  Accel accel_;
  std::unique_ptr<PathEngine> engine_;
  Arguments scene_arguments_;
  shared::RenderParams params_;
};

}  // namespace hemiray

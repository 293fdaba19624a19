// A scene rendered on one device or several: Whitted ray tracing, start to finished picture.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/base/image.hpp"
#include "host/bvh/accel.hpp"
#include "host/bvh/ray_queries.hpp"
#include "host/gpu/context.hpp"
#include "host/path/engine.hpp"
#include "host/path/tile_queue.hpp"
#include "host/scene/flat_scene.hpp"
#include "host/scene/instancing.hpp"
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
  /// Rays, hits and shading in double; trees and radiance sums stay single. Then lanes are loops, not vectors.
  bool double_precision = false;
  /// Shadow rays leave smooth-shaded triangles from the surface that their normals tell of (kernels/lib/terminator.h).
  bool smooth_terminator = true;
  AccelOptions accel;
  /// The scene as patches lit by a radiosity solution: traced in place of the scene's own surfaces and lights.
  const FlatScene* patches = nullptr;
  std::optional<RayGrouping> rays;                ///< how the wavefront traces them; none: what pays (wave_tracing.hpp)
  Instancing instancing = Instancing::automatic;  ///< in trees of cells there are no instances

  std::function<void(double fraction, double rays_per_second)> on_progress;  ///< after each wave
  std::function<void()> on_first_pass;  ///< when the first sample of every pixel is done
  std::function<bool()> should_stop;    ///< asked after each pass; true ends the render with what is there

  // Where several devices share the work. All callbacks but before_tile come on the thread that renders.
  std::uint32_t tile_pixels = 0;  ///< at most so many pixels a tile; 0: as many as suit the device
  bool keep_spans = false;        ///< fills DeviceStatistics::spans
  std::function<void(const std::string& message)> on_device_lost;  ///< a device failed; the others do its tiles
  /// Called by a device's own thread before it traces a tile; what it throws is as if the device had thrown it.
  std::function<void(std::size_t device, const Tile& tile)> before_tile;
};

struct ProgramStatistics {
  std::string name;
  std::size_t kernels = 0;
  double build_ms = 0.0;
  bool cached = false;  ///< from hemiray's cache, or left to the driver's own
};

/// One device's share of a render.
struct DeviceStatistics {
  int index = 0;
  std::string name;  ///< "NAME", or "NAME, part 1 of 2"
  std::string platform, driver;
  std::uint64_t tiles = 0;    ///< whose sums counted
  std::uint64_t samples = 0;  ///< pixel samples in these
  RayCounts rays;             ///< in these
  double busy_ms = 0.0;       ///< spent on these, without compilation
  double compile_ms = 0.0;    ///< by the driver, on kernels at their first launch while tracing
  std::uint64_t predicted_bytes = 0, peak_bytes = 0;
  std::string failure;  ///< why it was dropped; empty if it was not
  std::vector<TraceSpan> spans;
};

struct RenderStatistics {
  std::uint32_t features = 0;
  AccelStatistics accel;
  std::uint32_t planes = 0, lights = 0, emitters = 0;
  RayCounts rays;
  std::uint64_t uncertain_roots = 0;  ///< regions of rays in which it is open whether they meet an implicit surface
  int passes = 0;
  bool interrupted = false;
  double upload_ms = 0.0;                   ///< flattening the scene and copying it to the device (the slowest)
  double trace_ms = 0.0;                    ///< wall time of all passes without compilation
  double launch_compile_ms = 0.0;           ///< spent by the driver on kernels at their first launch
  std::size_t kernels_compiled = 0;         ///< of these, how many it really compiled
  std::vector<ProgramStatistics> programs;  ///< of all devices, one after the other
  std::vector<StageTime> stages;            ///< sums over the devices
  std::uint64_t predicted_device_bytes = 0;
  std::uint64_t peak_device_bytes = 0;
  std::vector<DeviceStatistics> devices;
};

struct RenderResult {
  Image image;  ///< layers as develop() says; metadata empty
  RenderStatistics statistics;
};

/// Renders `scene` on the context's device. Throws InputError for options out of range, DeviceError if the device fails
/// or is too small. Compiled kernels are in the cache afterwards.
RenderResult render_scene(Context& context, const Scene& scene, const RenderOptions& options);

/// Renders `scene` on all these devices at once, one thread each; one device is as render_scene(). Tiles go to the
/// devices by what each delivers; the picture has the bits it has on one device of the same kind. A device that does
/// not have the memory, or fails, is dropped (on_device_lost) and its tiles are done by the others. Throws InputError
/// for options out of range, DeviceError if no device is left.
RenderResult render_on_devices(const std::vector<DeviceInfo>& devices, const Scene& scene,
                               const RenderOptions& options);

}  // namespace hemiray

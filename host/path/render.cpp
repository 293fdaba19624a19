#include "host/path/render.hpp"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "host/base/error.hpp"
#include "host/base/numbers.hpp"
#include "host/path/camera_params.hpp"
#include "host/path/memory_prediction.hpp"
#include "host/scene/features.hpp"
#include "host/scene/flat_scene.hpp"

namespace hemiray {
namespace {

constexpr int kMaxSide = 65536;                             // [pixels]
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 30;  // slots and pixels are counted in 32 bits
constexpr int kMaxSamples = 1 << 20;
constexpr int kMaxDepth = 64;  // a pending branch a bounce and slot is kept
constexpr std::uint32_t kSeedFactor = 0x9E3779B9U;

double now_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void check_range(const char* option, int value, int least, int most) {
  if (value < least || value > most) {
    throw InputError(option, fmt::format("{} is out of range; it must be from {} to {}", value, least, most));
  }
}

shared::RenderParams make_params(const Scene& scene, const DeviceScene& device_scene, const RenderOptions& options,
                                 int width, int height, int depth) {
  shared::RenderParams params{};
  set_camera(params, scene.camera, width, height);
  params.background = {scene.background.x, scene.background.y, scene.background.z, 0.0F};
  params.ambient = {scene.ambient.x, scene.ambient.y, scene.ambient.z, 0.0F};
  params.samples = static_cast<std::uint32_t>(options.spp);
  params.seed_key = options.seed * kSeedFactor;
  params.max_depth = static_cast<std::uint32_t>(depth);
  params.triangle_count = device_scene.triangle_count();
  params.sphere_count = device_scene.sphere_count();
  params.plane_count = device_scene.plane_count();
  params.light_count = device_scene.light_count();
  params.emitter_count = device_scene.emitter_count();
  return params;
}

// All passes over the picture, in waves of as many pixels as the engine has slots.
void trace_passes(Context& context, PathEngine& engine, Film& film, shared::RenderParams params,
                  const Arguments& scene_arguments, std::uint32_t slots, const RenderOptions& options,
                  RenderStatistics& statistics) {
  const std::uint32_t pixels = params.width * params.height;
  const double start = now_ms();
  const double compile_start = context.launch_compile_ms();
  double done = 0.0;
  for (int pass = 0; pass < options.spp; pass++) {
    params.sample = static_cast<std::uint32_t>(pass);
    for (std::uint32_t first = 0; first < pixels; first += slots) {
      const std::uint32_t count = std::min(slots, pixels - first);
      params.first_pixel = first;
      const RayCounts rays = engine.trace(params, count, scene_arguments);
      film.accumulate(engine.program().kernel("film_accumulate"), engine.sums(), first, count);
      statistics.rays.closest += rays.closest;
      statistics.rays.shadow += rays.shadow;
      done += count;
      if (options.on_progress) {
        const double seconds = (now_ms() - start) * 1e-3;
        const auto traced = static_cast<double>(statistics.rays.closest + statistics.rays.shadow);
        options.on_progress(done / (static_cast<double>(pixels) * options.spp), traced / std::max(seconds, 1e-9));
      }
    }
    context.finish();
    statistics.passes = pass + 1;
    if (pass == 0 && options.on_first_pass) options.on_first_pass();
    if (options.should_stop && options.should_stop()) {
      statistics.interrupted = true;
      break;
    }
  }
  statistics.trace_ms = now_ms() - start - (context.launch_compile_ms() - compile_start);
}

void note_program(const Context& context, RenderStatistics& statistics, const Program& program) {
  const bool driver_had_it = context.profile().has_own_cache && context.kernels_compiled() == 0;
  const bool cached = program.from_cache() || driver_had_it;
  statistics.programs.push_back({program.name(), program.kernel_count(), program.build_ms(), cached});
}

}  // namespace

RenderResult render_scene(Context& context, const Scene& scene, const RenderOptions& options) {
  const int width = options.width > 0 ? options.width : scene.camera.width;
  const int height = options.height > 0 ? options.height : scene.camera.height;
  const int depth = options.depth >= 0 ? options.depth : scene.depth;
  check_range("--size", width, 1, kMaxSide);
  check_range("--size", height, 1, kMaxSide);
  if (std::int64_t{width} * height > kMaxPixels) {
    throw InputError("--size", fmt::format("{} x {} is more than 2^30 pixels", width, height));
  }
  check_range("--spp", options.spp, 1, kMaxSamples);
  check_range("--depth", depth, 0, kMaxDepth);
  const std::uint32_t pixels = static_cast<std::uint32_t>(width) * static_cast<std::uint32_t>(height);
  const std::uint32_t slots = std::min(pixels, context.profile().wave_slots);

  RenderResult result;
  RenderStatistics& statistics = result.statistics;
  const double start = now_ms();
  const FlatScene flat = flatten_scene(scene);
  statistics.features = features_of(scene, flat, depth);
  statistics.predicted_device_bytes =
      predict_render_bytes(flat, statistics.features, options.engine, width, height, depth, context.profile());
  if (statistics.predicted_device_bytes > context.device().global_bytes) {
    throw DeviceError(
        fmt::format("device memory: the scene at {} x {} needs {}, {} has {}; take a smaller --size or "
                    "another device",
                    width, height, format_bytes(statistics.predicted_device_bytes), context.device().name,
                    format_bytes(context.device().global_bytes)));
  }
  const DeviceScene device_scene(context, flat, statistics.features);
  statistics.upload_ms = now_ms() - start;
  statistics.planes = device_scene.plane_count();
  statistics.lights = device_scene.light_count();
  statistics.emitters = device_scene.emitter_count();

  Parallel parallel(context);
  AccelBuilder builder(context, parallel);
  const Accel accel(builder, device_scene, options.accel);
  statistics.accel = accel.statistics();

  Film film(context, statistics.features, width, height);
  const std::unique_ptr<PathEngine> engine =
      make_engine(options.engine, context, parallel, statistics.features, options.strict, slots, depth);
  const Arguments scene_arguments =
      arguments(device_scene.shading_arguments(), accel.tree_arguments(), film.aov_arguments());
  trace_passes(context, *engine, film, make_params(scene, device_scene, options, width, height, depth), scene_arguments,
               slots, options, statistics);

  result.image = film.develop(statistics.passes);
  context.finish();
  statistics.stages = context.profiler().stages();
  statistics.peak_device_bytes = context.peak_bytes();
  statistics.launch_compile_ms = context.launch_compile_ms();
  statistics.kernels_compiled = context.kernels_compiled();
  note_program(context, statistics, parallel.program());
  note_program(context, statistics, builder.program);
  note_program(context, statistics, engine->program());
  return result;
}

}  // namespace hemiray

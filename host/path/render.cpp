#include "host/path/render.hpp"

#include <algorithm>

#include "host/path/device_render.hpp"
#include "host/path/film.hpp"
#include "host/path/render_setup.hpp"

namespace hemiray {
namespace {

// All passes over the picture, in waves of as many pixels as the engine has slots.
void trace_passes(Context& context, DeviceRender& device, Film& film, const RenderSetup& setup,
                  RenderStatistics& statistics) {
  const RenderOptions& options = setup.options;
  DeviceStatistics& own = statistics.devices.front();
  const Arguments aov = film.aov_arguments();
  const double start = steady_ms();
  const double compile_start = context.launch_compile_ms();
  for (int pass = 0; pass < options.spp; pass++) {
    for (std::uint32_t first = 0; first < setup.pixels; first += device.slots()) {
      const std::uint32_t count = std::min(device.slots(), setup.pixels - first);
      const RayCounts rays = device.trace(static_cast<std::uint32_t>(pass), first, count, aov);
      PathEngine& engine = device.engine();
      film.accumulate(engine.program().kernel("film_accumulate"), engine.sums(), first, count);
      own.rays.closest += rays.closest;
      own.rays.shadow += rays.shadow;
      own.tiles++;
      own.samples += count;
      if (options.on_progress) {
        const double seconds = (steady_ms() - start) * 1e-3;
        const auto traced = static_cast<double>(own.rays.closest + own.rays.shadow);
        const double all = static_cast<double>(setup.pixels) * options.spp;
        options.on_progress(static_cast<double>(own.samples) / all, traced / std::max(seconds, 1e-9));
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
  own.compile_ms = context.launch_compile_ms() - compile_start;
  statistics.trace_ms = steady_ms() - start - own.compile_ms;
  statistics.rays = own.rays;
  own.busy_ms = statistics.trace_ms;
}

}  // namespace

RenderResult render_scene(Context& context, const Scene& scene, const RenderOptions& options) {
  const RenderSetup setup(scene, options);
  setup.check_memory(context.device(), context.device().global_bytes);
  if (options.keep_spans) context.profiler().keep_spans(true);
  DeviceRender device(context, setup);
  Film film(context, setup.features, setup.width, setup.height);

  RenderResult result;
  RenderStatistics& statistics = result.statistics;
  statistics.devices.push_back(statistics_of(context.device(), setup));
  trace_passes(context, device, film, setup, statistics);
  result.image = film.develop(statistics.passes);
  context.finish();
  device.describe(statistics);
  statistics.devices.front().peak_bytes = statistics.peak_device_bytes;
  if (options.keep_spans) statistics.devices.front().spans = context.profiler().spans();
  return result;
}

}  // namespace hemiray

#include "host/path/device_worker.hpp"

#include <utility>

#include "host/base/error.hpp"

namespace hemiray {
namespace {

TileSums read_sums(const PathSums& sums, const GeometryLayers& layers, const Tile& tile) {
  TileSums read;
  read.tile = tile;
  read.direct = sums.direct.read(0, tile.count);
  if (!sums.reflection.name().empty()) read.reflection = sums.reflection.read(0, tile.count);
  if (!sums.refraction.name().empty()) read.refraction = sums.refraction.read(0, tile.count);
  if (tile.pass > 0) return read;
  read.normal_depth = layers.normal_depth().read(tile.first_pixel, tile.count);
  read.albedo_object = layers.albedo_object().read(tile.first_pixel, tile.count);
  return read;
}

}  // namespace

DeviceWorker::DeviceWorker(std::size_t number, const DeviceInfo& device, const SharedFrame& frame)
    : number_(number), device_(device), frame_(frame) {
  statistics_.devices.push_back(statistics_of(device_, frame_.setup));
}

void DeviceWorker::run() noexcept {
  std::exception_ptr other;
  try {
    Context context(device_);
    render(context);
  } catch (const DeviceError& error) {
    fail(error.what());
  } catch (...) {
    other = std::current_exception();
    frame_.queue.abandon();
  }
  const std::lock_guard lock(frame_.news.mutex);
  if (other && !frame_.news.other_error) frame_.news.other_error = other;
  frame_.news.working--;
  frame_.news.changed.notify_all();
}

void DeviceWorker::fail(const std::string& message) noexcept {
  frame_.queue.drop(number_, in_hand_);
  DeviceStatistics& own = statistics_.devices.front();
  own.failure = message;
  const std::lock_guard lock(frame_.news.mutex);
  frame_.news.lost.push_back(own);
  frame_.news.changed.notify_all();
}

void DeviceWorker::render(Context& context) {
  const bool keep_spans = frame_.setup.options.keep_spans;
  const double spans_start_us = (steady_ms() - frame_.start_ms) * 1e3 - context.profiler().now_us();
  context.profiler().keep_spans(keep_spans);
  DeviceRender device(context, frame_.setup);
  const GeometryLayers layers(context, frame_.setup.width, frame_.setup.height);
  {
    const std::lock_guard lock(frame_.news.mutex);
    if (frame_.news.first_tile_ms == 0.0) frame_.news.first_tile_ms = steady_ms();
  }
  const auto note = [&] {
    device.describe(statistics_);
    DeviceStatistics& own = statistics_.devices.front();
    own.peak_bytes = statistics_.peak_device_bytes;
    if (keep_spans) own.spans = context.profiler().spans();
    for (TraceSpan& span : own.spans) span.start_us += spans_start_us;
  };
  try {
    while ((in_hand_ = frame_.queue.take(number_))) {
      render_tile(context, device, layers, *in_hand_);
      in_hand_.reset();
    }
    context.finish();
  } catch (...) {
    note();
    throw;
  }
  note();
}

void DeviceWorker::render_tile(Context& context, DeviceRender& device, const GeometryLayers& layers, const Tile& tile) {
  const double start = steady_ms();
  const double compile_start = context.launch_compile_ms();
  if (frame_.setup.options.before_tile) frame_.setup.options.before_tile(number_, tile);
  const RayCounts rays = device.trace(tile.pass, tile.first_pixel, tile.count, layers.arguments());
  frame_.film.add(read_sums(device.engine().sums(), layers, tile));
  const double compile_ms = context.launch_compile_ms() - compile_start;
  const double milliseconds = steady_ms() - start - compile_ms;
  frame_.queue.finish(number_, tile, milliseconds * 1e-3);
  DeviceStatistics& own = statistics_.devices.front();
  own.tiles++;
  own.samples += tile.count;
  own.rays.closest += rays.closest;
  own.rays.shadow += rays.shadow;
  own.busy_ms += milliseconds;
  own.compile_ms += compile_ms;
  const std::lock_guard lock(frame_.news.mutex);
  frame_.news.rays.closest += rays.closest;
  frame_.news.rays.shadow += rays.shadow;
  frame_.news.changed.notify_all();
}

}  // namespace hemiray

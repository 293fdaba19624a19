// Several devices, one frame. Unit of work is a tile: one sample of each of a run of pixels. Passes follow each other
// without a barrier: a device that is done with pass p goes on with pass p + 1 while another still has a tile of pass
// p, and HostFilm adds each pixel's samples in order. So no device waits for another but at the end of the frame, and
// sums have the order, and the bits, that a single device gives them.
#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <thread>

#include <fmt/format.h>

#include "host/base/error.hpp"
#include "host/path/device_worker.hpp"
#include "host/path/render.hpp"

namespace hemiray {
namespace {

// Tiles go down to this part of a wave at the end of a frame: launches cost too much below.
constexpr std::uint32_t kLeastTile = 32;
constexpr std::chrono::milliseconds kPollInterval{20};  // how late an interrupt may be seen

// Devices that live in the same memory: all CPU devices, and the parts of one device.
std::string memory_of(const DeviceInfo& device) {
  return device.kind == DeviceKind::cpu ? "host" : std::to_string(device.index);
}

std::string lost_message(const DeviceStatistics& device) {
  return fmt::format("device {} ({}) is dropped: {}", device.index, device.name, device.failure);
}

// Which of the devices have the memory, given that some share theirs; the others go to `refused`.
std::vector<DeviceInfo> fitting_devices(const std::vector<DeviceInfo>& devices, const RenderSetup& setup,
                                        std::vector<DeviceStatistics>& refused) {
  std::map<std::string, std::uint64_t> size, used;
  for (const DeviceInfo& d : devices) size[memory_of(d)] = std::max(size[memory_of(d)], d.global_bytes);
  std::vector<DeviceInfo> fitting;
  for (const DeviceInfo& device : devices) {
    const std::string memory = memory_of(device);
    try {
      setup.check_memory(device, std::min(device.global_bytes, size[memory] - used[memory]));
    } catch (const DeviceError& error) {
      refused.push_back(statistics_of(device, setup));
      refused.back().failure = error.what();
      continue;
    }
    used[memory] += setup.predicted_bytes(profile_for(device));
    fitting.push_back(device);
  }
  return fitting;
}

std::vector<TileLimits> tile_limits(const std::vector<DeviceInfo>& devices, const RenderSetup& setup) {
  std::vector<TileLimits> limits;
  for (const DeviceInfo& device : devices) {
    const DeviceProfile profile = profile_for(device);
    const std::uint32_t asked = setup.options.tile_pixels;
    const std::uint32_t most = asked > 0 ? std::min(asked, setup.slots(profile)) : setup.slots(profile);
    limits.push_back({std::min(profile.wave_slots / kLeastTile, most), most});
  }
  return limits;
}

[[noreturn]] void throw_no_device_left(const std::vector<DeviceStatistics>& devices) {
  std::string text;
  for (const DeviceStatistics& device : devices) {
    if (!device.failure.empty()) text += (text.empty() ? "" : "; ") + lost_message(device);
  }
  throw DeviceError("no device is left: " + text);
}

// The workers' threads; whoever leaves early takes the work away and waits for them.
class WorkerThreads {
 public:
  WorkerThreads(std::vector<std::unique_ptr<DeviceWorker>>& workers, TileQueue& queue, WorkerNews& news)
      : queue_(&queue) {
    try {
      for (const auto& worker : workers) {
        {
          const std::lock_guard lock(news.mutex);
          news.working++;
        }
        threads_.emplace_back([&worker] { worker->run(); });
      }
    } catch (...) {  // no thread to be had
      end();
      throw;
    }
  }
  WorkerThreads(const WorkerThreads&) = delete;
  WorkerThreads& operator=(const WorkerThreads&) = delete;
  ~WorkerThreads() { end(); }

 private:
  void end() {
    queue_->abandon();
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

  TileQueue* queue_;
  std::vector<std::thread> threads_;
};

// Tells the callbacks what happens until no worker is left; true if should_stop ended the render.
bool wait_for_workers(const RenderOptions& options, std::size_t devices, TileQueue& queue, const HostFilm& film,
                      WorkerNews& news) {
  bool stopped = false, had_first_pass = false;
  std::size_t told = 0;
  std::unique_lock lock(news.mutex);
  for (bool working = true; working;) {
    news.changed.wait_for(lock, kPollInterval);
    working = news.working > 0;
    const std::vector<DeviceStatistics> lost(news.lost.begin() + static_cast<std::ptrdiff_t>(told), news.lost.end());
    const auto rays = static_cast<double>(news.rays.closest + news.rays.shadow);
    const double seconds = news.first_tile_ms > 0.0 ? (steady_ms() - news.first_tile_ms) * 1e-3 : 0.0;
    lock.unlock();
    for (const DeviceStatistics& device : lost) {
      const char* rest = ++told < devices ? "; the others do its part" : "";
      if (options.on_device_lost) options.on_device_lost(lost_message(device) + rest);
    }
    if (rays > 0.0 && options.on_progress) options.on_progress(queue.fraction(), rays / std::max(seconds, 1e-9));
    if (!had_first_pass && film.complete_passes() > 0) {
      had_first_pass = true;
      if (options.on_first_pass) options.on_first_pass();
    }
    if (!stopped && options.should_stop && options.should_stop()) {
      stopped = true;
      queue.stop_after_pass();
    }
    lock.lock();
  }
  return stopped;
}

void add_stages(std::vector<StageTime>& all, const std::vector<StageTime>& more) {
  for (const StageTime& stage : more) {
    const auto known = std::find_if(all.begin(), all.end(), [&](const StageTime& s) { return s.name == stage.name; });
    if (known == all.end()) {
      all.push_back(stage);
      continue;
    }
    known->launches += stage.launches;
    known->items += stage.items;
    known->milliseconds += stage.milliseconds;
  }
}

void add_statistics(RenderStatistics& all, const RenderStatistics& one) {
  if (!one.programs.empty() && all.programs.empty()) {  // the first device that came so far speaks for the scene
    all.features = one.features;
    all.accel = one.accel;
    all.planes = one.planes;
    all.lights = one.lights;
    all.emitters = one.emitters;
  }
  all.accel.build_ms = std::max(all.accel.build_ms, one.accel.build_ms);
  all.upload_ms = std::max(all.upload_ms, one.upload_ms);
  all.launch_compile_ms += one.launch_compile_ms;
  all.kernels_compiled += one.kernels_compiled;
  all.predicted_device_bytes += one.predicted_device_bytes;
  all.peak_device_bytes += one.peak_device_bytes;
  all.programs.insert(all.programs.end(), one.programs.begin(), one.programs.end());
  add_stages(all.stages, one.stages);
  const DeviceStatistics& device = one.devices.front();
  all.uncertain_roots += one.uncertain_roots;
  all.rays.closest += device.rays.closest;
  all.rays.shadow += device.rays.shadow;
  all.devices.push_back(device);
}

}  // namespace

RenderResult render_on_devices(const std::vector<DeviceInfo>& devices_given, const Scene& scene,
                               const RenderOptions& options) {
  if (devices_given.size() == 1) {
    Context context(devices_given.front());
    return render_scene(context, scene, options);
  }
  const double start = steady_ms();
  const RenderSetup setup(scene, options);
  WorkerNews news;
  const std::vector<DeviceInfo> devices = fitting_devices(devices_given, setup, news.lost);
  if (devices.empty()) throw_no_device_left(news.lost);
  const std::vector<DeviceStatistics> refused = news.lost;

  TileQueue queue(setup.pixels, static_cast<std::uint32_t>(options.spp), tile_limits(devices, setup));
  HostFilm film(setup.features, setup.width, setup.height);
  std::vector<std::unique_ptr<DeviceWorker>> workers;
  for (std::size_t i = 0; i < devices.size(); i++) {
    workers.push_back(std::make_unique<DeviceWorker>(i, devices[i], SharedFrame{setup, queue, film, news, start}));
  }
  RenderResult result;
  RenderStatistics& statistics = result.statistics;
  {
    const WorkerThreads threads(workers, queue, news);
    statistics.interrupted = wait_for_workers(options, devices_given.size(), queue, film, news);
  }
  const double end = steady_ms();
  if (news.other_error) std::rethrow_exception(news.other_error);
  if (film.complete_passes() < queue.passes()) throw_no_device_left(news.lost);

  double compile_ms = end - start;  // that no device could trace in
  for (const auto& worker : workers) {
    add_statistics(statistics, worker->statistics());
    const DeviceStatistics& device = worker->statistics().devices.front();
    if (device.tiles > 0) compile_ms = std::min(compile_ms, device.compile_ms);
  }
  statistics.devices.insert(statistics.devices.end(), refused.begin(), refused.end());
  statistics.passes = static_cast<int>(film.complete_passes());
  statistics.trace_ms = end - news.first_tile_ms - compile_ms;
  result.image = film.develop(statistics.passes);
  return result;
}

}  // namespace hemiray

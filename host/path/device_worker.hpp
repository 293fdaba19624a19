// One device's thread where several share a frame: it opens the device, then traces tiles until there are none.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "host/path/device_render.hpp"
#include "host/path/host_film.hpp"
#include "host/path/tile_queue.hpp"

namespace hemiray {

/// What the workers of a frame tell the thread that waits for them. Guarded by `mutex`.
struct WorkerNews {
  std::mutex mutex;
  std::condition_variable changed;
  std::size_t working = 0;             ///< threads
  std::vector<DeviceStatistics> lost;  ///< devices dropped, in the order they failed
  RayCounts rays;                      ///< so far
  double first_tile_ms = 0.0;          ///< steady_ms() when the first device was ready; 0: none is
  std::exception_ptr other_error;      ///< not a device's failure: ends the render
};

/// The frame that the workers share; all references must outlive them.
struct SharedFrame {
  const RenderSetup& setup;
  TileQueue& queue;
  HostFilm& film;
  WorkerNews& news;
  double start_ms = 0.0;  ///< steady_ms() that trace spans count from
};

class DeviceWorker {
 public:
  DeviceWorker(std::size_t number, const DeviceInfo& device, const SharedFrame& frame);

  /// The thread's body. A DeviceError drops the device: what it had in hand goes back to the queue.
  void run() noexcept;

  /// After run(): as DeviceRender::describe() says, and one entry in `devices`.
  [[nodiscard]] const RenderStatistics& statistics() const { return statistics_; }

 private:
  void render(Context& context);
  void render_tile(Context& context, DeviceRender& device, const GeometryLayers& layers, const Tile& tile);
  void fail(const std::string& message) noexcept;

  std::size_t number_;
  DeviceInfo device_;
  SharedFrame frame_;
  std::optional<Tile> in_hand_;
  RenderStatistics statistics_;
};

}  // namespace hemiray

// The picture on the host, where several devices share a frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <vector>

#include "host/path/film.hpp"
#include "host/path/tile_queue.hpp"

namespace hemiray {

/// What a device hands over of a tile: one entry a pixel; empty where the effect mask leaves it out, and the geometric
/// layers in all passes but the first.
struct TileSums {
  Tile tile;
  std::vector<shared::float4> direct, reflection, refraction;
  std::vector<shared::float4> normal_depth, albedo_object;
};

/// Adds tiles in the order of their passes, pixel by pixel, whatever order they come in: the same additions as on a
/// single device, hence the same bits (as far as the device does not flush denormals). Passes need no pause between
/// them: of a tile that comes early only the pixels that still lack a pass wait here. Thread-safe.
class HostFilm {
 public:
  HostFilm(std::uint32_t features, int width, int height);

  /// Each pixel of each pass must come once; a second one is a std::logic_error.
  void add(TileSums sums);

  /// Passes that every pixel has.
  [[nodiscard]] std::uint32_t complete_passes() const;
  /// Pixel samples that wait for an earlier pass.
  [[nodiscard]] std::size_t waiting() const;
  /// Layers as hemiray::develop() says. All pixels must have `passes` passes and no more.
  [[nodiscard]] Image develop(int passes) const;

 private:
  /// Adds the pixels that are ready; returns the runs of the others.
  [[nodiscard]] std::vector<TileSums> add_ready(TileSums sums);
  void add_run(const TileSums& sums, std::size_t first, std::size_t count);

  mutable std::mutex mutex_;
  FilmData data_;
  std::vector<std::uint32_t> passes_of_;  ///< a pixel: passes added
  std::vector<TileSums> waiting_;
  std::uint32_t complete_ = 0;      ///< passes that all pixels have
  std::deque<std::size_t> pixels_;  ///< that have pass complete_, complete_ + 1, ...
};

}  // namespace hemiray

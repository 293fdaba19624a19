// The work of a frame as tiles, handed out to devices by what each delivers.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

namespace hemiray {

/// One sample of each of a run of consecutive pixels.
struct Tile {
  std::uint32_t pass = 0;         ///< index of the sample
  std::uint32_t first_pixel = 0;  ///< row-major
  std::uint32_t count = 0;        ///< pixels
};

/// How large a device's tiles may be [pixels]: below `least` it idles between launches, above `most` it has no room.
struct TileLimits {
  std::uint32_t least = 1;
  std::uint32_t most = 1;
};

/// Hands out each pixel of each pass once, in order, one pass after the other without a pause between them. A device
/// gets half of what it would do of the work that is left, by the rates measured so far (guided self-scheduling,
/// Polychronopoulos and Kuck 1987), so tiles shrink towards the end of the frame and all devices end together. What a
/// failed device had in hand goes to the next one that asks. Thread-safe; a device is a thread that calls take(), then
/// finish(), in turn, or drop() once.
class TileQueue {
 public:
  /// Tiles start at multiples of this many pixels from the start, so that groups of rays are cut the same everywhere.
  static constexpr std::uint32_t kGranule = 256;

  /// pixels, passes >= 1.
  TileQueue(std::uint32_t pixels, std::uint32_t passes, const std::vector<TileLimits>& devices);

  /// The next tile for that device; none once the frame is done. Waits where all work is handed out but may come back.
  [[nodiscard]] std::optional<Tile> take(std::size_t device);
  /// `tile` is done and its sums are on the host; it took `seconds`, compilation left out.
  void finish(std::size_t device, const Tile& tile, double seconds);
  /// The device asks no more; the tile it had in hand goes to the others.
  void drop(std::size_t device, const std::optional<Tile>& tile);
  /// The pass that is being handed out, the first at least, is the last.
  void stop_after_pass();
  /// No tiles any more, for nobody.
  void abandon();

  /// Pixel samples that nobody has in hand.
  [[nodiscard]] std::uint64_t unassigned() const;
  /// Share of the work that is done, 0 to 1.
  [[nodiscard]] double fraction() const;
  /// Passes to be made: those asked for, or fewer after stop_after_pass().
  [[nodiscard]] std::uint32_t passes() const;

 private:
  struct Device {
    TileLimits limits;
    double rate = 0.0;  ///< pixel samples a second; 0: not known yet
  };

  [[nodiscard]] std::uint64_t count_unassigned() const;
  [[nodiscard]] std::uint32_t size_for(const Device& device) const;
  [[nodiscard]] Tile cut(std::size_t device);

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::uint32_t pixels_, passes_;
  std::uint32_t pass_ = 0, next_pixel_ = 0;  ///< where the next new tile starts
  std::vector<Tile> returned_;               ///< from failed devices
  std::vector<Device> devices_;
  std::uint32_t in_hand_ = 0;  ///< tiles
  std::uint64_t done_ = 0;     ///< pixel samples
  bool abandoned_ = false;
};

}  // namespace hemiray

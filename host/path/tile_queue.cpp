#include "host/path/tile_queue.hpp"

#include <algorithm>

namespace hemiray {
namespace {

// A device whose rate is not known starts with this part of its largest tile.
constexpr std::uint32_t kProbe = 8;
// Of what a device would do of the work that is left: less leaves room for wrong rates, more makes fewer tiles.
constexpr double kShareOfRest = 0.5;
// A new rate weighs as much as all before: parts of a picture differ.
constexpr double kRateWeight = 0.5;

}  // namespace

TileQueue::TileQueue(std::uint32_t pixels, std::uint32_t passes, const std::vector<TileLimits>& devices)
    : pixels_(pixels), passes_(passes) {
  for (const TileLimits& limits : devices) {
    const std::uint32_t most = std::max(limits.most, 1U);
    devices_.push_back({{std::clamp(limits.least, 1U, most), most}, 0.0});
  }
}

std::uint64_t TileQueue::count_unassigned() const {
  std::uint64_t count = pass_ < passes_ ? std::uint64_t{passes_ - pass_} * pixels_ - next_pixel_ : 0;
  for (const Tile& tile : returned_) count += tile.count;
  return count;
}

std::uint32_t TileQueue::size_for(const Device& device) const {
  double size = device.limits.most / kProbe;
  if (device.rate > 0.0) {
    double all = 0.0;
    for (const Device& other : devices_) all += other.rate;
    size = static_cast<double>(count_unassigned()) * (device.rate / all) * kShareOfRest;
  }
  size = std::clamp<double>(size, device.limits.least, device.limits.most);
  const auto pixels = static_cast<std::uint32_t>(size);
  return pixels < kGranule ? pixels : pixels / kGranule * kGranule;
}

Tile TileQueue::cut(std::size_t device) {
  const TileLimits& limits = devices_[device].limits;
  const bool is_new = returned_.empty();
  Tile rest{pass_, next_pixel_, pixels_ - next_pixel_};
  if (!is_new) {
    rest = returned_.back();
    returned_.pop_back();
  }
  Tile tile = rest;
  tile.count = std::min(size_for(devices_[device]), rest.count);
  // No crumbs: what would be left alone is taken along.
  if (rest.count - tile.count < limits.least && rest.count <= limits.most) tile.count = rest.count;
  rest.first_pixel += tile.count;
  rest.count -= tile.count;
  if (is_new) {
    next_pixel_ = rest.first_pixel;
    if (rest.count == 0) {
      pass_++;
      next_pixel_ = 0;
    }
  } else if (rest.count > 0) {
    returned_.push_back(rest);
  }
  return tile;
}

std::optional<Tile> TileQueue::take(std::size_t device) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return abandoned_ || count_unassigned() > 0 || in_hand_ == 0; });
  if (abandoned_ || count_unassigned() == 0) return std::nullopt;
  in_hand_++;
  return cut(device);
}

void TileQueue::finish(std::size_t device, const Tile& tile, double seconds) {
  const std::lock_guard lock(mutex_);
  in_hand_--;
  done_ += tile.count;
  const double rate = tile.count / std::max(seconds, 1e-9);
  double& known = devices_[device].rate;
  known = known > 0.0 ? kRateWeight * rate + (1.0 - kRateWeight) * known : rate;
  if (in_hand_ == 0) changed_.notify_all();
}

void TileQueue::drop(std::size_t device, const std::optional<Tile>& tile) {
  const std::lock_guard lock(mutex_);
  devices_[device].rate = 0.0;
  if (tile) {
    in_hand_--;
    returned_.push_back(*tile);
  }
  changed_.notify_all();
}

void TileQueue::stop_after_pass() {
  const std::lock_guard lock(mutex_);
  const std::uint32_t begun = next_pixel_ > 0 ? pass_ + 1 : pass_;
  passes_ = std::min(passes_, std::max(begun, 1U));
}

void TileQueue::abandon() {
  const std::lock_guard lock(mutex_);
  abandoned_ = true;
  changed_.notify_all();
}

std::uint64_t TileQueue::unassigned() const {
  const std::lock_guard lock(mutex_);
  return count_unassigned();
}

double TileQueue::fraction() const {
  const std::lock_guard lock(mutex_);
  return static_cast<double>(done_) / (static_cast<double>(pixels_) * passes_);
}

std::uint32_t TileQueue::passes() const {
  const std::lock_guard lock(mutex_);
  return passes_;
}

}  // namespace hemiray

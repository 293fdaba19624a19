#include "host/path/host_film.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace hemiray {
namespace {

template <typename T>
std::vector<T> part_of(const std::vector<T>& all, std::size_t first, std::size_t count) {
  if (all.empty()) return {};
  const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
  return {begin, begin + static_cast<std::ptrdiff_t>(count)};
}

TileSums part_of(const TileSums& sums, std::size_t first, std::size_t count) {
  const Tile tile{sums.tile.pass, sums.tile.first_pixel + static_cast<std::uint32_t>(first),
                  static_cast<std::uint32_t>(count)};
  return {tile,
          part_of(sums.direct, first, count),
          part_of(sums.reflection, first, count),
          part_of(sums.refraction, first, count),
          part_of(sums.normal_depth, first, count),
          part_of(sums.albedo_object, first, count)};
}

void add_to(std::vector<shared::float4>& film, std::size_t pixel, const std::vector<shared::float4>& sums,
            std::size_t first, std::size_t count) {
  if (sums.empty()) return;
  for (std::size_t i = 0; i < count; i++) {
    shared::float4& to = film[pixel + i];
    const shared::float4& from = sums[first + i];
    to = {to.x + from.x, to.y + from.y, to.z + from.z, to.w + from.w};
  }
}

void copy_to(std::vector<shared::float4>& film, std::size_t pixel, const std::vector<shared::float4>& layer,
             std::size_t first, std::size_t count) {
  if (layer.empty()) return;
  std::copy_n(layer.begin() + static_cast<std::ptrdiff_t>(first), count,
              film.begin() + static_cast<std::ptrdiff_t>(pixel));
}

}  // namespace

HostFilm::HostFilm(std::uint32_t features, int width, int height) {
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  data_.width = width;
  data_.height = height;
  data_.direct.resize(pixels);
  if (has_feature(features, HR_FEATURE_REFLECTION)) data_.reflection.resize(pixels);
  if (has_feature(features, HR_FEATURE_REFRACTION)) data_.refraction.resize(pixels);
  data_.normal_depth.resize(pixels);
  data_.albedo_object.resize(pixels);
  passes_of_.resize(pixels);
}

void HostFilm::add(TileSums sums) {
  const std::lock_guard lock(mutex_);
  std::vector<TileSums> late = add_ready(std::move(sums));
  // What was added may have been all that others waited for.
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<TileSums> before = std::exchange(waiting_, {});
    for (TileSums& one : before) {
      const std::uint32_t count = one.tile.count;
      std::vector<TileSums> rest = add_ready(std::move(one));
      changed = changed || rest.size() != 1 || rest.front().tile.count != count;
      std::move(rest.begin(), rest.end(), std::back_inserter(waiting_));
    }
  }
  std::move(late.begin(), late.end(), std::back_inserter(waiting_));
}

std::vector<TileSums> HostFilm::add_ready(TileSums sums) {
  const auto ready = [this, &sums](std::size_t i) {
    const std::uint32_t passes = passes_of_.at(sums.tile.first_pixel + i);
    if (passes > sums.tile.pass) throw std::logic_error("a pixel sample came twice");
    return passes == sums.tile.pass;
  };
  std::vector<TileSums> late;
  for (std::size_t first = 0, end = 0; first < sums.tile.count; first = end) {
    const bool now = ready(first);
    for (end = first + 1; end < sums.tile.count && ready(end) == now;) end++;
    if (now) {
      add_run(sums, first, end - first);
    } else if (first == 0 && end == sums.tile.count) {
      late.push_back(std::move(sums));
      return late;
    } else {
      late.push_back(part_of(sums, first, end - first));
    }
  }
  return late;
}

void HostFilm::add_run(const TileSums& sums, std::size_t first, std::size_t count) {
  const std::size_t pixel = sums.tile.first_pixel + first;
  add_to(data_.direct, pixel, sums.direct, first, count);
  add_to(data_.reflection, pixel, sums.reflection, first, count);
  add_to(data_.refraction, pixel, sums.refraction, first, count);
  copy_to(data_.normal_depth, pixel, sums.normal_depth, first, count);
  copy_to(data_.albedo_object, pixel, sums.albedo_object, first, count);
  for (std::size_t i = pixel; i < pixel + count; i++) passes_of_[i]++;
  const std::size_t ahead = sums.tile.pass - complete_;
  if (pixels_.size() <= ahead) pixels_.resize(ahead + 1);
  pixels_[ahead] += count;
  while (!pixels_.empty() && pixels_.front() == passes_of_.size()) {
    pixels_.pop_front();
    complete_++;
  }
}

std::uint32_t HostFilm::complete_passes() const {
  const std::lock_guard lock(mutex_);
  return complete_;
}

std::size_t HostFilm::waiting() const {
  const std::lock_guard lock(mutex_);
  std::size_t count = 0;
  for (const TileSums& sums : waiting_) count += sums.tile.count;
  return count;
}

Image HostFilm::develop(int passes) const {
  const std::lock_guard lock(mutex_);
  return hemiray::develop(data_, passes);
}

}  // namespace hemiray

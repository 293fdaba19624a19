// Tiles: each pixel of each pass handed out once, sizes by measured rates, nothing lost with a device; and the host's
// film, which adds them in the order of the passes whatever order they come in.
#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <optional>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

#include "host/path/host_film.hpp"
#include "host/path/tile_queue.hpp"

namespace hemiray {
namespace {

/// A device of the simulation.
struct Simulated {
  double rate;  ///< pixel samples a second
  TileLimits limits;
  std::size_t fails_at = 0;  ///< its how many-th tile fails; 0: none
  double time = 0.0;         ///< when it is free [s]
  std::size_t tiles = 0;
  std::uint64_t samples = 0;
  std::vector<Tile> done{};
};

/// Runs the queue in simulated time: whoever is free first asks next. Returns when the last one ends.
double simulate(TileQueue& queue, std::vector<Simulated>& devices) {
  std::vector<bool> alive(devices.size(), true);
  while (queue.unassigned() > 0) {
    std::size_t next = devices.size();
    for (std::size_t i = 0; i < devices.size(); i++) {
      if (alive[i] && (next == devices.size() || devices[i].time < devices[next].time)) next = i;
    }
    REQUIRE(next < devices.size());
    Simulated& device = devices[next];
    const Tile tile = queue.take(next).value();
    if (++device.tiles == device.fails_at) {
      queue.drop(next, tile);
      alive[next] = false;
      continue;
    }
    const double seconds = tile.count / device.rate;
    device.time += seconds;
    device.samples += tile.count;
    device.done.push_back(tile);
    queue.finish(next, tile, seconds);
  }
  double end = 0.0;
  for (const Simulated& device : devices) end = std::max(end, device.time);
  return end;
}

/// How often each pixel of each pass was done.
std::vector<int> coverage(const std::vector<Simulated>& devices, std::uint32_t pixels, std::uint32_t passes) {
  std::vector<int> count(std::size_t{pixels} * passes, 0);
  for (const Simulated& device : devices) {
    for (const Tile& tile : device.done) {
      for (std::uint32_t i = 0; i < tile.count; i++) {
        count.at(std::size_t{tile.pass} * pixels + tile.first_pixel + i)++;
      }
    }
  }
  return count;
}

std::vector<TileLimits> limits_of(const std::vector<Simulated>& devices) {
  std::vector<TileLimits> limits;
  for (const Simulated& device : devices) limits.push_back(device.limits);
  return limits;
}

}  // namespace

TEST_CASE("tiles cover each pixel of each pass once, whatever sizes, rates and failures") {
  std::mt19937 random(1);
  const auto from_to = [&random](std::uint32_t a, std::uint32_t b) {
    return std::uniform_int_distribution<std::uint32_t>(a, b)(random);
  };
  for (int round = 0; round < 300; round++) {
    const std::uint32_t pixels = from_to(1, round % 2 == 0 ? 3000 : 60000);
    const std::uint32_t passes = from_to(1, 6);
    std::vector<Simulated> devices;
    const std::uint32_t count = from_to(1, 4);
    for (std::uint32_t i = 0; i < count; i++) {
      const std::uint32_t most = from_to(1, 20000);
      // The last one never fails.
      const std::size_t fails_at = i + 1 < count && from_to(0, 1) == 1 ? from_to(1, 4) : 0;
      devices.push_back({static_cast<double>(from_to(1, 1000)) * 1e3, {from_to(1, most), most}, fails_at});
    }
    TileQueue queue(pixels, passes, limits_of(devices));
    simulate(queue, devices);
    CAPTURE(round, pixels, passes, count);
    const std::vector<int> covered = coverage(devices, pixels, passes);
    CHECK(std::all_of(covered.begin(), covered.end(), [](int times) { return times == 1; }));
    CHECK(queue.fraction() == 1.0);
    CHECK_FALSE(queue.take(count - 1).has_value());
    for (const Simulated& device : devices) {
      for (const Tile& tile : device.done) CHECK((tile.count >= 1 && tile.count <= device.limits.most));
    }
  }
}

TEST_CASE("devices get tiles by what they deliver and end together") {
  // Rates 1 : 4 : 16, tiles of at most 65536.
  std::vector<Simulated> devices{{1e6, {2048, 65536}}, {4e6, {2048, 65536}}, {16e6, {2048, 65536}}};
  const std::uint32_t pixels = 1U << 20U;
  TileQueue queue(pixels, 4, limits_of(devices));
  const double end = simulate(queue, devices);
  const double total = 4.0 * pixels;
  const double ideal = total / 21e6;
  CHECK(end < ideal * 1.05);
  for (const Simulated& device : devices) {
    const double share = static_cast<double>(device.samples) / total;
    CHECK(share == Approx(device.rate / 21e6).epsilon(0.1));
    // Shrinking: the last tile is a small one, though large ones were to be had.
    CHECK(device.done.back().count <= 4096);
    CHECK(device.done.front().count == 65536 / 8);
    for (const Tile& tile : device.done) CHECK(tile.first_pixel % TileQueue::kGranule == 0);
  }
  const auto largest = [](const Simulated& device) {
    return std::max_element(device.done.begin(), device.done.end(),
                            [](const Tile& a, const Tile& b) { return a.count < b.count; })
        ->count;
  };
  CHECK(largest(devices[2]) == 65536);
}

TEST_CASE("a device that slows down gets smaller tiles") {
  TileQueue queue(1U << 20U, 1, {{1024, 1U << 19U}, {1024, 1U << 19U}});
  const auto run = [&queue](std::size_t device, double rate) {
    const Tile tile = queue.take(device).value();
    queue.finish(device, tile, tile.count / rate);
    return tile.count;
  };
  run(0, 1e6);
  run(1, 1e6);
  const std::uint32_t even = queue.take(0).value().count;
  CHECK(even == Approx((1U << 20U) * 0.875 / 4).epsilon(0.02));
  run(1, 1e5);
  run(1, 1e5);
  run(1, 1e5);
  const double rest = static_cast<double>(queue.unassigned());
  CHECK(run(1, 1e5) < rest * 0.11);  // its rate is a sixth by now, a quarter of the rest was its part before
}

TEST_CASE("who finds no work waits for what another one may lose") {
  TileQueue queue(512, 1, {{512, 512}, {512, 512}});
  const Tile lost = queue.take(0).value();
  CHECK(queue.unassigned() == 0);
  std::optional<Tile> got;
  std::thread waiting([&] {
    got = queue.take(1);
    if (got) queue.finish(1, *got, 1.0);
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // by then it waits
  queue.drop(0, lost);
  waiting.join();
  REQUIRE(got.has_value());
  CHECK((got->pass == 0 && got->first_pixel == 0 && got->count == lost.count));
  CHECK(queue.fraction() == 1.0);

  // And it is sent home when the other one is done, or when all is given up.
  TileQueue second(512, 1, {{512, 512}, {512, 512}});
  const Tile tile = second.take(0).value();
  std::thread idle([&second] { CHECK_FALSE(second.take(1).has_value()); });
  second.finish(0, tile, 1.0);
  idle.join();
  TileQueue third(512, 1, {{512, 512}, {512, 512}});
  CHECK(third.take(0).has_value());
  std::thread stuck([&third] { CHECK_FALSE(third.take(1).has_value()); });
  third.abandon();
  stuck.join();
}

TEST_CASE("stopping ends with the pass that is being handed out, and with the first at least") {
  TileQueue queue(1024, 5, {{256, 256}});
  queue.stop_after_pass();
  CHECK(queue.passes() == 1);
  TileQueue later(1024, 5, {{256, 256}});
  for (int i = 0; i < 5; i++) later.finish(0, later.take(0).value(), 1.0);
  later.stop_after_pass();  // one tile into the second
  CHECK(later.passes() == 2);
  for (int i = 0; i < 3; i++) {
    const Tile tile = later.take(0).value();
    CHECK(tile.pass == 1);
    later.finish(0, tile, 1.0);
  }
  later.stop_after_pass();
  CHECK(later.passes() == 2);
  CHECK_FALSE(later.take(0).has_value());
  CHECK(later.fraction() == 1.0);
}

namespace {

constexpr int kWidth = 37, kHeight = 23, kPixels = kWidth * kHeight;
constexpr std::uint32_t kPasses = 7;

/// Sums of one pass over the whole picture: values of many sizes, so that another order gives other bits.
TileSums random_pass(std::uint32_t pass, std::mt19937& random) {
  const auto value = [&random] {
    return std::ldexp(std::uniform_real_distribution<float>(0.5F, 1.0F)(random),
                      std::uniform_int_distribution<int>(-12, 12)(random));
  };
  TileSums sums{{pass, 0, kPixels}, {}, {}, {}, {}, {}};
  for (int i = 0; i < kPixels; i++) {
    sums.direct.push_back({value(), value(), value(), value()});
    sums.reflection.push_back({value(), value(), value(), 0.0F});
    if (pass == 0) sums.normal_depth.push_back({value(), value(), value(), value()});
    if (pass == 0) sums.albedo_object.push_back({value(), value(), value(), 1.0F});
  }
  return sums;
}

template <typename T>
std::vector<T> piece(const std::vector<T>& all, std::size_t first, std::size_t count) {
  if (all.empty()) return {};
  return std::vector<T>(all.begin() + static_cast<std::ptrdiff_t>(first),
                        all.begin() + static_cast<std::ptrdiff_t>(first + count));
}

bool same_bits(const Image& a, const Image& b) {
  for (std::size_t l = 0; l < a.layers.size(); l++) {
    if (!std::equal(
            a.layers[l].data.begin(), a.layers[l].data.end(), b.layers[l].data.begin(), b.layers[l].data.end(),
            [](float x, float y) { return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y); })) {
      return false;
    }
  }
  return a.layers.size() == b.layers.size();
}

}  // namespace

TEST_CASE("the host's film adds in the order of the passes, whatever comes first") {
  const std::uint32_t features = HR_FEATURE_REFLECTION;
  std::mt19937 random(7);
  std::vector<TileSums> passes;
  for (std::uint32_t pass = 0; pass < kPasses; pass++) passes.push_back(random_pass(pass, random));
  HostFilm in_order(features, kWidth, kHeight);
  for (const TileSums& pass : passes) in_order.add(pass);
  CHECK(in_order.complete_passes() == kPasses);
  const Image expected = in_order.develop(kPasses);

  for (int round = 0; round < 20; round++) {
    std::vector<TileSums> tiles;  // each pass cut elsewhere
    for (const TileSums& pass : passes) {
      for (std::uint32_t first = 0, count = 0; first < kPixels; first += count) {
        count = std::min<std::uint32_t>(std::uniform_int_distribution<std::uint32_t>(1, 300)(random), kPixels - first);
        tiles.push_back({{pass.tile.pass, first, count},
                         piece(pass.direct, first, count),
                         piece(pass.reflection, first, count),
                         {},
                         piece(pass.normal_depth, first, count),
                         piece(pass.albedo_object, first, count)});
      }
    }
    std::shuffle(tiles.begin(), tiles.end(), random);
    HostFilm film(features, kWidth, kHeight);
    std::size_t most_waiting = 0;
    for (const TileSums& tile : tiles) {
      film.add(tile);
      most_waiting = std::max(most_waiting, film.waiting());
    }
    CHECK(most_waiting > 0);
    CHECK(film.waiting() == 0);
    CHECK(film.complete_passes() == kPasses);
    CHECK(same_bits(film.develop(kPasses), expected));
  }
  HostFilm backwards(features, kWidth, kHeight);  // each pass under another one's number
  for (std::uint32_t pass = 0; pass < kPasses; pass++) {
    TileSums other = passes[kPasses - 1 - pass];
    other.tile.pass = pass;
    if (pass > 0) other.normal_depth = other.albedo_object = {};
    backwards.add(other);
  }
  CHECK_FALSE(same_bits(backwards.develop(kPasses), expected));
}

TEST_CASE("the host's film takes no pixel sample twice, and knows which passes are complete") {
  std::mt19937 random(3);
  HostFilm film(HR_FEATURE_REFLECTION, kWidth, kHeight);
  const TileSums second = random_pass(1, random);
  film.add(second);
  CHECK(film.complete_passes() == 0);
  CHECK(film.waiting() == kPixels);
  film.add(random_pass(0, random));
  CHECK(film.complete_passes() == 2);
  CHECK(film.waiting() == 0);
  CHECK_THROWS_AS(film.add(second), std::logic_error);
}

}  // namespace hemiray

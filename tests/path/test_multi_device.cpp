// One frame on several devices: the bits of a single one, whoever does which tile in which order, and whoever fails.
// The devices are two halves of the default one (where it cannot be split: the whole one, opened twice).
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/base/error.hpp"
#include "host/gpu/device_list.hpp"
#include "host/path/render.hpp"
#include "host/scene/load.hpp"
#include "tests/support/profile_file.hpp"

namespace hemiray {
namespace {

constexpr int kWidth = 64, kHeight = 40, kSamples = 4;
constexpr std::uint32_t kTilePixels = 256;  // ten tiles a pass
constexpr std::uint64_t kTiles = std::uint64_t{kWidth} * kHeight / kTilePixels * kSamples;

std::vector<DeviceInfo> two_devices() {
  const DeviceInfo whole = choose_device("");
  if (whole.compute_units < 2 || !whole.can_be_split) return {whole, whole};
  return split_device(whole, 2, "--device");
}

const Scene& scene_named(const std::string& name) {
  static std::map<std::string, Scene> scenes;
  const auto found = scenes.find(name);
  if (found != scenes.end()) return found->second;
  return scenes.emplace(name, load_scene(std::string(HR_SOURCE_DIR) + "/scenes/" + name)).first->second;
}

RenderOptions small_options(EngineKind engine = EngineKind::megakernel, bool strict = false) {
  RenderOptions options;
  options.engine = engine;
  options.strict = strict;
  options.width = kWidth;
  options.height = kHeight;
  options.spp = kSamples;
  options.depth = 4;
  options.tile_pixels = kTilePixels;
  return options;
}

Image on_one_device(const Scene& scene, const RenderOptions& options) {
  Context context(choose_device(""));
  return render_scene(context, scene, options).image;
}

/// Threads that wait for each other; gives up after 30 s, so that a mistake shows as a failure and not as a hang.
class Signal {
 public:
  void set() {
    const std::lock_guard lock(mutex_);
    is_set_ = true;
    changed_.notify_all();
  }
  void wait() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::seconds(30), [this] { return is_set_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_set_ = false;
};

void check_same_bits(const Image& a, const Image& b) {
  REQUIRE(a.layers.size() == b.layers.size());
  for (std::size_t l = 0; l < a.layers.size(); l++) {
    INFO("layer '" << a.layers[l].name << "'");
    CHECK(std::equal(
        a.layers[l].data.begin(), a.layers[l].data.end(), b.layers[l].data.begin(), b.layers[l].data.end(),
        [](float x, float y) { return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y); }));
  }
}

/// Both devices have a tile of their own before either goes on.
struct BothWork {
  std::array<Signal, 2> here;
  void operator()(std::size_t device) {
    here.at(device).set();
    here.at(1 - device).wait();
  }
};

void check_two_devices_give_the_bits_of_one(const Scene& scene, RenderOptions options) {
  INFO((options.engine == EngineKind::wavefront ? "wavefront" : "megakernel")
       << (options.strict ? ", strict" : "") << (options.rays == RayGrouping::packets ? ", packets" : ""));
  const Image expected = on_one_device(scene, options);
  BothWork both;
  options.before_tile = [&both](std::size_t device, const Tile&) { both(device); };
  const RenderResult result = render_on_devices(two_devices(), scene, options);
  check_same_bits(result.image, expected);
  CHECK(result.statistics.passes == kSamples);
  REQUIRE(result.statistics.devices.size() == 2);
  std::uint64_t tiles = 0, samples = 0;
  for (const DeviceStatistics& device : result.statistics.devices) {
    CHECK(device.tiles > 0);
    CHECK(device.failure.empty());
    tiles += device.tiles;
    samples += device.samples;
  }
  CHECK(tiles == kTiles);
  CHECK(samples == std::uint64_t{kWidth} * kHeight * kSamples);
}

}  // namespace

TEST_CASE("two devices give the bits of one: an area light") {
  for (const bool strict : {false, true}) {
    check_two_devices_give_the_bits_of_one(scene_named("cornell_box.json"),
                                           small_options(EngineKind::wavefront, strict));
    check_two_devices_give_the_bits_of_one(scene_named("cornell_box.json"),
                                           small_options(EngineKind::megakernel, strict));
  }
}

TEST_CASE("two devices give the bits of one: mirrors, glass and textures") {
  for (const bool strict : {false, true}) {
    check_two_devices_give_the_bits_of_one(scene_named("glass_and_mirror.json"),
                                           small_options(EngineKind::wavefront, strict));
    check_two_devices_give_the_bits_of_one(scene_named("glass_and_mirror.json"),
                                           small_options(EngineKind::megakernel, strict));
  }
}

// One device traces whole passes, two trace tiles: other rays share a packet.
TEST_CASE("two devices give the bits of one: rays in packets") {
  const test::ProfileFile profile(test::ProfileFile::for_all(test::kVectorLayout));
  RenderOptions options = small_options(EngineKind::wavefront);
  options.rays = RayGrouping::packets;
  for (const char* name : {"cornell_box.json", "phong_source.json", "obj_scene.json"}) {
    INFO(name);
    Scene scene = scene_named(name);
    scene.camera.fov_y_deg = 140.0;  // rays of one packet go along several axes, within the room
    scene.camera.to_world[3] = glm::dvec4(0.27, 0.27, name == std::string("cornell_box.json") ? 0.1 : 0.9, 1.0);
    for (const TriangleTest test : {TriangleTest::watertight, TriangleTest::fast}) {
      options.accel.triangle_test = test;
      check_two_devices_give_the_bits_of_one(scene, options);
    }
  }
}

TEST_CASE("passes that overtake each other change no bit") {
  const Scene& scene = scene_named("cornell_box.json");
  RenderOptions options = small_options();
  const Image expected = on_one_device(scene, options);
  // Device 0 keeps its first tile until device 1 is two passes further.
  Signal begun, ahead;
  std::atomic<std::uint32_t> slow_pass = 99, fast_pass = 0;
  options.before_tile = [&](std::size_t device, const Tile& tile) {
    if (device == 0) {
      slow_pass = std::min(slow_pass.load(), tile.pass);
      begun.set();
      ahead.wait();
    } else {
      begun.wait();
      fast_pass = std::max(fast_pass.load(), tile.pass);
      if (tile.pass >= slow_pass + 3) ahead.set();
    }
  };
  std::vector<DeviceInfo> devices = two_devices();
  const RenderResult result = render_on_devices(devices, scene, options);
  CHECK(slow_pass == 0);
  CHECK(fast_pass == 3);
  check_same_bits(result.image, expected);
}

TEST_CASE("a device that fails at its third tile is dropped and changes no bit") {
  const Scene& scene = scene_named("glass_and_mirror.json");
  RenderOptions options = small_options(EngineKind::wavefront);
  const Image expected = on_one_device(scene, options);
  Signal failed;
  int tiles_of_1 = 0;
  options.before_tile = [&](std::size_t device, const Tile&) {
    if (device == 0) return failed.wait();
    if (++tiles_of_1 < 3) return;
    failed.set();
    throw DeviceError("launching kernel x: failed with CL_OUT_OF_RESOURCES (-5)");
  };
  std::vector<std::string> lost;
  options.on_device_lost = [&lost](const std::string& message) { lost.push_back(message); };
  const std::vector<DeviceInfo> devices = two_devices();
  const RenderResult result = render_on_devices(devices, scene, options);
  check_same_bits(result.image, expected);
  REQUIRE(lost.size() == 1);
  CHECK_THAT(lost.front(), Catch::StartsWith("device " + std::to_string(devices[1].index) + " (") &&
                               Catch::Contains(label_of(devices[1])) && Catch::Contains("is dropped") &&
                               Catch::Contains("CL_OUT_OF_RESOURCES (-5)"));
  const std::vector<DeviceStatistics>& statistics = result.statistics.devices;
  REQUIRE(statistics.size() == 2);
  CHECK(statistics[0].failure.empty());
  CHECK(statistics[0].tiles == kTiles - 2);
  CHECK_THAT(statistics[1].failure, Catch::Contains("CL_OUT_OF_RESOURCES (-5)"));
  CHECK(statistics[1].tiles == 2);
  CHECK(result.statistics.passes == kSamples);
}

TEST_CASE("where every device fails the render is a device error that names them all") {
  RenderOptions options = small_options();
  std::atomic<int> tiles = 0;
  options.before_tile = [&tiles](std::size_t device, const Tile&) {
    if (++tiles > 6) throw DeviceError("broken for device " + std::to_string(device));
  };
  std::vector<std::string> lost;
  options.on_device_lost = [&lost](const std::string& message) { lost.push_back(message); };
  std::string message;
  try {
    render_on_devices(two_devices(), scene_named("cornell_box.json"), options);
  } catch (const DeviceError& error) {
    message = error.what();
  }
  CHECK_THAT(message, Catch::StartsWith("no device is left: ") && Catch::Contains("broken for device 0") &&
                          Catch::Contains("broken for device 1"));
  CHECK(message.find('\n') == std::string::npos);
  CHECK(lost.size() == 2);
}

TEST_CASE("what is no device's failure ends the render as it is") {
  RenderOptions options = small_options();
  BothWork both;
  options.before_tile = [&both](std::size_t device, const Tile&) {
    both(device);
    if (device == 1) throw InputError("--somewhere", "wrong");
  };
  CHECK_THROWS_AS(render_on_devices(two_devices(), scene_named("cornell_box.json"), options), InputError);
  // An exception of a callback, too, leaves no thread behind.
  options.before_tile = nullptr;
  options.on_progress = [](double, double) { throw std::runtime_error("enough"); };
  CHECK_THROWS_WITH(render_on_devices(two_devices(), scene_named("cornell_box.json"), options), "enough");
}

TEST_CASE("an interrupted frame keeps the passes that were begun") {
  const Scene& scene = scene_named("cornell_box.json");
  RenderOptions options = small_options();
  options.spp = 400;
  std::atomic<std::uint32_t> pass = 0;
  options.before_tile = [&pass](std::size_t, const Tile& tile) { pass = std::max(pass.load(), tile.pass); };
  options.should_stop = [&pass] { return pass >= 2; };
  double last = 0.0;
  bool rises = true, has_first = false;
  options.on_progress = [&](double fraction, double rate) {
    rises = rises && fraction >= last && fraction <= 1.0 && rate > 0.0;
    last = fraction;
  };
  options.on_first_pass = [&has_first] { has_first = true; };
  const RenderResult result = render_on_devices(two_devices(), scene, options);
  CHECK(result.statistics.interrupted);
  CHECK(result.statistics.passes >= 3);
  CHECK(result.statistics.passes < 400);
  CHECK(rises);
  CHECK(last == 1.0);
  CHECK(has_first);
  // The same bits as a render of just so many passes.
  RenderOptions whole = small_options();
  whole.spp = result.statistics.passes;
  check_same_bits(result.image, on_one_device(scene, whole));
}

TEST_CASE("devices without the memory are left out before anything is rendered") {
  const Scene& scene = scene_named("cornell_box.json");
  RenderOptions options = small_options();
  const Image expected = on_one_device(scene, options);
  std::vector<std::string> lost;
  options.on_device_lost = [&lost](const std::string& message) { lost.push_back(message); };
  std::vector<DeviceInfo> devices = two_devices();
  devices[1].global_bytes = 1 << 16;
  const RenderResult result = render_on_devices(devices, scene, options);
  check_same_bits(result.image, expected);
  REQUIRE(lost.size() == 1);
  CHECK_THAT(lost.front(), Catch::Contains("needs ") && Catch::Contains(" has 64.0 KiB"));
  REQUIRE(result.statistics.devices.size() == 2);
  CHECK(result.statistics.devices[0].tiles == kTiles);
  CHECK_FALSE(result.statistics.devices[1].failure.empty());

  // Both fit alone, but live in the same memory.
  const std::uint64_t needed = result.statistics.devices[0].predicted_bytes;
  lost.clear();
  for (DeviceInfo& device : devices) device.global_bytes = needed + needed / 2;
  check_same_bits(render_on_devices(devices, scene, options).image, expected);
  REQUIRE(lost.size() == 1);
  CHECK_THAT(lost.front(), Catch::Contains("left beside the other devices"));

  for (DeviceInfo& device : devices) device.global_bytes = 1 << 16;
  CHECK_THROWS_AS(render_on_devices(devices, scene, options), DeviceError);
}

TEST_CASE("devices of two platforms share a frame within the bound of fast builds") {
  const std::vector<DeviceInfo> devices = choose_devices("all");
  if (devices.size() < 2) {
    WARN("one OpenCL device only: not tested");
    return;
  }
  // A few ulps a value, hence outright only where a ray passes an edge that close.
  constexpr double kOutlier = 0.01, kFastOutlierShare = 0.01;
  const Scene& scene = scene_named("cornell_box.json");
  RenderOptions options = small_options(EngineKind::wavefront);
  const Image expected = on_one_device(scene, options);
  const RenderResult result = render_on_devices(devices, scene, options);
  const std::vector<float>&a = result.image.layers.front().data, &b = expected.layers.front().data;
  REQUIRE(a.size() == b.size());
  std::size_t outliers = 0;
  for (std::size_t i = 0; i < a.size(); i++) outliers += std::abs(a[i] - b[i]) > kOutlier * (std::abs(b[i]) + 0.1F);
  CHECK(static_cast<double>(outliers) <= kFastOutlierShare * static_cast<double>(a.size()));
}

}  // namespace hemiray

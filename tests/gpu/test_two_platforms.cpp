// Contexts of two platforms in one process (tools/install_intel_runtime.sh puts Intel's beside PoCL): neither disturbs
// the other, and both compute the same.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <random>
#include <set>
#include <span>
#include <vector>

#include "host/gpu/parallel.hpp"

namespace hemiray {
namespace {

// A usable device of each platform, the first of it.
std::vector<DeviceInfo> one_device_a_platform() {
  std::vector<DeviceInfo> chosen;
  std::set<std::string> platforms;
  for (const DeviceInfo& device : list_devices()) {
    if (device.usable && platforms.insert(device.platform).second) chosen.push_back(device);
  }
  return chosen;
}

struct Bench {
  explicit Bench(const DeviceInfo& device) : context(device), parallel(context) {}
  Context context;
  Parallel parallel;
};

}  // namespace

TEST_CASE("two platforms work side by side in one process") {
  const std::vector<DeviceInfo> devices = one_device_a_platform();
  REQUIRE_FALSE(devices.empty());
  if (devices.size() < 2) {
    WARN("skipped: only one OpenCL platform is here (" << devices.front().platform
                                                       << "); tools/install_intel_runtime.sh adds another");
    return;
  }
  std::vector<std::unique_ptr<Bench>> benches;
  for (const DeviceInfo& device : devices) benches.push_back(std::make_unique<Bench>(device));
  std::mt19937_64 random(5);
  for (const std::uint32_t count : {1U, 100U, 5000U}) {
    std::vector<std::uint64_t> keys(count);
    for (std::uint64_t& key : keys) key = random();
    std::vector<std::uint64_t> expected = keys;
    std::sort(expected.begin(), expected.end());
    // All devices have work queued before any is waited for.
    std::vector<Buffer<std::uint64_t>> sorted, scratch;
    for (const auto& bench : benches) {
      sorted.emplace_back(bench->context, "keys", std::span<const std::uint64_t>(keys));
      scratch.emplace_back(bench->context, "scratch", count);
      bench->parallel.sort(sorted.back(), scratch.back(), count, 0, 64);
    }
    for (std::size_t i = 0; i < benches.size(); i++) {
      INFO(devices[i].name << " of " << devices[i].platform << ", " << count << " keys");
      CHECK(sorted[i].read() == expected);
      CHECK(benches[i]->context.device().platform == devices[i].platform);
    }
  }
  // One goes, the others stay.
  const std::vector<std::uint32_t> ones(8, 1);
  while (!benches.empty()) {
    Bench& last = *benches.back();
    Buffer<std::uint32_t> sums(last.context, "sums", std::span<const std::uint32_t>(ones));
    last.parallel.exclusive_scan(sums, 7);
    CHECK(sums.read() == std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7});
    sums = Buffer<std::uint32_t>();
    benches.pop_back();
  }
}

}  // namespace hemiray

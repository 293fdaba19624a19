// The search for a profile: it finds what is fastest, keeps what is not slower, and lives with a device that fails.
#include <catch2/catch.hpp>

#include <cmath>

#include "host/base/error.hpp"
#include "host/bench/tuning.hpp"

namespace hemiray {

using namespace bench;

TEST_CASE("tuning takes each number's fastest value") {
  const auto cost = [](const DeviceProfile& p) {
    return 100.0 + (p.bvh_width == 4 ? 0.0 : 50.0) + (p.leaf_lanes == 4 ? 0.0 : 20.0) +
           (p.packet_groups == 2 ? 0.0 : 10.0) + (p.cluster_limit == 64 ? 0.0 : 10.0);
  };
  std::vector<TuningTrial> trials;
  double done = 0.0;
  const DeviceProfile best =
      tune(DeviceProfile{}, tuning_step_names(), cost, trials, [&done](double fraction) { done = fraction; });
  CHECK(best.bvh_width == 4);
  CHECK(best.leaf_lanes == 4);
  CHECK(best.packet_groups == 2);
  CHECK(best.cluster_limit == 64);
  CHECK(best.cluster_keep == 32);
  CHECK(best.rays_per_item == DeviceProfile{}.rays_per_item);
  CHECK(done == 1.0);
  int chosen = 0;
  for (const TuningTrial& trial : trials) chosen += trial.chosen ? 1 : 0;
  CHECK(chosen == static_cast<int>(tuning_step_names().size()));
}

TEST_CASE("tuning keeps what stands unless something is clearly faster") {
  const DeviceProfile start;
  const auto cost = [&start](const DeviceProfile& p) { return p.bvh_width == start.bvh_width ? 100.0 : 99.0; };
  std::vector<TuningTrial> trials;
  CHECK(tune(start, tuning_step_names(), cost, trials).bvh_width == start.bvh_width);
}

TEST_CASE("a candidate that the device cannot run is passed over") {
  const auto cost = [](const DeviceProfile& p) {
    if (p.bvh_width == 4) throw DeviceError("too much");
    return p.bvh_width == 2 ? 1.0 : 2.0;
  };
  std::vector<TuningTrial> trials;
  CHECK(tune(DeviceProfile{}, tuning_step_names(), cost, trials).bvh_width == 2);
  REQUIRE(trials.size() > 1);
  CHECK(std::isinf(trials[2].cost_ms));
}

TEST_CASE("every step varies the number it is named after, from what stands") {
  for (const std::string& name : tuning_step_names()) {
    const TuningStep step = tuning_step(name, DeviceProfile{});
    INFO(name);
    CHECK(step.candidates.size() >= 2);
    CHECK(step.name == name);
  }
  CHECK_THROWS_AS(tuning_step("colour", DeviceProfile{}), std::logic_error);
}

}  // namespace hemiray

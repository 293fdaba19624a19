// All rungs of the ladder on the device, few rays each: what holds (host/stability/bounds.cpp) must hold.
#include <catch2/catch.hpp>

#include "host/gpu/device.hpp"
#include "host/stability/ladder.hpp"

namespace hemiray::stability {
namespace {

constexpr std::uint32_t kRays = 10'000;  // a rung; rounded up to packets

void check(const std::vector<Case>& cases, bool double_precision = false) {
  Context context(choose_device(""));
  LadderOptions options;
  options.rays = double_precision ? kRays / 4 : kRays;
  options.double_precision = double_precision;
  options.threads = 2;
  Ladder ladder(context, options);
  for (const Case& one : cases) {
    for (const auto& make : one.rungs) {
      const std::optional<RungResult> asked = ladder.run(one.name, make());
      if (!asked) continue;
      const RungResult& result = *asked;
      INFO(one.name << ", " << result.rung << ", on " << context.device().name);
      for (const std::string& broken : result.broken) UNSCOPED_INFO(broken);
      CHECK(result.broken.empty());
    }
  }
}

}  // namespace

TEST_CASE("the ladder holds: places") { check(place_cases()); }
TEST_CASE("the ladder holds: shapes") { check(shape_cases()); }
TEST_CASE("the ladder holds: spheres") { check(sphere_cases()); }
TEST_CASE("the ladder holds: disks, cylinders, cones and quadrics") { check(analytic_cases()); }
TEST_CASE("the ladder holds: implicit surfaces") { check(implicit_cases()); }
TEST_CASE("the ladder holds: degenerate triangles") { check(degenerate_cases()); }
TEST_CASE("the ladder holds: leaving surfaces") { check(leaving_cases()); }
TEST_CASE("the ladder holds: instances") { check(instance_cases()); }
TEST_CASE("the ladder holds: pictures") { check(picture_cases()); }

TEST_CASE("the ladder holds in double precision") {
  if (!choose_device("").has_fp64) return;
  check(place_cases(), true);
  check(shape_cases(), true);
  check(picture_cases(), true);
}

TEST_CASE("a rung does not hold where answers are tampered with") {
  Context context(choose_device(""));
  LadderOptions options;
  options.rays = 1024;
  options.tamper = [](std::vector<shared::QueryHit>& hits) { hits[100].primitive = HR_NO_PRIMITIVE; };
  Ladder ladder(context, options);
  for (const Case& one : shape_cases()) {
    if (one.name != "closed") continue;
    const RungResult result = ladder.run(one.name, one.rungs.front()()).value();
    CHECK(result.ours.missed == 1);
    CHECK_FALSE(result.broken.empty());
  }
}

}  // namespace hemiray::stability

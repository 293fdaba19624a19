// Interleaved timing, medians, and the comparison of answers.
#include <catch2/catch.hpp>

#include "host/bench/run.hpp"
#include "tests/bench/fake_tracer.hpp"

namespace hemiray {
namespace {

using bench::Tracers;
using test::FakeTracer;

constexpr std::size_t kRays = 64 * 1000;

bench::RaySet set_of(bool any_hit, bool common_origin) {
  return {"some", std::vector<shared::QueryRay>(kRays, {{0, 0, 0, 0}, {0, 0, 1, 1}}), any_hit, common_origin};
}

FakeTracer& add(Tracers& tracers, const std::string& tree, const std::string& way,
                std::vector<std::string>* diary = nullptr) {
  tracers.push_back(std::make_unique<FakeTracer>(tree, way, diary));
  return static_cast<FakeTracer&>(*tracers.back());
}

}  // namespace

TEST_CASE("a spread is median, least and most") {
  const bench::Spread odd = bench::spread_of({5.0, 1.0, 3.0});
  CHECK(odd.median == 3.0);
  CHECK(odd.least == 1.0);
  CHECK(odd.most == 5.0);
  CHECK(odd.runs == 3);
  CHECK(bench::spread_of({4.0, 1.0, 100.0, 2.0}).median == 3.0);
  CHECK(bench::spread_of({7.0}).median == 7.0);
  CHECK_THROWS_AS(bench::spread_of({}), std::logic_error);
}

TEST_CASE("in every round each tracer takes its turn, and the first round is not counted") {
  for (const bool any_hit : {false, true}) {
    std::vector<std::string> diary;
    Tracers tracers;
    add(tracers, "a", "single", &diary);
    add(tracers, "b", "single", &diary);
    int ticks = 0;
    const auto times = bench::run_traces(tracers, set_of(any_hit, false), {2}, [&ticks] { ticks++; });
    const std::string asked = any_hit ? " occluded" : " intersect";
    std::vector<std::string> expected;
    for (int round = 0; round < 3; round++) {
      for (const char* name : {"a/single", "b/single"}) expected.push_back(name + asked);
    }
    CHECK(diary == expected);
    CHECK(ticks == 6);
    REQUIRE(times.size() == 2);
    for (const bench::TraceTimes& t : times) {
      CHECK(t.ms.runs == 2);
      CHECK(t.ray_count == kRays);
      CHECK(t.valid);
      CHECK(t.disagreements == 0);
    }
  }
}

TEST_CASE("each tree is built once untimed and then in rounds, the other tracers share it") {
  std::vector<std::string> diary;
  Tracers tracers;
  add(tracers, "a", "single", &diary);
  add(tracers, "a", "packet", &diary);
  add(tracers, "b", "single", &diary);
  add(tracers, "b", "alone", &diary).shares = false;
  const auto times = bench::run_builds(tracers, {}, {3});
  REQUIRE(times.size() == 2);
  CHECK(times[0].tree == "a");
  CHECK(times[1].tree == "b");
  CHECK(times[0].ms.runs == 3);
  CHECK(times[0].ms.median == 3.0);  // 2, 3, 4: the first, 1 ms, warms up
  CHECK(diary == std::vector<std::string>{"a/single build", "b/single build", "a/single build", "b/single build",
                                          "a/single build", "b/single build", "a/single build", "b/single build",
                                          "a/packet share", "b/alone build"});
}

TEST_CASE("rounds end early when they have taken long enough, but not before a median says something") {
  Tracers tracers;
  add(tracers, "a", "single");
  add(tracers, "b", "single");
  const bench::Effort at_once{50, 0.0}, never{5, 1e9};
  CHECK(bench::run_traces(tracers, set_of(false, false), at_once)[0].ms.runs == bench::kLeastRounds);
  CHECK(bench::run_builds(tracers, {}, at_once)[1].ms.runs == bench::kLeastRounds);
  CHECK(bench::run_traces(tracers, set_of(false, false), never)[1].ms.runs == 5);
  CHECK(bench::run_traces(tracers, set_of(false, false), {2, 0.0})[0].ms.runs == 2);
}

TEST_CASE("packets are only asked where origins are common") {
  Tracers tracers;
  add(tracers, "a", "single");
  add(tracers, "a", "packet").packets = true;
  CHECK(bench::run_traces(tracers, set_of(false, false), {1}).size() == 1);
  CHECK(bench::run_traces(tracers, set_of(false, true), {1}).size() == 2);
}

TEST_CASE("a tracer that answers otherwise than the others is not valid") {
  for (const bool any_hit : {false, true}) {
    Tracers tracers;
    add(tracers, "reference", "single");
    add(tracers, "good", "single").wrong = 12;  // of 64,000: below kMaxDisagreement
    add(tracers, "bad", "single").wrong = 13;
    const auto times = bench::run_traces(tracers, set_of(any_hit, false), {1});
    CHECK(times[0].valid);
    CHECK(times[1].valid);
    CHECK(times[1].disagreements == 12);
    CHECK_FALSE(times[2].valid);
    CHECK(times[2].disagreements == 13);
  }
}

TEST_CASE("a reference that nobody agrees with is not valid, nor is one that is alone") {
  Tracers tracers;
  add(tracers, "wrong", "single").wrong = 5000;
  CHECK_FALSE(bench::run_traces(tracers, set_of(false, false), {1})[0].valid);
  add(tracers, "right", "single");
  for (const bench::TraceTimes& t : bench::run_traces(tracers, set_of(false, false), {1})) CHECK_FALSE(t.valid);
}

TEST_CASE("hits are the same where the primitive is, or nearly the distance") {
  const auto hit = [](float t, std::uint32_t primitive) { return shared::QueryHit{t, 0, 0, primitive}; };
  CHECK(bench::same_hit(hit(1, 5), hit(2, 5)));
  CHECK(bench::same_hit(hit(1, 5), hit(1.0009F, 6)));
  CHECK_FALSE(bench::same_hit(hit(1, 5), hit(1.0011F, 6)));
  CHECK(bench::same_hit(hit(100, 5), hit(100.09F, 6)));
  CHECK(bench::same_hit(hit(1e-4F, 5), hit(9e-4F, 6)));
  CHECK_FALSE(bench::same_hit(hit(1, 5), hit(1, HR_NO_PRIMITIVE)));
  CHECK_FALSE(bench::same_hit(hit(1, HR_NO_PRIMITIVE), hit(1, 5)));
  CHECK(bench::same_hit(hit(1, HR_NO_PRIMITIVE), hit(1e30F, HR_NO_PRIMITIVE)));
  CHECK_FALSE(bench::same_hit(hit(std::numeric_limits<float>::quiet_NaN(), 5), hit(1, 6)));
  const std::vector<std::uint32_t> two(2), three(3);
  CHECK_THROWS_AS(bench::count_disagreements(two, three), std::logic_error);
}

}  // namespace hemiray

// Bars: the file, and the verdicts on it.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "host/base/error.hpp"
#include "host/base/read_file.hpp"
#include "host/bench/bars.hpp"
#include "host/bench/processor.hpp"
#include "host/bench/report.hpp"

namespace hemiray {
namespace {

using bench::Bar;
using bench::BarResult;
using bench::Verdict;
using nlohmann::json;

constexpr const char* kBars = R"({
  "hemiray_bars": 1,
  "rows": [
    {"label": "rays", "kind": "trace", "better": "higher", "rays": "primary", "ours": "device/quality/fast/single",
     "against": ["embree/medium/packet8", "embree/medium/stream"], "bars": {"avx2": {"250000": 1.5}}},
    {"label": "tree", "kind": "build", "better": "lower", "ours": "device/quality", "against": ["embree/medium"],
     "bars": {"avx2": {"250000": 0.9, "1000000": 0.7}}},
    {"label": "tight", "kind": "leaks", "better": "lower", "ours": "device/quality/watertight/single", "bar": 0}
  ]
})";

bench::TraceTimes trace(const std::string& tracer, double mrays, bool valid = true) {
  return {tracer, "primary", 1'000'000, {1e3 / mrays, 1e3 / mrays, 1e3 / mrays, 1}, 0, valid};
}

bench::BuildTimes build(const std::string& tree, double ms) { return {tree, {ms, ms, ms, 1}, {}, {}, {}}; }

// Ours: a bit over 30 Mrays/s against at most 20; a build of just under 18 ms against 20.
bench::SceneResults interior() {
  bench::SceneResults scene;
  scene.scene = "interior";
  scene.wanted_triangles = 250'000;
  scene.triangles = 249'992;
  scene.builds = {build("device/quality", 17.99), build("embree/medium", 20.0)};
  scene.traces = {trace("device/quality/fast/single", 30.01), trace("embree/medium/packet8", 12.0),
                  trace("embree/medium/stream", 20.0)};
  return scene;
}

std::vector<BarResult> judge(const bench::SceneResults& scene, const std::vector<bench::LeakResult>& leaks = {},
                             const std::string& processor_class = "avx2") {
  return bench::judge_bars(bench::parse_bars(kBars, "bars.json"), processor_class, {scene}, leaks);
}

std::string error_of(const std::string& text) {
  try {
    bench::parse_bars(text, "b.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

// kBars with the member at a JSON pointer replaced, or removed where `value` is discarded.
std::string changed(const std::string& pointer, const json& value) {
  json bars = json::parse(kBars);
  bars[json::json_pointer(pointer)] = value;
  return bars.dump();
}

}  // namespace

TEST_CASE("bars are reached by the ratio to the fastest peer, builds by a ratio that is low enough") {
  const std::vector<BarResult> results = judge(interior());
  REQUIRE(results.size() == 2);
  CHECK(results[0].verdict == Verdict::pass);
  CHECK(results[0].measured == Approx(1.5005));
  CHECK(results[0].best_peer == "embree/medium/stream");
  CHECK(results[1].verdict == Verdict::pass);
  CHECK(results[1].measured == Approx(0.8995));
  CHECK(results[1].best_peer == "embree/medium");
}

TEST_CASE("bars that are not reached fall short") {
  bench::SceneResults scene = interior();
  scene.traces[0] = trace("device/quality/fast/single", 29.9);
  scene.builds[0] = build("device/quality", 18.1);
  for (const BarResult& result : judge(scene)) CHECK(result.verdict == Verdict::fall_short);
}

TEST_CASE("a bar is invalid where a run behind it did not verify, however fast it was") {
  for (const std::size_t who : {0U, 1U, 2U}) {
    bench::SceneResults scene = interior();
    scene.traces[who].valid = false;
    INFO(scene.traces[who].tracer);
    CHECK(judge(scene)[0].verdict == Verdict::invalid);
    CHECK(judge(scene)[1].verdict == (who == 0 ? Verdict::invalid : Verdict::pass));  // a tree that traces wrongly
  }
}

TEST_CASE("a bar is not measured where a run behind it is missing") {
  bench::SceneResults scene = interior();
  scene.traces.pop_back();  // the fastest of some is not the fastest of all
  CHECK(judge(scene)[0].verdict == Verdict::not_measured);
  scene = interior();
  scene.traces.erase(scene.traces.begin());
  CHECK(judge(scene)[0].verdict == Verdict::not_measured);
  CHECK(judge(scene)[1].verdict == Verdict::invalid);  // nothing was traced through that tree
  scene = interior();
  scene.builds.clear();
  CHECK(judge(scene)[1].verdict == Verdict::not_measured);
}

TEST_CASE("bars hold the interior at their sizes on their class of processor only") {
  CHECK(judge(interior(), {}, "avx512").empty());
  bench::SceneResults other = interior();
  other.scene = "terrain";
  CHECK(judge(other).empty());
  other = interior();
  other.wanted_triangles = 250'001;
  CHECK(judge(other).empty());
  CHECK(bench::bar_sizes(bench::parse_bars(kBars, "b"), "avx2") == std::vector<std::uint32_t>{250'000, 1'000'000});
  CHECK(bench::bar_sizes(bench::parse_bars(kBars, "b"), "avx512").empty());
}

TEST_CASE("one leak anywhere misses a bar of none") {
  std::vector<bench::LeakResult> leaks{{"sphere", "edges", "device/quality/watertight/single", 64, 0, 0},
                                       {"box", "edges", "device/quality/watertight/single", 64, 0, 0},
                                       {"box", "edges", "embree/medium/robust/single", 64, 99, 99}};
  CHECK(judge(interior(), leaks)[2].verdict == Verdict::pass);
  leaks[1].any_hit_leaks = 1;
  CHECK(judge(interior(), leaks)[2].verdict == Verdict::fall_short);
  CHECK(judge(interior(), leaks)[2].measured == 1.0);
  leaks.erase(leaks.begin(), leaks.begin() + 2);
  CHECK(judge(interior(), leaks)[2].verdict == Verdict::not_measured);
}

TEST_CASE("the shipped bars hold both classes at both sizes") {
  const std::vector<std::uint8_t> bytes = read_file(HR_SOURCE_DIR "/bench/bars.json");
  const std::vector<Bar> bars =
      bench::parse_bars({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "bars.json");
  std::size_t ratios = 0;
  for (const Bar& bar : bars) {
    if (bar.kind == bench::BarKind::leaks) continue;
    ratios++;
    INFO(bar.label);
    CHECK(bar.higher_is_better == (bar.kind == bench::BarKind::trace));
    for (const char* processor_class : {"avx512", "avx2"}) {
      REQUIRE(bar.bars.contains(processor_class));
      CHECK(bar.bars.at(processor_class).size() == 2);
      for (const std::uint32_t size : {250'000U, 1'000'000U}) {
        CHECK(bar.bars.at(processor_class).at(size) > 0.5);
        CHECK(bar.bars.at(processor_class).at(size) < 3.0);
      }
    }
  }
  CHECK(ratios == 11);
  CHECK(bars.size() == 13);
}

TEST_CASE("a bars file at fault is an error that says where") {
  CHECK(error_of(kBars) == "no error");
  CHECK_THAT(error_of("{"), Catch::StartsWith("b.json:1:"));
  CHECK_THAT(error_of("[]"), Catch::Contains("not an object"));
  CHECK_THAT(error_of("{}"), Catch::Contains("\"hemiray_bars\""));
  CHECK_THAT(error_of(changed("/hemiray_bars", 2)), Catch::Contains("/hemiray_bars"));
  CHECK_THAT(error_of(changed("/rows", json::array())), Catch::Contains("/rows"));
  CHECK_THAT(error_of(changed("/rows/0/kind", "trees")), Catch::Contains("/rows/0/kind") && Catch::Contains("trees"));
  CHECK_THAT(error_of(changed("/rows/1/better", "more")), Catch::Contains("/rows/1/better"));
  CHECK_THAT(error_of(changed("/rows/1/ours", "")), Catch::Contains("/rows/1/ours"));
  CHECK_THAT(error_of(changed("/rows/1/against", json::array())), Catch::Contains("/rows/1/against"));
  CHECK_THAT(error_of(changed("/rows/1/against/0", 7)), Catch::Contains("/rows/1/against"));
  CHECK_THAT(error_of(changed("/rows/0/bars/avx2/250000", "fast")), Catch::Contains("/rows/0/bars/avx2/250000"));
  CHECK_THAT(error_of(changed("/rows/0/bars/avx2/250000", -1)), Catch::Contains("/rows/0/bars/avx2/250000"));
  CHECK_THAT(error_of(changed("/rows/0/bars/avx2/250k", 1.0)), Catch::Contains("/rows/0/bars/avx2/250k"));
  CHECK_THAT(error_of(changed("/rows/0/bars", json::object())), Catch::Contains("/rows/0/bars"));
  CHECK_THAT(error_of(changed("/rows/0/rays", nullptr)), Catch::Contains("/rows/0/rays"));
  CHECK_THAT(error_of(changed("/rows/2/bar", nullptr)), Catch::Contains("/rows/2/bar"));
}

TEST_CASE("a bar that names nobody who is measured is an error that says where, and whom it may mean") {
  const bench::BarNames known{{"device/quality/fast/single", "embree/medium/packet8", "embree/medium/stream"},
                              {"device/quality", "embree/medium"},
                              {"device/quality/watertight/single"}};
  const auto check = [&known](const std::string& pointer, const json& value) {
    bench::check_bar_names(bench::parse_bars(changed(pointer, value), "b.json"), known, "b.json");
  };
  CHECK_NOTHROW(check("/rows/0/label", "other"));
  CHECK_THROWS_AS(check("/rows/0/ours", "x"), InputError);
  CHECK_THROWS_WITH(
      check("/rows/0/ours", "device/quality/fast/singel"),
      Catch::StartsWith("b.json: /rows/0/ours: ") && Catch::Contains("did you mean \"device/quality/fast/single\""));
  CHECK_THROWS_WITH(check("/rows/0/against/1", "embree/medium/steam"),
                    Catch::StartsWith("b.json: /rows/0/against/1: ") && Catch::Contains("embree/medium/stream"));
  // Each kind of row has names of its own.
  CHECK_THROWS_WITH(check("/rows/1/ours", "device/quality/fast/single"), Catch::StartsWith("b.json: /rows/1/ours: "));
  CHECK_THROWS_WITH(check("/rows/2/ours", "device/quality/fast/single"), Catch::StartsWith("b.json: /rows/2/ours: "));
}

TEST_CASE("the processor is what /proc/cpuinfo says of it") {
  const bench::Processor big = bench::parse_processor(
      "processor\t: 0\nmodel name\t: Some Chip 9000\nflags\t\t: fpu avx2 avx512f avx512bw\n\n"
      "processor\t: 1\nmodel name\t: Some Chip 9000\nflags\t\t: fpu avx2\n");
  CHECK(big.name == "Some Chip 9000");
  CHECK(big.vector_class == "avx512");
  CHECK(bench::parse_processor("flags : sse avx avx2\n").vector_class == "avx2");
  CHECK(bench::parse_processor("flags : sse avx xavx2\n").vector_class.empty());
  CHECK(bench::parse_processor("").name == "unknown processor");
}

TEST_CASE("a report says the same as table, JSON and CSV") {
  bench::Report report;
  report.machine.processor = "Some Chip";
  report.machine.processor_class = "avx2";
  report.machine.rounds = 3;
  report.scenes = {interior()};
  report.scenes[0].scene = "a, \"b\"";
  report.scenes[0].traces[1].valid = false;
  report.scenes[0].traces[1].disagreements = 777;
  report.scenes[0].builds[0].facts = bench::TreeFacts{55.0, 9, 0.75, 0.5, 1.0, 10, 20, 2048};
  report.engines = {{"cornell_box", "wavefront", 1000, {2.0, 1.0, 3.0, 3}, true}};
  report.leaks = {{"box", "edges", "device/x", 64, 1, 2}};
  report.bars = judge(interior());

  const json parsed = json::parse(bench::report_json(report));
  CHECK(parsed["machine"]["processor"] == "Some Chip");
  CHECK(parsed["machine"]["peer"].is_null());
  const json& scene = parsed["scenes"][0];
  CHECK(scene["wanted_triangles"] == 250'000);
  CHECK(scene["traces"][0]["mrays_per_s"].get<double>() == Approx(30.01));
  CHECK(scene["traces"][1]["valid"] == false);
  CHECK(scene["traces"][1]["disagreements"] == 777);
  CHECK(scene["builds"][0]["facts"]["depth"] == 9);
  CHECK(scene["builds"][1]["facts"].is_null());
  CHECK(parsed["engines"][0]["ms"]["median"] == 2.0);
  CHECK(parsed["leaks"][0]["any_hit_leaks"] == 2);
  CHECK(parsed["bars"][0]["verdict"] == "PASS");

  const std::string table = bench::builds_table(report.scenes[0]) + bench::traces_table(report.scenes[0].traces) +
                            bench::bars_table(report.machine, report.bars);
  CHECK_THAT(table, Catch::Contains("INVALID: 777 differ") && Catch::Contains("bars for Some Chip (avx2)") &&
                        Catch::Contains("PASS") && Catch::Contains("30.01") && Catch::Contains("depth 9"));

  const std::string csv = bench::report_csv(report);
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 1 + 2 + 3 + 1 + 1);
  CHECK_THAT(csv, Catch::Contains("trace,\"a, \"\"b\"\"\",249992,primary,embree/medium/packet8,1000000,"));
  CHECK_THAT(csv, Catch::Contains(",777,0\n"));
}

}  // namespace hemiray

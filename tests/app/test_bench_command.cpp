// `hemiray bench` as a user runs it, on small scenes and few rays.
#include <algorithm>
#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/app/small_scenes.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/running_program.hpp"
#include "tests/support/temp_folder.hpp"

using hemiray::test::listing;
using hemiray::test::ProgramEnd;
using hemiray::test::ProgramResult;
using hemiray::test::run_program;
using hemiray::test::RunningProgram;
using hemiray::test::TempFolder;
using nlohmann::json;

namespace {

using Words = std::vector<std::string>;

Words small(Words more) {
  Words words{"bench", "--triangles", "10k", "--rounds", "2", "--resolution", "64"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

json read_json(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return json::parse(stream);
}

bool has_peers() {
  return run_program(small({"interior", "--peers", "--device", "nonesuch"})).err.find("libembree") == std::string::npos;
}

void check_refused(const Words& arguments, const Words& parts,
                   const std::map<std::string, std::string>& environment = {}) {
  const TempFolder folder;
  Words words = arguments;
  words.insert(words.end(), {"--json", (folder / "a.json").string(), "--csv", (folder / "a.csv").string()});
  const ProgramResult result = run_program(words, environment);
  INFO("stdout: " << result.out << "\nstderr: " << result.err);
  CHECK(result.exit_code == 2);
  CHECK(result.out.empty());
  CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
  for (const std::string& part : parts) CHECK_THAT(result.err, Catch::Contains(part));
  CHECK(listing(folder.path()).empty());
}

}  // namespace

TEST_CASE("bench measures the tracers asked for, and says what memory a build takes") {
  const TempFolder folder;
  const auto json_file = folder / "a.json";
  const ProgramResult result =
      run_program(small({"interior", "--tracers", "quality/watertight", "--json", json_file.string()}));
  INFO(result.out << result.err);
  REQUIRE(result.exit_code == 0);
  CHECK_THAT(result.out, Catch::Contains("peak device memory") && Catch::Contains("predicted"));
  const json scene = read_json(json_file)["scenes"][0];
  REQUIRE(scene["builds"].size() == 1);
  const json& memory = scene["builds"][0]["memory"];
  CHECK(memory["peak_bytes"].get<double>() == Approx(memory["predicted_bytes"].get<double>()).epsilon(0.2));
  CHECK(memory["block_buffers"] == 1);
  for (const json& trace : scene["traces"]) {
    CHECK_THAT(trace["tracer"].get<std::string>(), Catch::StartsWith("device/quality/watertight/"));
  }
}

TEST_CASE("bench lists no packets where the device has none, and says so where they are asked for") {
  const TempFolder folder;
  const auto profile = [&folder](const std::string& fields) {
    const std::string text = R"({"profiles": [{)" + fields + "}]}";
    return std::map<std::string, std::string>{{"HEMIRAY_PROFILE", folder.write("profile.json", text).string()}};
  };
  const auto json_file = folder / "a.json";
  const ProgramResult result =
      run_program(small({"terrain", "--tracers", "quality/watertight", "--json", json_file.string()}),
                  profile(R"("explicit_vectors": 0)"));
  INFO(result.out << result.err);
  REQUIRE(result.exit_code == 0);
  const json traces = read_json(json_file)["scenes"][0]["traces"];
  CHECK(traces.size() >= 5);
  for (const json& trace : traces) {
    CHECK_THAT(trace["tracer"].get<std::string>(), Catch::StartsWith("device/quality/watertight/"));
    CHECK(trace["tracer"] != "device/quality/watertight/packet");
  }
  for (const char* fields : {R"("explicit_vectors": 0)", R"("leaf_lanes": 1)"}) {
    check_refused(small({"terrain", "--tracers", "packet"}),
                  {"--tracers", "\"packet\"", "explicit_vectors 0 or leaf_lanes 1", "take single"}, profile(fields));
  }
}

TEST_CASE("bench measures a scene, verifies it, and writes JSON and CSV") {
  const TempFolder folder;
  const auto json_file = folder / "a.json", csv_file = folder / "a.csv";
  const ProgramResult result =
      run_program(small({"terrain", "--json", json_file.string(), "--csv", csv_file.string()}));
  INFO(result.out << result.err);
  REQUIRE(result.exit_code == 0);
  CHECK(result.err.empty());
  CHECK_THAT(result.out, Catch::Contains("terrain") && Catch::Contains("hemicube") && !Catch::Contains("INVALID"));
  const json report = read_json(json_file);
  CHECK(report["interrupted"] == false);
  CHECK(report["machine"]["rounds"] == 2);
  CHECK_FALSE(report["machine"]["device"].get<std::string>().empty());
  CHECK_FALSE(report["machine"]["commit"].get<std::string>().empty());
  REQUIRE(report["scenes"].size() == 1);
  const json& scene = report["scenes"][0];
  CHECK(scene["triangles"].get<double>() == Approx(10'000).epsilon(0.01));
  CHECK(scene["builds"].size() == 5);
  std::set<std::string> sets;
  for (const json& trace : scene["traces"]) {
    INFO(trace.dump());
    sets.insert(trace["rays"]);
    CHECK(trace["valid"] == true);
    CHECK(trace["mrays_per_s"].get<double>() > 0);
    CHECK(trace["ms"]["least"].get<double>() <= trace["ms"]["median"].get<double>());
    CHECK(trace["ms"]["runs"] == 2);
  }
  CHECK(sets == std::set<std::string>{"primary", "shadow", "shadow_from_light", "diffuse", "hemicube"});
  std::ifstream csv(csv_file);
  const auto lines = std::count(std::istreambuf_iterator<char>(csv), {}, '\n');
  CHECK(static_cast<std::size_t>(lines) == 1 + scene["builds"].size() + scene["traces"].size());
}

TEST_CASE("bench measures a file's triangles from its camera") {
  const TempFolder folder;
  const std::string scene = folder.write("scene.json", hemiray::test::kGlassScene).string();
  const ProgramResult result =
      run_program({"bench", scene, "--rounds", "2", "--resolution", "64", "--json", (folder / "a.json").string()});
  INFO(result.out << result.err);
  REQUIRE(result.exit_code == 0);
  const json report = read_json(folder / "a.json");
  CHECK(report["scenes"][0]["wanted_triangles"].is_null());
  CHECK(report["scenes"][0]["triangles"].get<int>() >= 4);
  CHECK_THAT(result.out, Catch::Contains("without its 1 sphere and 0 planes"));
}

TEST_CASE("bench counts leaks, and the watertight test has none") {
  const TempFolder folder;
  const ProgramResult result =
      run_program(small({"hair", "--leaks", "--leak-rays", "4096", "--json", (folder / "a.json").string()}));
  INFO(result.out << result.err);
  REQUIRE(result.exit_code == 0);
  int watertight = 0;
  const json report = read_json(folder / "a.json");
  for (const json& leak : report["leaks"]) {
    CHECK(leak["rays"] == 4096);
    if (leak["tracer"].get<std::string>().find("device/quality/watertight") == std::string::npos) continue;
    watertight++;
    CHECK(leak["closest_hit_leaks"] == 0);
    CHECK(leak["any_hit_leaks"] == 0);
  }
  CHECK(watertight >= 4 * 2);  // meshes, targets; packets, too, where there are any
  CHECK(watertight % 8 == 0);
}

TEST_CASE("bench beside Embree gives a verdict a bar, and exit code 3 where one is not reached") {
  if (!has_peers()) {
    WARN("this build has no Embree");
    return;
  }
  const TempFolder folder;
  const auto bars = [](const std::string& bar) {
    const std::string row = R"("ours": "device/quality/watertight/single", "against": ["embree/medium/single"],)"
                            R"("kind": "trace", "better": "higher", "rays": "diffuse",)";
    return R"({"hemiray_bars": 1, "rows": [{"label": "a bar", )" + row + R"("bars": {"avx512": {"10000": )" + bar +
           R"(}, "avx2": {"10000": )" + bar + "}}}]}";
  };
  const std::string low = folder.write("low.json", bars("0.0001")).string();
  const std::string high = folder.write("high.json", bars("10000")).string();
  const ProgramResult reached = run_program(small({"interior", "--quick", "--peers", "--bars=" + low}));
  INFO(reached.out << reached.err);
  if (reached.exit_code == 2 && reached.err.find("no AVX2") != std::string::npos) return;
  CHECK(reached.exit_code == 0);
  CHECK_THAT(reached.out, Catch::Contains("\nPASS ") && Catch::Contains("a bar, 10.0 k triangles") &&
                              Catch::Contains("bars for ") && Catch::Contains("Embree 3"));
  const ProgramResult missed =
      run_program(small({"interior", "--quick", "--peers", "--bars", high, "--json", (folder / "a.json").string()}));
  CHECK(missed.exit_code == 3);
  CHECK_THAT(missed.out, Catch::Contains("\nFALL SHORT "));
  CHECK(read_json(folder / "a.json")["bars"][0]["verdict"] == "FALL SHORT");
}

TEST_CASE("bench refuses what it cannot measure before it measures, and writes nothing") {
  check_refused(small({"interiour"}), {"SCENE", "did you mean \"interior\""});
  check_refused(small({"nonesuch.glb"}), {"nonesuch.glb"});
  check_refused(small({HR_SOURCE_DIR "/scenes/cornell_box.json"}), {"--triangles", "only files", "interior"});
  check_refused({"bench", "--triangles", "many"}, {"--triangles", "'many'"});
  check_refused({"bench", "--triangles", "9k"}, {"--triangles", "9k"});
  check_refused({"bench", "--triangles", "10k,30M"}, {"--triangles", "30M"});
  check_refused({"bench", "--resolution", "100"}, {"--resolution", "32"});
  check_refused({"bench", "--leaks", "--leak-rays", "100"}, {"--leak-rays", "64"});
  check_refused({"bench", "--leak-rays", "128"}, {"--leak-rays", "requires --leaks"});
  check_refused({"bench", "--rounds", "0"}, {"--rounds"});
  check_refused(small({"interior", "--bars"}), {"--bars", "--peers"});
  check_refused(small({"interior", "--plot", "/dev/null/x"}), {"--plot"});
  check_refused(small({"interior", "--device", "nonesuch"}), {"--device", "nonesuch"});
  for (const std::string several : {"split:2", "all", "0,1", "split:1"}) {
    check_refused(small({"interior", "--device", several}),
                  {"--device: '" + several + "'", "bench measures one device", "0 "});
  }
  check_refused(small({"interior"}), {"HEMIRAY_DEVICE: 'all'", "bench measures one"}, {{"HEMIRAY_DEVICE", "all"}});
  check_refused(small({"interior", "--tracers", "nonesuch"}), {"--tracers", "\"nonesuch\"", "device/quality/"});
  check_refused(small({"interior", "--tracers", "device/quality/watertight/singel"}),
                {"--tracers", "did you mean \"device/quality/watertight/single\""});
  check_refused(small({"interior", "--leaks", "--tracers", "device/fast"}), {"--tracers", "\"device/fast\""});
}

TEST_CASE("bars for leaks alone need neither peers nor the interior, but --leaks") {
  const TempFolder folder;
  const std::string bars =
      folder
          .write("bars.json", R"({"hemiray_bars": 1, "rows": [{"label": "tight", "kind": "leaks", "better": "lower",)"
                              R"("ours": "device/quality/watertight/single", "bar": 0}]})")
          .string();
  check_refused(small({"hair", "--bars", bars}), {"--bars", "--leaks"});
  const ProgramResult result =
      run_program(small({"hair", "--quick", "--leaks", "--leak-rays", "4096", "--tracers", "watertight/single",
                         "--bars", bars, "--json", (folder / "a.json").string()}));
  INFO(result.out << result.err);
  CHECK(result.exit_code == 0);
  const json judged = read_json(folder / "a.json")["bars"];
  REQUIRE(judged.size() == 1);
  CHECK(judged[0]["verdict"] == "PASS");
}

TEST_CASE("bench --peers in a build without Embree names the package") {
  if (has_peers()) return;
  check_refused(small({"interior", "--peers"}), {"--peers", "libembree-dev"});
}

TEST_CASE("bench --bars refuses a bad file, and scenes that no bar holds") {
  if (!has_peers()) return;
  const TempFolder folder;
  const std::string bad = folder.write("bad.json", R"({"hemiray_bars": 1, "rows": [{"label": 3}]})").string();
  const auto one_bar = [&folder](const std::string& ours) {
    return folder
        .write("other.json", R"({"hemiray_bars": 1, "rows": [{"label": "x", "kind": "build", "better": "lower",)"
                             R"("ours": ")" +
                                 ours + R"(", "against": ["embree/low"], "bars": {"z80": {"10000": 1}}}]})")
        .string();
  };
  check_refused(small({"interior", "--peers", "--bars", bad}), {"bad.json: /rows/0/label"});
  check_refused(small({"interior", "--peers", "--bars", (folder / "none.json").string()}), {"none.json"});
  check_refused(small({"interior", "--peers", "--bars", one_bar("device/fast")}),
                {"--bars", "no bars for this processor"});
  check_refused(small({"interior", "--peers", "--bars", one_bar("device/fats")}),
                {"other.json: /rows/0/ours", "did you mean \"device/fast\""});
  check_refused(small({"terrain", "--peers", "--bars"}), {"--bars", "interior"});
}

TEST_CASE("bench measures trees of cells beside the others, but not with --quick") {
  const TempFolder folder;
  for (const bool quick : {false, true}) {
    Words words = small({"terrain", "--json", (folder / "a.json").string()});
    if (quick) words.emplace_back("--quick");
    const ProgramResult result = run_program(words);
    INFO(result.out << result.err);
    REQUIRE(result.exit_code == 0);
    const json scene = read_json(folder / "a.json")["scenes"][0];
    for (const std::string name : {"device/octree", "device/kdtree", "device/kdtree-median"}) {
      const auto is_of = [&](const char* key) {
        return [&name, key](const json& entry) {
          return entry[key].get<std::string>().rfind(name + "/", 0) == 0 || entry[key] == name;
        };
      };
      CHECK(std::count_if(scene["builds"].begin(), scene["builds"].end(), is_of("tree")) == (quick ? 0 : 1));
      CHECK(std::count_if(scene["traces"].begin(), scene["traces"].end(), is_of("tracer")) >= (quick ? 0 : 5));
    }
    for (const json& trace : scene["traces"]) CHECK(trace["valid"] == true);
  }
}

TEST_CASE("bench that is interrupted shows and writes what is complete, without verdicts, and exits with 130") {
  const TempFolder folder;
  const std::string json_file = (folder / "a.json").string(), csv_file = (folder / "a.csv").string();
  const std::string tables = folder.write("out.txt", "").string();
  RunningProgram program({{"bench", "hair", "terrain", "--triangles", "10k", "--rounds", "1000", "--resolution", "64",
                           "--json", json_file, "--csv", csv_file},
                          {},
                          true,
                          0,
                          tables});
  program.wait_for("bench [");
  program.wait_for(" left");
  program.send(SIGINT);
  const ProgramEnd end = program.wait();
  INFO(end.err);
  CHECK_FALSE(end.by_signal);
  CHECK(end.number == 130);
  CHECK_THAT(end.err, Catch::Contains("hemiray: interrupted; what was complete is in the tables and files"));
  const json report = read_json(json_file);
  CHECK(report["interrupted"] == true);
  CHECK(report["bars"].empty());
  CHECK(report["scenes"].size() <= 1);
  std::ifstream out(tables);
  const std::string shown{std::istreambuf_iterator<char>(out), {}};
  CHECK_THAT(shown, Catch::StartsWith("device "));
  for (const json& scene : report["scenes"]) CHECK_THAT(shown, Catch::Contains(scene["scene"].get<std::string>()));
  CHECK(std::filesystem::exists(csv_file));
}

TEST_CASE("bench --plot draws PNG and SVG") {
  const TempFolder folder;
  const std::string plots = (folder / "plots").string();
  const ProgramResult result = run_program(small({"terrain", "--plot", plots}));
  INFO(result.out << result.err);
  if (result.exit_code == 2 && result.err.find("python3-matplotlib") != std::string::npos) {
    WARN("python3-matplotlib is not installed");
    return;
  }
  REQUIRE(result.exit_code == 0);
  for (const char* file : {"bench.json", "rates.png", "rates.svg", "builds.png", "builds.svg"}) {
    INFO(file);
    CHECK(std::filesystem::exists(std::filesystem::path(plots) / file));
  }
}

TEST_CASE("bench --plot without matplotlib names the package, before anything is measured") {
  const TempFolder folder;
  const ProgramResult result =
      run_program(small({"terrain", "--plot", (folder / "plots").string()}), {{"HEMIRAY_PYTHON", "/dev/null"}});
  CHECK(result.exit_code == 2);
  CHECK(result.out.empty());
  CHECK_THAT(result.err, Catch::Contains("--plot") && Catch::Contains("python3-matplotlib"));
  CHECK(listing(folder.path()).empty());
}

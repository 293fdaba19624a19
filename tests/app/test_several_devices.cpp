// `hemiray render --device split:2`, `all` and lists as a user runs them; and devices that break on the way.
#include <catch2/catch.hpp>
#include <csignal>
#include <nlohmann/json.hpp>

#include <algorithm>

#include "host/base/exr.hpp"
#include "tests/app/small_scenes.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/running_program.hpp"
#include "tests/support/temp_folder.hpp"

using namespace hemiray;
using namespace hemiray::test;
using nlohmann::json;
using Words = std::vector<std::string>;

namespace {

/// Two halves of the default device; empty where it cannot be split.
std::string two_devices() {
  const json devices = json::parse(run_program({"devices", "--json"}).out);
  for (const json& device : devices) {
    if (device["default"] == true && device["can_be_split"] == true && device["compute_units"].get<int>() >= 2) {
      return "split:2";
    }
  }
  WARN("the device cannot be split: not tested");
  return "";
}

struct Renders {
  TempFolder folder;
  std::string scene = folder.write("scene.json", kGlassScene).string();
  std::string one = (folder / "one.exr").string();
  std::string two = (folder / "two.exr").string();

  /// Large enough for several tiles a device.
  [[nodiscard]] Words words(const std::string& output, const Words& more) const {
    Words all{"render", scene, "-o", output, "--size", "240x160", "--spp", "2", "--engine", "megakernel"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
};

bool same_bits(const Image& a, const Image& b) {
  if (a.layers.size() != b.layers.size()) return false;
  return std::equal(a.layers.begin(), a.layers.end(), b.layers.begin(),
                    [](const Layer& x, const Layer& y) { return x.name == y.name && x.data == y.data; });
}

#ifdef HR_FAILING_OPENCL
/// The environment in which launches of the megakernel fail from a queue's third on.
std::map<std::string, std::string> breaking(int queues) {
  return {{"LD_PRELOAD", HR_FAILING_OPENCL},
          {"HR_FAIL_KERNEL", "path_megakernel"},
          {"HR_FAIL_LAUNCH", "3"},
          {"HR_FAIL_QUEUES", std::to_string(queues)}};
}
#endif

}  // namespace

TEST_CASE("a split device gives the same picture and says what each part did") {
  const std::string devices = two_devices();
  if (devices.empty()) return;
  const Renders renders;
  REQUIRE(run_program(renders.words(renders.one, {"--quiet"})).exit_code == 0);
  const ProgramResult result = run_program(renders.words(renders.two, {"--device", devices, "--json"}));
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  CHECK(result.err.empty());
  Image image = read_exr(renders.two);
  CHECK(same_bits(image, read_exr(renders.one)));
  const json all = json::parse(result.out);
  REQUIRE(all["devices"].size() == 2);
  double share = 0.0;
  std::uint64_t samples = 0, rays = 0;
  for (std::size_t i = 0; i < 2; i++) {
    const json& device = all["devices"][i];
    CAPTURE(device.dump());
    CHECK_THAT(device["name"].get<std::string>(), Catch::EndsWith(", part " + std::to_string(i + 1) + " of 2"));
    CHECK(device["failed"] == false);
    CHECK(device["failure"] == "");
    CHECK((device["tiles"] > 0) == (device["mrays_per_s"] > 0.0));
    CHECK(device["share"].get<double>() == Approx(device["samples"].get<double>() / (240.0 * 160.0 * 2.0)));
    share += device["share"].get<double>();
    samples += device["samples"].get<std::uint64_t>();
    rays += device["rays"]["closest"].get<std::uint64_t>();
    CHECK_THAT(image.metadata["device"], Catch::Contains(device["name"].get<std::string>()));
  }
  CHECK(share == Approx(1.0));
  CHECK(samples == 240 * 160 * 2);
  CHECK(rays == all["rays"]["closest"]);
  CHECK(all["passes"] == 2);
  CHECK(all["trace_ms"].get<double>() > 0.0);
}

TEST_CASE("the table and the timeline show every device") {
  const std::string devices = two_devices();
  if (devices.empty()) return;
  const Renders renders;
  const std::string trace = (renders.folder / "t.json").string();
  const ProgramResult result = run_program(renders.words(renders.two, {"--device", devices, "--trace", trace}));
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  for (const char* part : {", part 1 of 2", ", part 2 of 2", " tiles, ", " % of the samples"}) {
    CHECK_THAT(result.out, Catch::Contains(part));
  }
  std::map<int, int> kernels;
  std::set<std::string> processes;
  const json events = json::parse(read_whole_file(trace))["traceEvents"];
  for (const json& event : events) {
    if (event["name"] == "process_name") processes.insert(event["args"]["name"].get<std::string>());
    if (event["ph"] == "X" && event["cat"] == "kernel") kernels[event["pid"].get<int>()]++;
    if (event["ph"] == "X") CHECK(event["ts"].get<double>() > -1e3);  // [us]: since the render began
  }
  CHECK(processes.size() == 2);
  CHECK(kernels.size() == 2);
}

TEST_CASE("all devices share a picture") {
  const json listed = json::parse(run_program({"devices", "--json"}).out);
  std::set<std::string> names;
  std::string list;
  for (const json& device : listed) {
    if (device["usable"] != true) continue;
    names.insert(device["name"].get<std::string>());
    list += (list.empty() ? "" : ",") + std::to_string(device["index"].get<int>());
  }
  const Renders renders;
  for (const std::string& selector : {std::string("all"), list}) {
    CAPTURE(selector);
    const ProgramResult result = run_program(renders.words(renders.two, {"--device", selector, "--json"}));
    INFO(result.err);
    REQUIRE(result.exit_code == 0);
    std::set<std::string> used;
    const json all = json::parse(result.out);
    for (const json& device : all["devices"]) used.insert(device["name"].get<std::string>());
    CHECK(used == names);
  }
  const ProgramResult by_environment = run_program(renders.words(renders.two, {"--json"}), {{"HEMIRAY_DEVICE", "all"}});
  CHECK(json::parse(by_environment.out)["devices"].size() == names.size());
}

TEST_CASE("a wrong list of devices is one line and no picture") {
  const Renders renders;
  for (const char* selector : {"0,nonesuch", "0,0", "split:99999", "split:x", "0,"}) {
    const ProgramResult result = run_program(renders.words(renders.two, {"--device", selector}));
    CAPTURE(selector, result.err);
    CHECK(result.exit_code == 2);
    CHECK(result.out.empty());
    CHECK_THAT(result.err, Catch::StartsWith("hemiray: --device: "));
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
  }
  CHECK(listing(renders.folder.path()) == std::set<std::string>{"scene.json"});
}

TEST_CASE("help tells how to use several devices") {
  for (const char* command : {"render", "devices"}) {
    const std::string help = run_program({command, "--help"}).out;
    for (const char* word : {"--device all", "--device split:2"}) CHECK_THAT(help, Catch::Contains(word));
  }
}

TEST_CASE("an interrupt of two devices keeps the passes that were begun") {
  const std::string devices = two_devices();
  if (devices.empty()) return;
  const Renders renders;
  // So many samples would take packets, whose kernels would be compiled in the render that is interrupted.
  const auto words = [&renders](const std::string& output, const std::string& spp) {
    return Words{"render", renders.scene, "-o", output, "--size", "96x64", "--spp", spp, "--rays", "single"};
  };
  REQUIRE(run_program(words(renders.one, "2")).exit_code == 0);  // compiles, so that passes come soon
  // Tiles of a sixth of a pass, so that one is at hand nearly always.
  const std::string profile = renders.folder.write("profile.json", R"({"profiles": [{"wave_slots": 1024}]})").string();
  Words arguments = words(renders.two, "50000");
  arguments.insert(arguments.end(), {"--device", devices});
  RunningProgram program({arguments, {{"HEMIRAY_PROFILE", profile}}, true, 0, "/dev/null"});
  // A percent is many passes; the bar alone may show when a first tile is done, late enough.
  program.wait_for(std::regex(R"(render \[[#.]*\] +[1-9])"));
  program.send(SIGINT);
  const ProgramEnd end = program.wait();
  INFO(end.err);
  CHECK_FALSE(end.by_signal);
  CHECK(end.number == 130);
  CHECK_THAT(end.err, Catch::Contains("hemiray: interrupted after ") && Catch::Contains("wrote " + renders.two));
  Image image = read_exr(renders.two);
  const std::string samples = image.metadata["samples"];
  REQUIRE(std::stoi(samples) >= 2);
  REQUIRE(run_program(words(renders.one, samples)).exit_code == 0);
  CHECK(same_bits(image, read_exr(renders.one)));
}

#ifdef HR_FAILING_OPENCL
TEST_CASE("a device that breaks in the frame is dropped with a line, and the others do its part") {
  const std::string devices = two_devices();
  if (devices.empty()) return;
  const Renders renders;
  REQUIRE(run_program(renders.words(renders.one, {"--quiet"})).exit_code == 0);
  const ProgramResult result = run_program(renders.words(renders.two, {"--device", devices, "--json"}), breaking(1));
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  CHECK_THAT(result.err, Catch::StartsWith("hemiray: warning: device ") && Catch::Contains(" of 2) is dropped: ") &&
                             Catch::Contains("CL_OUT_OF_RESOURCES (-5): the device ran out of resources") &&
                             Catch::EndsWith("; the others do its part\n"));
  CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
  CHECK(same_bits(read_exr(renders.one), read_exr(renders.two)));
  int failed = 0;
  const json all = json::parse(result.out);
  for (const json& device : all["devices"]) {
    if (device["failed"] != true) continue;
    failed++;
    CHECK(device["tiles"] == 2);
    CHECK_THAT(device["failure"].get<std::string>(), Catch::Contains("path_megakernel"));
  }
  CHECK(failed == 1);
}

TEST_CASE("where every device breaks there is an error and no picture") {
  const std::string devices = two_devices();
  if (devices.empty()) return;
  const Renders renders;
  const ProgramResult result = run_program(renders.words(renders.two, {"--device", devices}), breaking(2));
  INFO(result.err);
  CHECK(result.exit_code == 1);
  CHECK(result.out.empty());
  CHECK_THAT(result.err, Catch::Contains("hemiray: no device is left: device ") && Catch::Contains("part 1 of 2") &&
                             Catch::Contains("part 2 of 2") && Catch::Contains("CL_OUT_OF_RESOURCES"));
  CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 3);  // one for each device, one for the end
  const std::size_t others = result.err.find("the others do its part");
  CHECK(others != std::string::npos);
  CHECK(result.err.find("the others do its part", others + 1) == std::string::npos);  // after the last there are none
  // So it is with one device alone.
  const ProgramResult alone =
      run_program({"render", renders.scene, "-o", renders.two, "--spp", "9", "--engine", "megakernel"}, breaking(1));
  CHECK(alone.exit_code == 1);
  CHECK_THAT(alone.err, Catch::StartsWith("hemiray: launching kernel path_megakernel"));
  CHECK(listing(renders.folder.path()) == std::set<std::string>{"scene.json"});
}
#endif

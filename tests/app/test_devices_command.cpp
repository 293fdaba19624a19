// `hemiray devices`, and choosing a device, as a user does both.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/app/small_scenes.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/temp_folder.hpp"

using hemiray::test::kMatteScene;
using hemiray::test::listing;
using hemiray::test::ProgramResult;
using hemiray::test::run_program;
using hemiray::test::TempFolder;
using nlohmann::json;

namespace {

json list_as_json(const std::map<std::string, std::string>& environment = {}) {
  const ProgramResult result = run_program({"devices", "--json"}, environment);
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  return json::parse(result.out);
}

void check_one_line(const ProgramResult& result, int exit_code, const std::vector<std::string>& parts) {
  INFO("stdout: " << result.out << "\nstderr: " << result.err);
  CHECK(result.exit_code == exit_code);
  CHECK(result.out.empty());
  CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
  for (const std::string& part : parts) CHECK_THAT(result.err, Catch::Contains(part));
}

/// Renders one tiny picture on `device` and returns the name of the device that did it.
std::string device_used(const std::string& device, const std::map<std::string, std::string>& environment = {}) {
  const TempFolder folder;
  const std::string scene = folder.write("scene.json", kMatteScene).string();
  std::vector<std::string> arguments{"render", scene, "-o",    (folder / "a.exr").string(), "--size", "4x4",
                                     "--spp",  "1",   "--json"};
  if (!device.empty()) arguments.insert(arguments.end(), {"--device", device});
  const ProgramResult result = run_program(arguments, environment);
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  return json::parse(result.out)["device"]["name"];
}

}  // namespace

TEST_CASE("devices lists every device with what would be used of it") {
  const json devices = list_as_json();
  REQUIRE(devices.is_array());
  REQUIRE_FALSE(devices.empty());
  const ProgramResult text = run_program({"devices"});
  CHECK(text.exit_code == 0);
  CHECK(text.err.empty());
  int defaults = 0;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const json& device = devices[i];
    CHECK(device["index"] == i);
    CHECK(device["global_bytes"].get<std::uint64_t>() >= device["max_allocation_bytes"].get<std::uint64_t>());
    CHECK(device["max_allocation_bytes"].get<std::uint64_t>() > 0);
    CHECK(device["profile"]["wave_slots"].get<int>() > 0);
    CHECK((device["usable"] == true || !device["why_not"].get<std::string>().empty()));
    defaults += device["default"] == true ? 1 : 0;
    for (const char* key : {"name", "platform", "driver", "kind"}) {
      CHECK_THAT(text.out, Catch::Contains(device[key].get<std::string>()));
    }
  }
  CHECK(defaults == 1);
  CHECK_THAT(text.out, Catch::Contains("(default)"));
}

TEST_CASE("a device is chosen by index, by part of a name, by kind and by HEMIRAY_DEVICE") {
  json used;
  for (const json& device : list_as_json()) {
    if (device["usable"] == true) used = device;
  }
  REQUIRE_FALSE(used.is_null());
  const std::string name = used["name"];
  const std::string index = std::to_string(used["index"].get<int>());
  CHECK(device_used(index) == name);
  CHECK(device_used(name) == name);
  std::string shouted = name.substr(0, name.size() - 1);
  std::transform(shouted.begin(), shouted.end(), shouted.begin(), [](unsigned char c) { return std::toupper(c); });
  CHECK(device_used(shouted) == name);
  CHECK(device_used("", {{"HEMIRAY_DEVICE", index}}) == name);
  CHECK(device_used(index, {{"HEMIRAY_DEVICE", "no such device"}}) == name);  // the option wins
  const std::string kind = used["kind"];
  REQUIRE((kind == "cpu" || kind == "gpu"));
  const std::string by_kind = device_used(kind);
  const json devices = list_as_json({{"HEMIRAY_DEVICE", kind}});
  for (const json& device : devices) {
    if (device["default"] == true) {
      CHECK(device["kind"] == kind);
      CHECK(device["name"] == by_kind);
    }
  }
}

TEST_CASE("a device that is not there is an error that lists those that are") {
  const json devices = list_as_json();
  const std::string name = devices[0]["name"];
  const TempFolder folder;
  const std::string scene = folder.write("scene.json", kMatteScene).string();
  const std::string output = (folder / "a.exr").string();
  check_one_line(run_program({"render", scene, "-o", output, "--device", "no such device"}), 2,
                 {"--device", "'no such device'", name});
  check_one_line(run_program({"render", scene, "-o", output, "--device", std::to_string(devices.size())}), 2,
                 {"--device", "no device " + std::to_string(devices.size()), name});
  check_one_line(run_program({"render", scene, "-o", output}, {{"HEMIRAY_DEVICE", "nonesuch"}}), 2,
                 {"HEMIRAY_DEVICE", "'nonesuch'", name});
  check_one_line(run_program({"devices"}, {{"HEMIRAY_DEVICE", "nonesuch"}}), 2, {"HEMIRAY_DEVICE", name});
  CHECK(listing(folder.path()) == std::set<std::string>{"scene.json"});
}

TEST_CASE("without any device the package to install is named") {
  const TempFolder empty;
  // The loader wants a trailing slash.
  const std::map<std::string, std::string> no_drivers{{"OCL_ICD_VENDORS", empty.path().string() + "/"},
                                                      {"OCL_ICD_FILENAMES", ""}};
  check_one_line(run_program({"devices"}, no_drivers), 1, {"no usable OpenCL device", "pocl-opencl-icd"});
  check_one_line(run_program({"devices", "--json"}, no_drivers), 1, {"pocl-opencl-icd"});
  const TempFolder folder;
  const std::string scene = folder.write("scene.json", kMatteScene).string();
  check_one_line(run_program({"render", scene, "-o", (folder / "a.exr").string()}, no_drivers), 1, {"pocl-opencl-icd"});
  CHECK(listing(folder.path()) == std::set<std::string>{"scene.json"});
}

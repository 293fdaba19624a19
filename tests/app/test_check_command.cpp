// `hemiray check` as a user runs it.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/run_program.hpp"
#include "tests/support/temp_folder.hpp"

using hemiray::test::ProgramResult;
using hemiray::test::run_program;
using hemiray::test::TempFolder;

namespace {

const std::string kCornellBox = HR_SOURCE_DIR "/scenes/cornell_box.json";

}  // namespace

TEST_CASE("check prints what is in a scene") {
  const ProgramResult result = run_program({"check", kCornellBox});
  INFO(result.out << result.err);
  CHECK(result.exit_code == 0);
  CHECK(result.err.empty());
  CHECK_THAT(result.out, Catch::StartsWith(kCornellBox + ": valid"));
  CHECK_THAT(result.out, Catch::Contains("1 area light") && Catch::Contains("512 x 512 pixels") &&
                             Catch::Contains("materials") && Catch::Contains("on the device"));
}

TEST_CASE("check --json counts the same and agrees with what a render says") {
  const ProgramResult result = run_program({"check", kCornellBox, "--json"});
  CHECK(result.exit_code == 0);
  CHECK(result.err.empty());
  const auto json = nlohmann::json::parse(result.out);
  CHECK(json["source"] == kCornellBox);
  CHECK(json["area_lights"] == 1);
  CHECK(json["spheres"] == 0);
  CHECK(json["width"] == 512);
  CHECK(json["dropped_triangles"] == 0);
  CHECK(json["notes"].empty());
  CHECK(json["bounds_max"][1].get<double>() == Approx(0.5488).margin(1e-3));  // the box's published height [m]
  CHECK(json["device_bytes"].get<std::uint64_t>() > 0);

  const TempFolder folder;
  const ProgramResult render =
      run_program({"render", kCornellBox, "-o", (folder / "a.exr").string(), "--size", "4x4", "--spp", "1", "--json"});
  INFO(render.err);
  REQUIRE(render.exit_code == 0);
  // The visible lamp is two triangles more than the meshes.
  const auto scene = nlohmann::json::parse(render.out)["scene"];
  CHECK(scene["primitives"].get<int>() == json["triangles"].get<int>() + 2);
  CHECK(scene["lights"] == 1);
}

TEST_CASE("check says what a loader assumed or left out") {
  const TempFolder folder;
  const std::string scene = folder.write("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 2 0\nf 1 2 3\nf 1 3 4\n").string();
  const ProgramResult text = run_program({"check", scene});
  CHECK(text.exit_code == 0);
  CHECK_THAT(text.out, Catch::Contains("note") && Catch::Contains("camera") && Catch::Contains("dropped"));
  const auto json = nlohmann::json::parse(run_program({"check", scene, "--json"}).out);
  CHECK(json["triangles"] == 1);
  CHECK(json["dropped_triangles"] == 1);
  CHECK(json["notes"].size() >= 2);
}

TEST_CASE("check of a bad scene is one line and exit code 2") {
  const TempFolder folder;
  const std::string scene = folder.write("bad.json", R"({"hemiray": 1, "depht": 3})").string();
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"check", scene}, std::vector<std::string>{"check", scene, "--json"}}) {
    const ProgramResult result = run_program(arguments);
    CHECK(result.exit_code == 2);
    CHECK(result.out.empty());
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
    CHECK_THAT(result.err,
               Catch::StartsWith("hemiray: " + scene + ": unknown key \"depht\"") && Catch::Contains("\"depth\""));
  }
}

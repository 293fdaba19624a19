// `hemiray solve`, `view-factors` and `render --method radiosity` as a user runs them.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "host/base/exr.hpp"
#include "host/scene/load.hpp"
#include "tests/app/small_scenes.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/temp_folder.hpp"

using namespace hemiray;
using namespace hemiray::test;

namespace {

const std::string kCornellBox = HR_SOURCE_DIR "/scenes/cornell_box.json";

// Red, green and blue of the beauty layer at a pixel.
std::array<float, 3> pixel(const Image& image, int x, int y) {
  const Layer& beauty = *image.find("");
  const std::size_t channels = beauty.channels.size();
  const float* p =
      &beauty.data[(static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)) *
                   channels];
  return {p[0], p[1], p[2]};
}

std::string read_text(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

constexpr const char* kCube = R"(v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
g bottom
f 1 2 3 4
g top
f 8 7 6 5
g sides
f 1 5 6 2
f 4 3 7 8
f 1 4 8 5
f 2 6 7 3
)";

}  // namespace

TEST_CASE("solve writes a glTF file that loads again, and tells how it converged") {
  const TempFolder folder;
  const std::string glb = (folder / "cornell.glb").string();
  const ProgramResult result =
      run_program({"solve", kCornellBox, "-o", glb, "--patches", "500", "--resolution", "16", "--json"});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  CHECK_THAT(result.err, Catch::Contains("ambient"));  // a note, and no other
  CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
  const auto json = nlohmann::json::parse(result.out);
  CHECK(json["patches"].get<int>() <= 500);
  CHECK(json["converged"] == true);
  const auto& history = json["history"];
  REQUIRE(history.size() > 2);
  CHECK(history.back()["bound"].get<double>() < 1e-4 * json["largest_radiosity"].get<double>());
  CHECK(history.back()["residual"].get<double>() < history.front()["residual"].get<double>());
  const Scene scene = load_scene(glb);
  REQUIRE(scene.meshes.size() == 1);
  CHECK(scene.meshes[0].triangles.size() == json["rows"].get<std::size_t>());
  CHECK(scene.meshes[0].colors.size() == 3 * scene.meshes[0].triangles.size());
}

TEST_CASE("solve --refine cuts patches where light varies, and tells what that gains") {
  const TempFolder folder;
  const std::string glb = (folder / "cornell.glb").string();
  const auto solve = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"solve", kCornellBox, "-o", glb, "--patches", "300"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  };
  const ProgramResult result = solve({"--refine", "500", "--residual-samples", "256", "--json"});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  const auto json = nlohmann::json::parse(result.out);
  const auto& refinement = json["refinement"];
  REQUIRE(!refinement["rounds"].empty());
  const auto& last = refinement["rounds"].back();
  CHECK(json["patches"] == last["patches"]);
  CHECK(last["patches"].get<int>() <= 500);
  CHECK(last["patches"].get<int>() > refinement["patches"].get<int>());
  CHECK(last["made_rows"].get<int>() < last["rows"].get<int>());
  CHECK(last["continuous_residual"]["rms"].get<double>() < refinement["continuous_residual"]["rms"].get<double>());
  CHECK(refinement["end"].get<std::string>().find("500 patches") != std::string::npos);
  CHECK(load_scene(glb).meshes[0].triangles.size() == json["rows"].get<std::size_t>());

  const std::string before = read_text(glb);
  const ProgramResult few = solve({"--refine", "200"});
  CHECK(few.exit_code == 2);
  CHECK_THAT(few.err, Catch::Contains("--refine: 200 patches are no more than"));
  const ProgramResult half = solve({"--refine", "500", "--factor-precision", "half"});
  CHECK(half.exit_code == 2);
  CHECK_THAT(half.err, Catch::Contains("--refine: needs form factors in single precision"));
  const ProgramResult no_room = solve({"--refine", "500", "--factor-memory", "0.1", "--form-factors", "hemicube"});
  CHECK(no_room.exit_code == 2);
  CHECK_THAT(no_room.err, Catch::Contains("--factor-memory"));
  CHECK(run_program({"render", kCornellBox, "-o", (folder / "a.exr").string(), "--refine", "500"}).exit_code == 2);
  CHECK(read_text(glb) == before);
}

TEST_CASE("render --method radiosity shows colours bleeding, and nothing of it without") {
  const TempFolder folder;
  const std::string lit = (folder / "a.exr").string(), direct = (folder / "b.exr").string();
  const ProgramResult result = run_program({"render", kCornellBox, "-o", lit, "--method", "radiosity", "--patches",
                                            "800", "--resolution", "16", "--size", "32x32", "--spp", "1", "--json"});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  CHECK(nlohmann::json::parse(result.out)["radiosity"]["converged"] == true);
  REQUIRE(run_program({"render", kCornellBox, "-o", direct, "--size", "32x32", "--spp", "1"}).exit_code == 0);
  // The ceiling beside the red wall and beside the green one.
  const auto redness = [](const std::string& file, int x) {
    const auto colour = pixel(read_exr(file), x, 3);
    return colour[0] / colour[1];
  };
  CHECK(redness(lit, 4) > 1.05F * redness(lit, 27));
  CHECK(std::abs(redness(direct, 4) / redness(direct, 27) - 1.0F) < 1e-3F);
}

TEST_CASE("view-factors gives areas their factors in every format") {
  const TempFolder folder;
  const std::string cube = folder.write("cube.obj", kCube).string(), csv = (folder / "F.csv").string(),
                    vf = (folder / "F.vf").string(), vs3 = (folder / "c.vs3").string();
  const ProgramResult result =
      run_program({"view-factors", cube, "-o", csv, "--patches", "800", "--json", "--view3d-input", vs3});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  const auto json = nlohmann::json::parse(result.out);
  CHECK(json["names"] == std::vector<std::string>{"bottom", "top", "sides"});
  CHECK(std::abs(json["factors"][0][1].get<double>() - 0.199824896) < 5e-4);
  CHECK(std::abs(json["factors"][2][0].get<double>() - 0.200043776) < 5e-4);
  for (const auto& sum : json["row_sums"]) CHECK(std::abs(sum.get<double>() - 1.0) < 1e-6);
  std::ifstream stream(csv);
  std::string line;
  std::getline(stream, line);
  CHECK(line == "from,to,area_m2,factor,geometry_error,sampling_error,visibility_error,reciprocity_error");
  const auto errors = json["factor_errors"];  // nothing hides anything in a cube
  CHECK(std::abs(errors["geometry"][0][1].get<double>() - 2e-5 * 0.199824896) < 1e-7);
  CHECK(errors["sampling"][0][1] == 0.0);
  CHECK(errors["visibility"].size() == 3);
  CHECK(errors.size() == 3);
  const auto row_errors = json["row_errors"];  // of other things: not under the same names
  CHECK(row_errors["geometry"].get<double>() > 0.0);
  CHECK(row_errors["sampling"] == 0.0);
  CHECK(row_errors["closure"].get<double>() < 1e-3);
  CHECK(row_errors.size() == 4);
  CHECK(std::filesystem::file_size(vs3) > 1000);
  const ProgramResult table = run_program({"view-factors", cube, "-o", vf, "--patches", "12"});
  CHECK(table.exit_code == 0);
  CHECK_THAT(table.out, Catch::Contains("bottom") && Catch::Contains("sum") && Catch::Contains("+- visibility"));
  const ProgramResult cubes =
      run_program({"view-factors", cube, "-o", csv, "--patches", "12", "--form-factors", "hemicube", "--json"});
  REQUIRE(cubes.exit_code == 0);
  CHECK(!nlohmann::json::parse(cubes.out).contains("factor_errors"));  // unknown is not zero
  CHECK(!nlohmann::json::parse(cubes.out).contains("row_errors"));
}

TEST_CASE("view-factors says where no area sees another, for fronts that look away") {
  const TempFolder folder;
  const std::string obj = folder
                              .write("two.obj",
                                     "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\n"
                                     "g low\nf 1 3 2\ng high\nf 4 5 6\n")
                              .string();
  const ProgramResult away = run_program({"view-factors", obj, "-o", (folder / "f.csv").string(), "--patches", "8"});
  CHECK(away.exit_code == 0);
  CHECK_THAT(away.err, Catch::Contains("no area sees another") && Catch::Contains("counter-clockwise"));
  const ProgramResult quiet =
      run_program({"view-factors", obj, "-o", (folder / "f.csv").string(), "--patches", "8", "--quiet"});
  CHECK(quiet.err.empty());
}

TEST_CASE("radiosity options that mean nothing, or cannot be, are refused and nothing is written") {
  const TempFolder folder;
  const std::string out = (folder / "a.exr").string(), glb = (folder / "a.glb").string();
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"render", kCornellBox, "-o", out, "--patches", "5"}, "--method radiosity"},
      {{"render", kCornellBox, "-o", out, "--final-gather", "8"}, "--method radiosity"},
      {{"render", kCornellBox, "-o", out, "--method", "radiosity", "--final-gather", "0"}, "--final-gather"},
      {{"solve", kCornellBox, "-o", glb, "--final-gather", "8"}, "--final-gather"},
      {{"solve", kCornellBox, "-o", out}, ".glb"},
      {{"solve", kCornellBox, "-o", glb, "--points", "3"}, "--points"},
      {{"solve", kCornellBox, "-o", glb, "--resolution", "9"}, "even"},
      {{"solve", kCornellBox, "-o", glb, "--form-factors", "raster", "--cells", "jittered"}, "--cells"},
      {{"solve", kCornellBox, "-o", glb, "--form-factors", "rastered"}, "raster"},
      {{"solve", kCornellBox, "-o", glb, "--tolerance", "nan"}, "--tolerance"},
      {{"solve", kCornellBox, "-o", glb, "--patches", "0"}, "--patches"},
      {{"solve", kCornellBox, "-o", glb, "--save-every", "5"}, "--save-every: is for a file of --save"},
      {{"solve", kCornellBox, "-o", glb, "--solver", "jacobi", "--shots", "4"}, "--shots: is for --solver southwell"},
      {{"solve", kCornellBox, "-o", glb, "--solver", "cg", "--pick", "power"}, "--pick: is for --solver southwell"},
      {{"view-factors", kCornellBox, "-o", "a.csv", "--form-factors", "hemicube", "--pair-rays", "64"}, "--pair-rays"},
      {{"view-factors", kCornellBox, "-o", "a.csv", "--form-factors", "raster", "--pair-search", "rays"},
       "--pair-search"},
      {{"view-factors", kCornellBox, "-o", "a.npy", "--view3d-input", "./a.npy"}, "--view3d-input: 'a.npy' is for the"},
      {{"solve", kCornellBox, "-o", glb, "--form-factors", "raster", "--solver", "cg"}, "--solver: cg needs symmetric"},
      {{"solve", kCornellBox, "-o", glb, "--edge", "0"}, "--edge"},
      {{"solve", kCornellBox, "-o", glb, "--factor-memory", "0"}, "--factor-memory"},
      {{"solve", kCornellBox, "-o", glb, "--exposure", "0"}, "--exposure"},
      {{"solve", kCornellBox, "-o", glb, "--edge", "0.2", "--patches", "9"}, "--patches: does not go with --edge"},
      {{"solve", kCornellBox, "-o", glb, "--display", "flat", "--crease", "9"}, "--crease: is for --display smooth"},
      {{"view-factors", kCornellBox, "-o", glb}, ".csv"},
      {{"view-factors", "--refine", "300", kCornellBox, "-o", "a.csv"},
       "hemiray: \"--refine\" is not an option of 'view-factors'; see 'hemiray view-factors --help'"},
      {{"view-factors", kCornellBox, "-o", "a.csv", "--resolutoin=16"},
       "\"--resolutoin\" is not an option of 'view-factors'; did you mean --resolution?"},
      {{"solve", kCornellBox, "-o", glb, "two.json"}, "\"two.json\" is one argument too many"},
  };
  for (const auto& [arguments, said] : cases) {
    const ProgramResult result = run_program(arguments);
    INFO(result.err);
    CHECK(result.exit_code == 2);
    CHECK_THAT(result.err, Catch::Contains(said));
    CHECK(listing(folder.path()).empty());
  }
}

TEST_CASE("render --method radiosity shows what a translucent wall passes, and whitted says that it does not") {
  // Two closed cubes; with these emissions all of the second one sends B' = 0.4 * 10 / 0.7, the wall's back among it
  // (tests/radiosity/test_translucency.cpp has the equations).
  const std::string text = R"({
    "hemiray": 1, "ambient": 0.25,
    "camera": { "position": [1.6, 0.5, 0.5], "look_at": [1, 0.4, 0.5], "fov": 100, "size": [12, 12] },
    "materials": {
      "first": { "kd": 0.5, "emission": 1.5915494 }, "second": { "kd": 0.5, "emission": 0.9094568 },
      "paper": { "kd": 0.3, "translucency": 0.4, "emission": 1.5006036 } },
    "objects": [
      { "type": "quad", "material": "first", "corner": [0, 0, 0], "edge_u": [0, 1, 0], "edge_v": [0, 0, 1] },
      { "type": "quad", "material": "first", "corner": [0, 0, 0], "edge_u": [0, 0, 1], "edge_v": [1, 0, 0] },
      { "type": "quad", "material": "first", "corner": [0, 1, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1] },
      { "type": "quad", "material": "first", "corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0] },
      { "type": "quad", "material": "first", "corner": [0, 0, 1], "edge_u": [0, 1, 0], "edge_v": [1, 0, 0] },
      { "type": "quad", "material": "second", "corner": [2, 0, 0], "edge_u": [0, 0, 1], "edge_v": [0, 1, 0] },
      { "type": "quad", "material": "second", "corner": [1, 0, 0], "edge_u": [0, 0, 1], "edge_v": [1, 0, 0] },
      { "type": "quad", "material": "second", "corner": [1, 1, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1] },
      { "type": "quad", "material": "second", "corner": [1, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0] },
      { "type": "quad", "material": "second", "corner": [1, 0, 1], "edge_u": [0, 1, 0], "edge_v": [1, 0, 0] },
      { "type": "quad", "material": "paper", "corner": [1, 0, 0], "edge_u": [0, 0, 1], "edge_v": [0, 1, 0] } ] })";
  const TempFolder folder;
  const std::string scene = folder.write("rooms.json", text).string(), exr = (folder / "a.exr").string();
  const ProgramResult lit = run_program({"render", scene, "-o", exr, "--method", "radiosity", "--patches", "200",
                                         "--spp", "1", "--json", "--display", "flat"});
  INFO(lit.err);
  REQUIRE(lit.exit_code == 0);
  const Image image = read_exr(exr);
  constexpr float kExpected = 0.4F * 10.0F / 0.7F * 0.318309886F;
  for (int y = 0; y < 12; y++) {
    for (int x = 0; x < 12; x++) CHECK(std::abs(pixel(image, x, y)[1] - kExpected) < 1e-3F * kExpected);
  }
  CHECK_THAT(lit.err, Catch::Contains("leaves out the scene's ambient light of 0.25"));
  CHECK_THAT(nlohmann::json::parse(lit.out)["radiosity"]["notes"].dump(), Catch::Contains("ambient light of 0.25"));
  const ProgramResult solved =
      run_program({"solve", scene, "-o", (folder / "a.glb").string(), "--patches", "200", "--json"});
  REQUIRE(solved.exit_code == 0);
  CHECK_THAT(solved.err, Catch::Contains("ambient light of 0.25"));
  CHECK_THAT(nlohmann::json::parse(solved.out)["notes"].dump(), Catch::Contains("ambient light of 0.25"));
  const ProgramResult whitted = run_program({"render", scene, "-o", exr, "--spp", "1"});
  REQUIRE(whitted.exit_code == 0);
  CHECK_THAT(whitted.err, Catch::Contains("translucency is left out") && !Catch::Contains("ambient"));
  std::string bright = text;
  bright.replace(bright.find("0.4, \"emission"), 3, "0.7");
  const ProgramResult refused = run_program({"check", folder.write("bright.json", bright).string()});
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Catch::Contains("/materials/paper/translucency") && Catch::Contains("below 1"));
}

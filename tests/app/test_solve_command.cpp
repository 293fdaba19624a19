// `hemiray solve` as a user runs it: solvers by name, and what the report says of them.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/run_program.hpp"
#include "tests/support/temp_folder.hpp"

using hemiray::test::ProgramResult;
using hemiray::test::run_program;
using hemiray::test::TempFolder;

namespace {

ProgramResult solve(const TempFolder& folder, const std::vector<std::string>& more) {
  std::vector<std::string> arguments = {"solve",        HR_SOURCE_DIR "/scenes/cornell_box.json",
                                        "-o",           (folder / "a.glb").string(),
                                        "--patches",    "200",
                                        "--resolution", "32",
                                        "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_program(arguments);
}

}  // namespace

TEST_CASE("solve --json tells the solver, how it converged, and what the mesh costs") {
  const TempFolder folder;
  for (const std::string solver : {"auto", "gauss-seidel", "southwell"}) {
    const ProgramResult result = solve(folder, {"--solver", solver, "--residual-samples", "256"});
    INFO(result.out << result.err);
    REQUIRE(result.exit_code == 0);
    const auto json = nlohmann::json::parse(result.out);
    CHECK(json["converged"] == true);
    if (solver == "auto") {
      CHECK(json["solver_why"] != "");
    } else {
      CHECK(json["solver"] == solver);
    }
    const auto& history = json["history"];
    REQUIRE(history.size() > 2);
    CHECK(history.front()["iteration"] == 0);
    for (std::size_t i = 1; i < history.size(); i++) {
      CHECK(history[i]["iteration"] > history[i - 1]["iteration"]);
      CHECK(history[i]["seconds"] >= history[i - 1]["seconds"]);
    }
    CHECK(history.back()["bound"].get<double>() <= 1e-4 * json["largest_radiosity"].get<double>());
    CHECK(history.back()["residual"].get<double>() < history.front()["residual"].get<double>());
    const auto& mesh = json["continuous_residual"];
    CHECK(mesh["samples"] == 256);
    CHECK(mesh["rms_low"] <= mesh["rms"]);
    CHECK(mesh["rms_high"] > 0.0);
  }
}

TEST_CASE("a solution that is stopped early is kept, with its ambient light") {
  const TempFolder folder;
  const ProgramResult result = solve(folder, {"--solver", "southwell", "--iterations", "3", "--residual-samples", "0"});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  const auto json = nlohmann::json::parse(result.out);
  CHECK(json["converged"] == false);
  CHECK(json["history"].back()["iteration"] == 3);
  CHECK(json["unshot_w"].get<double>() > 0.0);
  CHECK(json["ambient"][0].get<double>() > 0.0);
  CHECK_FALSE(json.contains("continuous_residual"));
}

TEST_CASE("solve --factor-precision half tells its error and what it saves, and that rows on demand are single") {
  const TempFolder folder;
  const ProgramResult result = solve(folder, {"--factor-precision", "half", "--residual-samples", "0"});
  INFO(result.out << result.err);
  REQUIRE(result.exit_code == 0);
  const auto json = nlohmann::json::parse(result.out);
  CHECK(json["factor_precision"] == "half");
  CHECK(json["solver"] == "cg");
  const auto& rounding = json["factor_rounding"];
  CHECK(rounding["bytes_saved"].get<double>() > 0.2 * json["factor_bytes"].get<double>());
  CHECK(rounding["mean_relative"].get<double>() < 0x1p-11);
  CHECK(rounding["radiosity_bound"].get<double>() < 1e-2 * json["largest_radiosity"].get<double>());
  const ProgramResult shot = solve(folder, {"--factor-precision", "half", "--factor-memory", "0.01"});
  REQUIRE(shot.exit_code == 0);
  CHECK(nlohmann::json::parse(shot.out)["factor_precision"] == "single");
  const ProgramResult refused = solve(folder, {"--factor-precision", "double"});
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Catch::Contains("--factor-precision") && Catch::Contains("half"));
}

TEST_CASE("solve computes factors on demand where they do not fit, or says what to do") {
  const TempFolder folder;
  const std::vector<std::string> tight = {"--factor-memory", "0.01"};
  const ProgramResult result = solve(folder, tight);
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  CHECK(nlohmann::json::parse(result.out)["on_demand"] == true);
  const ProgramResult refused = solve(folder, {"--factor-memory", "0.01", "--solver", "gmres"});
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Catch::Contains("--factor-memory"));
  CHECK(solve(folder, {"--form-factors", "hemicube", "--solver", "cg"}).exit_code ==
        2);  // hemicubes' factors are not symmetric
  CHECK(solve(folder, {"--shots", "0"}).exit_code == 2);
  CHECK(solve(folder, {"--residual-samples", "1"}).exit_code == 2);
}

// `hemiray stability` as a user runs it, on one ladder.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/app/small_scenes.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/temp_folder.hpp"

using hemiray::test::listing;
using hemiray::test::ProgramResult;
using hemiray::test::run_program;
using hemiray::test::TempFolder;
using nlohmann::json;

TEST_CASE("stability tells the rates of every rung as a table, JSON and Markdown") {
  const TempFolder folder;
  for (const std::string precision : {"single", "double"}) {
    const std::string json_file = (folder / "s.json").string(), markdown = (folder / "s.md").string();
    const ProgramResult result = run_program({"stability", "--rays", "1024", "--cases", "slivers", "--precision",
                                              precision, "--json", json_file, "--markdown", markdown});
    INFO(result.out << result.err);
    if (result.exit_code == 1 && result.err.find("has no double precision") != std::string::npos) continue;
    REQUIRE(result.exit_code == 0);
    CHECK(result.err.empty());
    std::ifstream stream(json_file);
    const json report = json::parse(stream);
    CHECK(report["precision"] == precision);
    CHECK(report["complete"] == false);
    CHECK(report["holds"] == true);
    REQUIRE(report["cases"].size() == 1);
    REQUIRE(report["cases"][0]["rungs"].size() == 6);
    for (const json& rung : report["cases"][0]["rungs"]) {
      for (const char* key : {"missed", "false_hit", "wrong_surface", "self_hit", "tunnelled"}) {
        INFO(rung.dump());
        CHECK(rung.dump().find("\"" + std::string(key) + "\"") != std::string::npos);
      }
      CHECK(rung.dump().find("\"worst_ulps\"") != std::string::npos);
    }
    std::stringstream text;
    text << std::ifstream(markdown).rdbuf();
    CHECK_THAT(text.str(), Catch::StartsWith("# Stability") && Catch::Contains("## slivers") &&
                               Catch::Contains("some are left out"));
  }
}

TEST_CASE("stability refuses cases that are none and files that cannot be written, and writes nothing") {
  const TempFolder folder;
  const ProgramResult unknown = run_program({"stability", "--rays", "1024", "--cases", "scael"});
  CHECK(unknown.exit_code == 2);
  CHECK_THAT(unknown.err, Catch::Contains("--cases") && Catch::Contains("did you mean \"scale\""));
  const ProgramResult nowhere =
      run_program({"stability", "--rays", "1024", "--cases", "scale", "--json", (folder / "no" / "s.json").string()});
  CHECK(nowhere.exit_code == 2);
  CHECK_THAT(nowhere.err, Catch::Contains("s.json"));
  CHECK(run_program({"stability", "--rays", "3"}).exit_code == 2);
  CHECK(listing(folder.path()).empty());
}

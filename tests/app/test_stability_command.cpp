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
    REQUIRE(report["cases"].size() == 2);  // and "slivers, few"
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
                               Catch::Contains("some are left out") &&
                               Catch::Contains("`hemiray stability --cases \"slivers\" --rays 1024 "));
  }
}

TEST_CASE("stability names the rungs on which another run differs, in text, JSON and Markdown") {
  const TempFolder folder;
  const std::string first = (folder / "a.json").string(), second = (folder / "b.json").string();
  const std::string markdown = (folder / "s.md").string();
  const std::vector<std::string> small{"stability", "--rays", "1024", "--cases", "one Morton"};
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(), small.begin(), small.end());
    return run_program(more);
  };
  REQUIRE(run({"--json", first}).exit_code == 0);
  const ProgramResult same = run({"--compare", first});
  INFO(same.out << same.err);
  CHECK(same.exit_code == 0);
  CHECK_THAT(same.out, Catch::Contains("4 rungs compared, 0 differ") && !Catch::Contains("other bits"));

  json planted = json::parse(std::ifstream(first));
  planted["cases"][0]["rungs"][1]["counts"]["missed"] = 7;
  planted["cases"][0]["rungs"][2]["answers"] = "0";
  std::ofstream(second) << planted.dump();
  const ProgramResult other = run({"--compare", first + "," + second, "--json", first, "--markdown", markdown});
  INFO(other.out << other.err);
  CHECK(other.exit_code == 0);
  CHECK_THAT(other.out, Catch::Contains("one Morton code, 1e-2: here and there missed 0 and 7") &&
                            Catch::Contains("one Morton code (1e-4)"));
  const json report = json::parse(std::ifstream(first));
  REQUIRE(report["comparisons"].size() == 2);
  CHECK(report["comparisons"][0]["differences"].empty());
  CHECK(report["comparisons"][1]["differences"][0]["rung"] == "1e-2");
  std::stringstream text;
  text << std::ifstream(markdown).rdbuf();
  CHECK_THAT(text.str(), Catch::Contains("## Across devices") && Catch::Contains("missed 0 and 7"));

  const ProgramResult wrong = run({"--strict", "--compare", first});
  CHECK(wrong.exit_code == 2);
  CHECK_THAT(wrong.err, Catch::Contains("a.json") && Catch::Contains("was made with other rays") &&
                            Catch::Contains("--seed 5 --precision single, without --strict"));
  const ProgramResult apart = run_program({"stability", "--rays", "1024", "--cases", "scale", "--compare", first});
  CHECK(apart.exit_code == 2);
  CHECK_THAT(apart.err, Catch::Contains("a.json") && Catch::Contains("none of the cases"));
  CHECK(run({"--compare", markdown}).exit_code == 2);
  CHECK(run({"--compare", (folder / "none.json").string()}).exit_code == 2);
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
  CHECK(run_program({"stability", "--cases", ""}).exit_code == 2);
  const ProgramResult leaving =
      run_program({"stability", "--rays", "64", "--cases", "leaving", "--precision", "double"});
  CHECK(leaving.exit_code == 2);
  CHECK_THAT(leaving.err, Catch::Contains("--cases") && Catch::Contains("--precision single"));
  CHECK(listing(folder.path()).empty());
}

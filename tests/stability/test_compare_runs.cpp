// Two runs of the ladder side by side: a rung on which they differ is named.
#include <catch2/catch.hpp>

#include <nlohmann/json.hpp>

#include "host/base/error.hpp"
#include "host/gpu/device.hpp"
#include "host/gpu/device_list.hpp"
#include "host/stability/compare_runs.hpp"

namespace hemiray::stability {
namespace {

using nlohmann::json;

Report small_report() {
  Report report;
  report.machine.device = "one";
  report.rays = 1024;
  report.seed = 5;
  CaseResults gap{"gap", "Two sheets.", {}};
  for (const char* name : {"1e-2", "1e-6"}) {
    RungResult rung;
    rung.case_name = "gap";
    rung.rung = name;
    rung.ours.rays = 1024;
    rung.answers = "0000000000000011";
    gap.rungs.push_back(rung);
  }
  report.cases.push_back(gap);
  return report;
}

Comparison compare_with(const Report& ours, const json& theirs) {
  return compare_runs(ours, read_run(theirs.dump(), "other.json", ours));
}

}  // namespace

TEST_CASE("a run is the same as itself") {
  const Report report = small_report();
  const Comparison same = compare_with(report, json::parse(report_json(report)));
  CHECK(same.device == "one");
  CHECK(same.compared == 2);
  CHECK(same.differences.empty());
  CHECK(same.other_answers.empty());
  CHECK_THAT(comparison_markdown(same), Catch::Contains("on none of 2 rungs") && Catch::Contains("same to the bit"));
}

TEST_CASE("rungs that differ by a rate, a verdict or answers are named") {
  const Report report = small_report();
  json other = json::parse(report_json(report));
  json& rungs = other["cases"][0]["rungs"];
  rungs[1]["answers"] = "0000000000000012";
  Comparison found = compare_with(report, other);
  CHECK(found.differences.empty());
  REQUIRE(found.other_answers.size() == 1);
  CHECK(found.other_answers[0].rung == "1e-6");
  CHECK_THAT(comparison_markdown(found), Catch::Contains("gap (1e-6)"));

  rungs[1]["counts"]["tunnelled"] = 3;
  rungs[0]["holds"] = false;
  found = compare_with(report, other);
  CHECK(found.other_answers.empty());
  REQUIRE(found.differences.size() == 2);
  CHECK(found.differences[0].what == std::vector<std::string>{"holds and FAILS"});
  CHECK(found.differences[1].what == std::vector<std::string>{"tunnelled 0 and 3"});
  for (const std::string& text : {comparison_text(found), comparison_markdown(found)}) {
    CHECK_THAT(text, Catch::Contains("tunnelled 0 and 3") && Catch::Contains("1e-6"));
  }

  rungs.erase(1);
  CHECK(compare_with(report, other).compared == 1);
}

TEST_CASE("runs of other rays, and what is no run, are refused") {
  const Report report = small_report();
  const json good = json::parse(report_json(report));
  for (const auto& [key, value] :
       {std::pair<const char*, json>{"rays", 2048}, {"seed", 6}, {"precision", "double"}, {"strict", true}}) {
    json other = good;
    other[key] = value;
    INFO(key);
    CHECK_THROWS_AS(compare_with(report, other), InputError);
    other.erase(key);
    CHECK_THROWS_AS(compare_with(report, other), InputError);
  }
  json other = good;
  other["cases"][0]["rungs"][0].erase("answers");
  CHECK_THROWS_AS(compare_with(report, other), InputError);
  CHECK_THROWS_AS(read_run("{", "other.json", report), InputError);
  CHECK_THROWS_AS(read_run("[]", "other.json", report), InputError);
}

TEST_CASE("answers that differ in one bit have another hash, those that differ in the sign of a zero the same") {
  const auto hash = [](std::vector<float> answers) {
    AnswerHash all;
    all.add(std::span<const float>(answers));
    return all.text();
  };
  CHECK(hash({1.0F, 0.0F}) == hash({1.0F, -0.0F}));
  CHECK(hash({1.0F, 0.0F}) != hash({0.0F, 1.0F}));
  CHECK(hash({1.0F}) != hash({1.0F + 0x1p-23F}));
  CHECK(hash({}) != hash({0.0F}));
}

}  // namespace hemiray::stability

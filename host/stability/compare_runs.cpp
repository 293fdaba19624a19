#include "host/stability/compare_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "host/base/error.hpp"
#include "host/base/json_text.hpp"
#include "host/stability/bounds.hpp"

namespace hemiray::stability {
namespace {

using nlohmann::json;

constexpr int kMaxDepth = 8;

const OtherRung* find_rung(const OtherRun& other, const RungResult& rung) {
  const auto found = std::find_if(other.rungs.begin(), other.rungs.end(), [&](const OtherRung& one) {
    return one.case_name == rung.case_name && one.rung == rung.rung;
  });
  return found == other.rungs.end() ? nullptr : &*found;
}

std::vector<std::string> differing(const RungResult& ours, const OtherRung& theirs) {
  std::vector<std::string> what;
  for (const HeldRate& rate : kHeldRates) {
    const auto found = std::find_if(theirs.counts.begin(), theirs.counts.end(),
                                    [&](const auto& count) { return count.first == rate.name; });
    const std::uint64_t here = ours.ours.*rate.count;
    if (found == theirs.counts.end() || found->second == here) continue;
    what.push_back(fmt::format("{} {} and {}", rate.name, here, found->second));
  }
  const auto verdict = [](bool holds) { return holds ? "holds" : "FAILS"; };
  if (ours.broken.empty() != theirs.holds) {
    what.push_back(fmt::format("{} and {}", verdict(ours.broken.empty()), verdict(theirs.holds)));
  }
  return what;
}

std::size_t count_cases(const std::vector<RungDifference>& rungs) {
  std::set<std::string> names;
  for (const RungDifference& one : rungs) names.insert(one.case_name);
  return names.size();
}

// "scale (1e-6, 1), gap (2e-7)".
std::string by_case(const std::vector<RungDifference>& rungs) {
  std::string text;
  for (std::size_t i = 0; i < rungs.size(); i++) {
    const bool same = i > 0 && rungs[i].case_name == rungs[i - 1].case_name;
    if (!same && i > 0) text += "), ";
    text += same ? ", " + rungs[i].rung : fmt::format("{} ({}", rungs[i].case_name, rungs[i].rung);
  }
  return rungs.empty() ? text : text + ")";
}

OtherRung read_rung(const json& rung, const std::string& case_name) {
  OtherRung read{case_name, rung.at("rung"), rung.at("holds"), {}, rung.at("answers")};
  const json& counts = rung.at("counts");
  for (const HeldRate& rate : kHeldRates) {
    read.counts.emplace_back(rate.name, counts.at(std::string(rate.name)).get<std::uint64_t>());
  }
  return read;
}

}  // namespace

OtherRun read_run(const std::string& text, const std::string& place, const Report& like) {
  const json run = parse_json_text(text, place, kMaxDepth);
  OtherRun other;
  try {
    if (run.at("rays") != like.rays || run.at("seed") != like.seed || run.at("precision") != like.precision ||
        run.at("strict") != like.strict) {
      const bool strict = run.at("strict").get<bool>();
      throw InputError(place,
                       fmt::format("was made with other rays; run with --rays {} --seed {} --precision {}{}",
                                   run.at("rays").dump(), run.at("seed").dump(), run.at("precision").get<std::string>(),
                                   strict ? " --strict" : ", without --strict"));
    }
    other = {run.at("device"), run.at("platform"), run.at("driver"), run.at("commit"), {}};
    for (const json& one : run.at("cases")) {
      for (const json& rung : one.at("rungs")) other.rungs.push_back(read_rung(rung, one.at("case")));
    }
  } catch (const json::exception&) {
    throw InputError(place, "is not what `hemiray stability --json` writes");
  }
  return other;
}

Comparison compare_runs(const Report& ours, const OtherRun& other) {
  Comparison comparison{other.device, other.platform, other.driver, other.commit, 0, {}, {}};
  for (const CaseResults& one : ours.cases) {
    for (const RungResult& rung : one.rungs) {
      const OtherRung* theirs = find_rung(other, rung);
      if (theirs == nullptr) continue;
      comparison.compared++;
      std::vector<std::string> what = differing(rung, *theirs);
      if (!what.empty()) {
        comparison.differences.push_back({one.name, rung.rung, std::move(what)});
      } else if (theirs->answers != rung.answers) {
        comparison.other_answers.push_back({one.name, rung.rung, {}});
      }
    }
  }
  return comparison;
}

std::string comparison_text(const Comparison& comparison) {
  std::string text =
      fmt::format("beside {} ({}, {}): {} rungs compared, {} differ in verdict or rates\n", comparison.device,
                  comparison.platform, comparison.driver, comparison.compared, comparison.differences.size());
  for (const RungDifference& one : comparison.differences) {
    text += fmt::format("  {}, {}: here and there {}\n", one.case_name, one.rung, fmt::join(one.what, ", "));
  }
  if (!comparison.other_answers.empty()) {
    text += fmt::format("  the same rates by other bits: {}\n", by_case(comparison.other_answers));
  }
  return text;
}

std::string comparison_markdown(const Comparison& comparison) {
  std::string text = fmt::format("Beside {} ({}, driver {}, commit {}), the same rays: ", comparison.device,
                                 comparison.platform, comparison.driver, comparison.commit);
  text += comparison.differences.empty()
              ? fmt::format("on none of {} rungs does the verdict or a rate differ.\n", comparison.compared)
              : fmt::format(
                    "on {} of {} rungs the verdict or a rate differs.\n\n| case | rung | here and there |\n"
                    "|---|---|---|\n",
                    comparison.differences.size(), comparison.compared);
  for (const RungDifference& one : comparison.differences) {
    text += fmt::format("| {} | {} | {} |\n", one.case_name, one.rung, fmt::join(one.what, ", "));
  }
  if (comparison.other_answers.empty()) {
    return text + (comparison.differences.empty() ? "\nEvery answer is the same to the bit.\n" : "");
  }
  return text + fmt::format("\nOn {} rungs of {} cases the rates are the same, but not every answer to the bit: {}.\n",
                            comparison.other_answers.size(), count_cases(comparison.other_answers),
                            by_case(comparison.other_answers));
}

}  // namespace hemiray::stability

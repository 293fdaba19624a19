// A run of the ladder as text, JSON and Markdown (docs/STABILITY.md).
#pragma once

#include <string>
#include <vector>

#include "host/bench/results.hpp"
#include "host/stability/ladder.hpp"

namespace hemiray::stability {

struct CaseResults {
  std::string name, what;
  std::vector<RungResult> rungs;
};

/// A rung on which the verdicts or rates of two runs differ: such as "missed 3 and 0", "holds and FAILS".
struct RungDifference {
  std::string case_name, rung;
  std::vector<std::string> what;
};

/// With a run on another device (host/stability/compare_runs.hpp).
struct Comparison {
  std::string device, platform, driver, commit;  ///< of the other
  std::size_t compared = 0;                      ///< rungs that both have
  std::vector<RungDifference> differences;
  std::vector<RungDifference> other_answers;  ///< rates and verdict are the same, but not every answer to the bit
};

struct Report {
  bench::Machine machine;
  std::string command;  ///< that made it, as it is typed
  std::string date;     ///< YYYY-MM-DD
  std::uint32_t rays = 0, seed = 0;
  double seconds = 0.0;
  std::vector<CaseResults> cases;
  bool complete = true;  ///< all cases, to their end
  std::string precision = "single";
  bool strict = false;
  std::vector<Comparison> comparisons;
};

/// Whether every rung holds its bounds.
bool holds(const Report& report);

std::string report_head(const Report& report);       ///< for people, ends in a newline
std::string case_table(const CaseResults& results);  ///< the same, a case at a time
std::string report_json(const Report& report);
std::string report_markdown(const Report& report);

}  // namespace hemiray::stability

// A benchmark's results as tables, JSON and CSV.
#pragma once

#include <string>
#include <vector>

#include "host/bench/bars.hpp"
#include "host/bench/results.hpp"

namespace hemiray::bench {

/// All that is reported.
struct Report {
  Machine machine;
  std::vector<SceneResults> scenes;
  std::vector<EngineTimes> engines;
  std::vector<LeakResult> leaks;
  std::vector<BarResult> bars;
  std::vector<std::string> notes;
  bool interrupted = false;  ///< only what was complete by then is there
};

/// Parts of a report for people, in the order in which they become known; each ends in a newline.
std::string machine_table(const Machine& machine);
std::string builds_table(const SceneResults& scene);  ///< with the scene's name
/// Of tracers over one ray set, each beside the first.
std::string traces_table(const std::vector<TraceTimes>& traces);
std::string engines_table(const std::vector<EngineTimes>& engines);
std::string leaks_table(const std::vector<LeakResult>& leaks);
std::string bars_table(const Machine& machine, const std::vector<BarResult>& bars);

/// All figures: medians, spreads, disagreements; ends in a newline.
std::string report_json(const Report& report);
/// One line a measurement, with a line of names first; numbers in C notation.
std::string report_csv(const Report& report);

}  // namespace hemiray::bench

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
};

/// Where it was measured, and each part that is not empty, for people.
std::string report_tables(const Report& report);
/// The same without what report_tables() does in words: medians, spreads, disagreements; ends in a newline.
std::string report_json(const Report& report);
/// One line a measurement, with a line of names first; numbers in C notation.
std::string report_csv(const Report& report);

}  // namespace hemiray::bench

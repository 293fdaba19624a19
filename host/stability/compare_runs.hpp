// Two runs of the ladder, on two devices: the rungs on which they differ, by name.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "host/stability/report.hpp"

namespace hemiray::stability {

/// What another run says of a rung.
struct OtherRung {
  std::string case_name, rung;
  bool holds = true;
  std::vector<std::pair<std::string, std::uint64_t>> counts;  ///< by the names of kHeldRates
  std::string answers;                                        ///< hash
};

/// A run as written by `--json`.
struct OtherRun {
  std::string device, platform, driver, commit;
  std::vector<OtherRung> rungs;
};

/// Throws InputError, with `place`, if the text is no run of the ladder, or one of other rays, of another precision or
/// strictness than `like`, so that nothing can be compared.
OtherRun read_run(const std::string& text, const std::string& place, const Report& like);

Comparison compare_runs(const Report& ours, const OtherRun& other);

std::string comparison_text(const Comparison& comparison);      ///< for people, ends in a newline
std::string comparison_markdown(const Comparison& comparison);  ///< a paragraph, and a table where they differ

}  // namespace hemiray::stability

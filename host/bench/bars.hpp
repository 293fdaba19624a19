// Bars: what the measurements of the room of the bars (scene "interior") must reach, and whether they do.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "host/bench/leaks.hpp"
#include "host/bench/results.hpp"

namespace hemiray::bench {

/// What a bar looks at. trace: our rate over the best rate of the others; build: our time over theirs; leaks: our leaks
/// over all meshes and targets.
enum class BarKind { trace, build, leaks };

/// One row of bars.
struct Bar {
  std::string label;
  BarKind kind = BarKind::trace;
  std::string ours;                  ///< a tracer's name; for builds a tree's
  std::vector<std::string> against;  ///< the same of the peers; the best one counts; none for leaks
  std::string rays;                  ///< a RaySet's name; for traces only
  bool higher_is_better = true;
  /// Processor class ("avx512", "avx2") -> triangles -> bar. Leaks: the class "any" and 0 triangles.
  std::map<std::string, std::map<std::uint32_t, double>> bars;
};

enum class Verdict { pass, fall_short, invalid, not_measured };
std::string to_string(Verdict verdict);

struct BarResult {
  std::string label;
  std::uint32_t triangles = 0;  ///< 0 for leaks
  BarKind kind = BarKind::trace;
  bool higher_is_better = true;
  double bar = 0.0;
  double measured = 0.0;  ///< ratio, or number of leaks; 0 where not measured
  std::string best_peer;  ///< which of the others it was compared with
  Verdict verdict = Verdict::not_measured;
};

/// Reads a bars file; `name` stands for it in messages. Throws InputError with the line or the JSON path at fault.
std::vector<Bar> parse_bars(std::string_view text, const std::string& name);

/// What bars may refer to: tracers, their trees, and the tracers whose leaks are counted.
struct BarNames {
  std::set<std::string> tracers, trees, leak_tracers;
};

/// Throws InputError with the JSON path of the first name that is not known; `bars` are all those of the file `name`.
void check_bar_names(const std::vector<Bar>& bars, const BarNames& known, const std::string& name);

/// Judges every bar of that processor class whose triangle count is among the measured sizes of the interior, and the
/// leaks where they were measured. A measurement that did not verify makes its bars invalid; one that is missing makes
/// them not measured.
std::vector<BarResult> judge_bars(const std::vector<Bar>& bars, const std::string& processor_class,
                                  const std::vector<SceneResults>& scenes, const std::vector<LeakResult>& leaks);

/// Triangle counts that the bars of a class name, in order.
std::vector<std::uint32_t> bar_sizes(const std::vector<Bar>& bars, const std::string& processor_class);

}  // namespace hemiray::bench

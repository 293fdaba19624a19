#include "host/bench/bars.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "host/base/error.hpp"
#include "host/base/json_text.hpp"
#include "host/base/spelling.hpp"

namespace hemiray::bench {
namespace {

using nlohmann::json;

constexpr int kMaxDepth = 8;
constexpr std::uint32_t kVersion = 1;

[[noreturn]] void fail(const std::string& place, const std::string& what) { throw InputError(place, what); }

const json& member(const json& object, const char* key, const std::string& place) {
  if (!object.is_object()) fail(place, "not an object");
  const auto found = object.find(key);
  if (found == object.end()) fail(place, fmt::format("lacks the key \"{}\"", key));
  return *found;
}

std::string text_of(const json& object, const char* key, const std::string& place) {
  const json& value = member(object, key, place);
  if (!value.is_string() || value.get<std::string>().empty()) fail(fmt::format("{}/{}", place, key), "not a text");
  return value;
}

const char* name_of(BarKind kind) {
  return kind == BarKind::trace ? "trace" : kind == BarKind::build ? "build" : "leaks";
}

BarKind kind_of(const json& row, const std::string& place) {
  const std::string kind = text_of(row, "kind", place);
  for (const BarKind known : {BarKind::trace, BarKind::build, BarKind::leaks}) {
    if (kind == name_of(known)) return known;
  }
  fail(place + "/kind", fmt::format("\"{}\" is none of trace, build, leaks", kind));
}

bool direction_of(const json& row, const std::string& place) {
  const std::string better = text_of(row, "better", place);
  if (better != "higher" && better != "lower") fail(place + "/better", "neither \"higher\" nor \"lower\"");
  return better == "higher";
}

double number_of(const json& value, const std::string& place) {
  if (!value.is_number()) fail(place, "not a number");
  const double number = value;
  if (!(number >= 0.0)) fail(place, "a bar is not negative");
  return number;
}

std::uint32_t size_of(const std::string& key, const std::string& place) {
  if (key.empty() || key.size() > 9 || key.find_first_not_of("0123456789") != std::string::npos) {
    fail(place, "its name is not a number of triangles");
  }
  return static_cast<std::uint32_t>(std::stoul(key));
}

Bar parse_row(const json& row, const std::string& place) {
  Bar bar;
  bar.label = text_of(row, "label", place);
  bar.kind = kind_of(row, place);
  bar.ours = text_of(row, "ours", place);
  bar.higher_is_better = direction_of(row, place);
  if (bar.kind == BarKind::trace) bar.rays = text_of(row, "rays", place);
  if (bar.kind == BarKind::leaks) {
    bar.bars["any"][0] = number_of(member(row, "bar", place), place + "/bar");
    return bar;
  }
  const json& against = member(row, "against", place);
  if (!against.is_array() || against.empty()) fail(place + "/against", "not a list of names");
  for (const json& name : against) {
    if (!name.is_string()) fail(place + "/against", "not a list of names");
    bar.against.push_back(name);
  }
  const json& classes = member(row, "bars", place);
  if (!classes.is_object() || classes.empty()) fail(place + "/bars", "not an object of processor classes");
  for (const auto& [processor_class, sizes] : classes.items()) {
    const std::string class_place = place + "/bars" + json_pointer_step(processor_class);
    if (!sizes.is_object() || sizes.empty()) fail(class_place, "not an object of triangle counts");
    for (const auto& [size, value] : sizes.items()) {
      const std::string size_place = class_place + json_pointer_step(size);
      bar.bars[processor_class][size_of(size, size_place)] = number_of(value, size_place);
    }
  }
  return bar;
}

// A figure, and whether its run verified.
struct Figure {
  double value;  // rate [Mrays/s] or time [ms]
  bool valid;
};

std::optional<Figure> find_figure(const Bar& bar, const std::string& name, const SceneResults& scene) {
  if (bar.kind == BarKind::build) {
    for (const BuildTimes& times : scene.builds) {
      if (times.tree == name) return Figure{times.ms.median, true};
    }
    return std::nullopt;
  }
  for (const TraceTimes& times : scene.traces) {
    if (times.tracer == name && times.rays == bar.rays) return Figure{mrays_per_second(times), times.valid};
  }
  return std::nullopt;
}

// A tree's time counts only if what was traced through it verified.
bool tree_verified(const std::string& tree, const SceneResults& scene) {
  bool traced = false;
  for (const TraceTimes& times : scene.traces) {
    if (!times.tracer.starts_with(tree + "/")) continue;
    if (!times.valid) return false;
    traced = true;
  }
  return traced;
}

bool reaches(const Bar& bar, double measured, double wanted) {
  return std::isfinite(measured) && (bar.higher_is_better ? measured >= wanted : measured <= wanted);
}

void judge_ratio(const Bar& bar, const SceneResults& scene, BarResult& result) {
  const std::optional<Figure> ours = find_figure(bar, bar.ours, scene);
  std::optional<Figure> best;
  bool all_valid = true;
  for (const std::string& name : bar.against) {
    const std::optional<Figure> theirs = find_figure(bar, name, scene);
    if (!theirs) return;  // the fastest of some is not the fastest of all
    all_valid &= theirs->valid;
    const bool faster =
        bar.kind == BarKind::build ? !best || theirs->value < best->value : !best || theirs->value > best->value;
    if (faster) {
      best = theirs;
      result.best_peer = name;
    }
  }
  if (!ours || !best) return;
  result.measured = ours->value / best->value;
  bool valid = all_valid && ours->valid;
  if (bar.kind == BarKind::build) valid = valid && tree_verified(bar.ours, scene);
  result.verdict = !valid                                      ? Verdict::invalid
                   : reaches(bar, result.measured, result.bar) ? Verdict::pass
                                                               : Verdict::fall_short;
}

BarResult judge_leaks(const Bar& bar, const std::vector<LeakResult>& leaks) {
  BarResult result{bar.label, 0, bar.kind, bar.higher_is_better, bar.bars.at("any").at(0), 0.0, "", {}};
  result.verdict = Verdict::not_measured;
  std::size_t count = 0;
  bool measured = false;
  for (const LeakResult& leak : leaks) {
    if (leak.tracer != bar.ours) continue;
    measured = true;
    count += leak.closest_hit_leaks + leak.any_hit_leaks;
  }
  if (!measured) return result;
  result.measured = static_cast<double>(count);
  result.verdict = reaches(bar, result.measured, result.bar) ? Verdict::pass : Verdict::fall_short;
  return result;
}

}  // namespace

std::string to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::pass:
      return "PASS";
    case Verdict::fall_short:
      return "FALL SHORT";
    case Verdict::invalid:
      return "INVALID";
    case Verdict::not_measured:
      break;
  }
  return "NOT MEASURED";
}

std::vector<Bar> parse_bars(std::string_view text, const std::string& name) {
  const json root = parse_json_text(text, name, kMaxDepth);
  if (member(root, "hemiray_bars", name + ": /") != kVersion) fail(name + ": /hemiray_bars", "is not 1");
  const json& rows = member(root, "rows", name + ": /");
  if (!rows.is_array() || rows.empty()) fail(name + ": /rows", "not a list of bars");
  std::vector<Bar> bars;
  for (std::size_t i = 0; i < rows.size(); i++)
    bars.push_back(parse_row(rows[i], fmt::format("{}: /rows/{}", name, i)));
  return bars;
}

void check_bar_names(const std::vector<Bar>& bars, const BarNames& known, const std::string& name) {
  for (std::size_t i = 0; i < bars.size(); i++) {
    const Bar& bar = bars[i];
    const std::set<std::string>& names = bar.kind == BarKind::trace   ? known.tracers
                                         : bar.kind == BarKind::build ? known.trees
                                                                      : known.leak_tracers;
    const char* what = bar.kind == BarKind::build ? "tree" : "tracer";
    const auto check = [&](const std::string& given, const std::string& key) {
      if (names.contains(given)) return;
      fail(fmt::format("{}: /rows/{}/{}", name, i, key),
           fmt::format("no {} of {} rows is named {}", what, name_of(bar.kind), in_quotes(given)) +
               spelling_hint(given, std::vector<std::string_view>(names.begin(), names.end())));
    };
    check(bar.ours, "ours");
    for (std::size_t k = 0; k < bar.against.size(); k++) check(bar.against[k], fmt::format("against/{}", k));
  }
}

std::vector<std::uint32_t> bar_sizes(const std::vector<Bar>& bars, const std::string& processor_class) {
  std::set<std::uint32_t> sizes;
  for (const Bar& bar : bars) {
    const auto found = bar.bars.find(processor_class);
    if (found == bar.bars.end()) continue;
    for (const auto& [size, value] : found->second) sizes.insert(size);
  }
  return {sizes.begin(), sizes.end()};
}

std::vector<BarResult> judge_bars(const std::vector<Bar>& bars, const std::string& processor_class,
                                  const std::vector<SceneResults>& scenes, const std::vector<LeakResult>& leaks) {
  std::vector<BarResult> results;
  for (const Bar& bar : bars) {
    if (bar.kind == BarKind::leaks) {
      if (!leaks.empty()) results.push_back(judge_leaks(bar, leaks));
      continue;
    }
    const auto sizes = bar.bars.find(processor_class);
    if (sizes == bar.bars.end()) continue;
    for (const auto& [triangles, wanted] : sizes->second) {
      for (const SceneResults& scene : scenes) {
        if (scene.scene != "interior" || scene.wanted_triangles != triangles) continue;
        BarResult result{bar.label, triangles, bar.kind, bar.higher_is_better, wanted, 0.0, "", {}};
        result.verdict = Verdict::not_measured;
        judge_ratio(bar, scene, result);
        results.push_back(std::move(result));
      }
    }
  }
  return results;
}

}  // namespace hemiray::bench

#include "host/app/factor_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/base/numbers.hpp"

namespace hemiray::app {

std::string factor_table(const RadiosityStatistics& s) {
  const FactorReport& r = s.factors;
  if (s.kept_rows == s.rows && s.rays == 0) {
    return fmt::format("form factors  {} rows, {} entries in {}, all from the file\n", s.rows, s.entries,
                       format_bytes(s.factor_bytes));
  }
  const std::string kept = s.kept_rows > 0 ? fmt::format(" ({} from the file)", s.kept_rows) : "";
  std::string text =
      fmt::format("form factors  {} rows{}, {} entries in {}; {} rays or drawn cells, {:.2f} s, {:.1f} M/s\n", s.rows,
                  kept, s.entries, format_bytes(s.factor_bytes), s.rays, 1e-3 * s.factors_ms,
                  1e-3 * static_cast<double>(s.rays) / std::max(s.factors_ms, 1e-9));
  if (!r.enforcement) return text;
  text += fmt::format(
      "  pairs       {} exchange light; of all that face each other {} are close or cut, {} may be partly hidden\n",
      r.pairs, r.near_pairs, r.partial_pairs);
  text += fmt::format(
      "  time        hemicubes {:.2f} s, visibility {:.2f} s, partly hidden {:.2f} s, factors {:.2f} s, rows {:.2f} "
      "s\n",
      1e-3 * r.cubes_ms, 1e-3 * r.visibility_ms, 1e-3 * r.sample_ms, 1e-3 * r.pairs_ms, 1e-3 * r.enforce_ms);
  text += fmt::format(
      "  error       a row: geometry below {:.1e}, sampling {:.1e} of {:.3f} that may be partly hidden, "
      "closure {:.1e}\n",
      r.row_errors.geometry, r.row_errors.sampling, r.row_errors.partial, r.row_errors.closure);
  if (r.violations) {
    const Violations& v = *r.violations;
    text += fmt::format(
        "  hemicubes   of {} factors {} above 1, {} above an area's share, {} above the unobstructed; "
        "reciprocity off by {:.2g} m^2\n",
        v.entries, v.above_one, v.above_area, v.above_unobstructed, v.reciprocity);
    text += fmt::format("  repaired    {} for proximity, {} visibility, {} aliasing, {} other, each over 1 %\n",
                        v.proximity, v.visibility, v.aliasing, v.point);
  }
  const Enforcement& e = *r.enforcement;
  text += fmt::format("  closure     {} closed rows off by {:.1e} on average, {:.1e} at most", e.closed_rows,
                      e.mean_before, e.closure_before);
  if (e.sweeps > 0) text += fmt::format("; {:.1e} after {} sweeps", e.closure_after, e.sweeps);
  if (e.left_rows > 0) text += fmt::format("; {} rows too far off to close", e.left_rows);
  return text + "\n";
}

nlohmann::ordered_json row_errors_json(const FactorErrors& e) {
  return {{"geometry", e.geometry}, {"sampling", e.sampling}, {"closure", e.closure}, {"partly_hidden", e.partial}};
}

nlohmann::ordered_json factor_json(const FactorReport& r) {
  nlohmann::ordered_json json;
  json["cube_rays"] = r.cube_rays;
  json["pairs"] = r.pairs;
  json["cubes_ms"] = r.cubes_ms;
  if (!r.enforcement) return json;
  json["pair_rays"] = r.pair_rays;
  json["sample_rays"] = r.sample_rays;
  json["near_pairs"] = r.near_pairs;
  json["partial_pairs"] = r.partial_pairs;
  json["visibility_ms"] = r.visibility_ms;
  json["sample_ms"] = r.sample_ms;
  json["pairs_ms"] = r.pairs_ms;
  json["enforce_ms"] = r.enforce_ms;
  json["row_errors"] = row_errors_json(r.row_errors);
  if (r.violations) {
    const Violations& v = *r.violations;
    json["hemicube_violations"] = {{"entries", v.entries},
                                   {"above_one", v.above_one},
                                   {"above_area", v.above_area},
                                   {"above_unobstructed", v.above_unobstructed},
                                   {"reciprocity_m2", v.reciprocity},
                                   {"proximity", v.proximity},
                                   {"visibility", v.visibility},
                                   {"aliasing", v.aliasing},
                                   {"point", v.point}};
  }
  const Enforcement& e = *r.enforcement;
  json["closure"] = {
      {"closed_rows", e.closed_rows},     {"left_rows", e.left_rows},         {"sweeps", e.sweeps},
      {"mean_before", e.mean_before},     {"mean_after", e.mean_after},       {"largest_before", e.closure_before},
      {"largest_after", e.closure_after}, {"excess_before", e.excess_before}, {"excess_after", e.excess_after}};
  return json;
}

std::string rounding_line(const FactorRounding& r, double bound) {
  const std::string saved = r.bytes_saved >= 0 ? format_bytes(static_cast<std::uint64_t>(r.bytes_saved)) + " saved"
                                               : format_bytes(static_cast<std::uint64_t>(-r.bytes_saved)) + " more";
  const std::string moved = std::isfinite(bound) ? fmt::format("moves no radiosity by more than {:.2g} W/m^2", bound)
                                                 : "may move radiosities without a bound that is known";
  return fmt::format(
      "  rounded     to half, {}: a factor by {:.1e} of it on average, {:.1e} at most, a row's sum by {:.1e}; it {}\n",
      saved, r.mean, r.largest, r.row_sum_change, moved);
}

nlohmann::ordered_json rounding_json(const FactorRounding& r, double bound) {
  nlohmann::ordered_json json = {{"largest_relative", r.largest}, {"mean_relative", r.mean},
                                 {"row_change", r.row_change},    {"row_sum_change", r.row_sum_change},
                                 {"bytes_saved", r.bytes_saved},  {"radiosity_bound", nullptr}};
  if (std::isfinite(bound)) json["radiosity_bound"] = bound;
  return json;
}

}  // namespace hemiray::app

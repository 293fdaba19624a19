#include "host/app/refine_report.hpp"

#include <fmt/format.h>

namespace hemiray::app {

std::string refinement_table(const RefineReport& report) {
  if (report.end.empty()) return "";
  std::string text;
  const auto left = [](double jump, const ContinuousResidual& c) {
    return fmt::format(
        "neighbours differ by {:.3g} W/m^2{}", jump,
        c.samples > 0 ? fmt::format(", leaves {:.3g} ({:.3g} to {:.3g})", c.rms, c.rms_low, c.rms_high) : "");
  };
  text += fmt::format("refinement    {} patches: {}\n", report.patches, left(report.jump, report.continuous));
  for (const RefineRound& r : report.rounds) {
    text += fmt::format("  to {:<8} {} cut, {} of {} rows made anew, {} rays, {:.2f} s: {}\n", r.patches, r.cut,
                        r.made_rows, r.rows, r.rays, 1e-3 * (r.mesh_ms + r.factors_ms + r.solve_ms),
                        left(r.jump, r.continuous));
  }
  return text + fmt::format("  end         {}\n", report.end);
}

nlohmann::ordered_json refinement_json(const RefineReport& report) {
  nlohmann::ordered_json json;
  json["patches"] = report.patches;
  json["jump"] = report.jump;
  if (report.continuous.samples > 0) json["continuous_residual"] = residual_json(report.continuous);
  json["rounds"] = nlohmann::ordered_json::array();
  for (const RefineRound& r : report.rounds) {
    nlohmann::ordered_json one = {
        {"patches", r.patches},  {"cut", r.cut},   {"made_rows", r.made_rows}, {"rows", r.rows},
        {"rays", r.rays},        {"jump", r.jump}, {"mesh_ms", r.mesh_ms},     {"factors_ms", r.factors_ms},
        {"solve_ms", r.solve_ms}};
    if (r.continuous.samples > 0) one["continuous_residual"] = residual_json(r.continuous);
    json["rounds"].push_back(one);
  }
  json["end"] = report.end;
  return json;
}

nlohmann::ordered_json residual_json(const ContinuousResidual& c) {
  return {{"samples", c.samples}, {"rays", c.rays},         {"rms", c.rms},
          {"rms_low", c.rms_low}, {"rms_high", c.rms_high}, {"radiosity_rms", c.radiosity_rms}};
}

}  // namespace hemiray::app

#include "host/app/radiosity_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/app/factor_report.hpp"
#include "host/base/error.hpp"
#include "host/base/numbers.hpp"

namespace hemiray::app {
namespace {

std::uint32_t divisions_of(std::uint32_t points) {
  for (std::uint32_t d = 1; d <= 16; d++) {
    if (d * d == points) return d;
  }
  throw InputError("--points", fmt::format("{} points a patch cannot be had; take a square from 1 to 256", points));
}

}  // namespace

void add_radiosity_options(CLI::App& command, RadiosityArguments& a) {
  const auto add = [&](auto* option) {
    option->group("Radiosity");
    a.given.push_back(option);
    return option;
  };
  add(command.add_option("--patches", a.patches, "Patches, at most"))->capture_default_str();
  add(command.add_option("--edge", a.edge, "Longest edge of a patch [m], in place of --patches"));
  add(command.add_option(
      "--chord", a.chord,
      "Largest distance of a tessellated sphere from the true one [m] (default: 1 % of its radius)"));
  add(command.add_option("--form-factors", a.form_factors,
                         "By hemicubes alone, pair by pair, or both: checked against each other, closed rows "
                         "made to sum to one"))
      ->check(CLI::IsMember({"hemicube", "analytic", "hybrid"}))
      ->capture_default_str();
  add(command.add_option("--pair-rays", a.pair_rays, "Rays between partly hidden pairs, at most; 16 to find which are"))
      ->check(CLI::Range(4, 4096))
      ->capture_default_str();
  add(command.add_option("--resolution", a.resolution,
                         "Cells along an edge of a hemicube, even, 8 to 1024 (default: 64; 16 where hemicubes only "
                         "say which patches light reaches)"));
  add(command.add_option("--points", a.points, "Hemicubes a patch: a square from 1 to 256"))->capture_default_str();
  add(command.add_option("--cells", a.cells,
                         "Rays go through the cells' middles, of cubes that are turned each its own "
                         "way, or through random points of them"))
      ->check(CLI::IsMember({"aligned", "turned", "jittered"}))
      ->capture_default_str();
  add(command.add_option("--solver", a.solver, "How the system is solved"))
      ->check(CLI::IsMember({"jacobi", "gauss-seidel"}))
      ->capture_default_str();
  add(command.add_option("--tolerance", a.tolerance,
                         "Error of the solution that is proven before it stops, relative to the largest radiosity"))
      ->capture_default_str();
  add(command.add_option("--iterations", a.iterations, "Iterations, at most"))->capture_default_str();
  add(command.add_option("--time", a.seconds, "Seconds to solve for, at most"));
  add(command.add_option("--display", a.display, "Light interpolated between vertices, or constant on each patch"))
      ->check(CLI::IsMember({"smooth", "flat"}))
      ->capture_default_str();
  add(command.add_option("--crease", a.crease,
                         "Angle [degrees] beyond which neighbours do not share light at a vertex"))
      ->check(CLI::Range(0.0, 90.0))
      ->capture_default_str();
}

RadiosityOptions to_radiosity_options(const RadiosityArguments& a) {
  const auto positive = [](const char* option, double value, bool zero_too) {
    if (!std::isfinite(value) || value < 0.0 || (value == 0.0 && !zero_too)) {
      throw InputError(option, fmt::format("{} is out of range; it must be a positive number", value));
    }
  };
  positive("--edge", a.edge, true);
  positive("--chord", a.chord, true);
  positive("--tolerance", a.tolerance, false);
  positive("--time", a.seconds, true);
  if (a.patches == 0) throw InputError("--patches", "0 patches show nothing; give how many there may be");
  RadiosityOptions options;
  options.mesh = {a.edge, a.patches, a.chord};
  options.factors.method = a.form_factors == "hemicube"   ? FormFactors::hemicube
                           : a.form_factors == "analytic" ? FormFactors::analytic
                                                          : FormFactors::hybrid;
  options.factors.visibility.few = std::min(options.factors.visibility.few, a.pair_rays);
  options.factors.visibility.many = a.pair_rays;
  options.factors.visibility.seed = a.seed;
  HemicubeOptions& hemicube = options.factors.hemicube;
  const bool by_cubes = options.factors.method == FormFactors::hemicube;
  hemicube.resolution = a.resolution > 0 ? a.resolution : (by_cubes ? 64 : kReachResolution);
  hemicube.divisions = divisions_of(a.points);
  hemicube.turned = a.cells != "aligned";
  hemicube.jittered = a.cells == "jittered";
  hemicube.seed = a.seed;
  check_hemicube_options(hemicube);
  options.solve.kind = a.solver == "jacobi" ? SolverKind::jacobi : SolverKind::gauss_seidel;
  options.solve.tolerance = a.tolerance;
  options.solve.iterations = a.iterations;
  options.solve.seconds = a.seconds;
  return options;
}

DisplayOptions to_display_options(const RadiosityArguments& a) { return {a.display == "smooth", a.crease}; }

std::string radiosity_table(const Radiosity& r) {
  const RadiosityStatistics& s = r.statistics;
  const SolveStep& last = r.solution.history.back();
  std::string text;
  text += fmt::format("mesh          {} patches of edges up to {:.3g} m{}, {:.0f} ms\n", r.mesh.patch_count(),
                      r.mesh.edge_m,
                      r.mesh.chord_m > 0.0 ? fmt::format(", tessellated to {:.2g} m", r.mesh.chord_m) : "", s.mesh_ms);
  text += factor_table(s);
  text += fmt::format("solution      {} iterations, {:.2f} s; no radiosity off by more than {:.3g} of {:.4g} W/m^2{}\n",
                      r.solution.history.size() - 1, 1e-3 * s.solve_ms, last.bound, r.solution.largest,
                      r.solution.converged ? "" : " (not converged)");
  text += fmt::format("power         {:.6g} W sent, {:.6g} W absorbed\n", s.emitted_w, s.absorbed_w);
  return text;
}

std::string radiosity_json(const Radiosity& r) {
  const RadiosityStatistics& s = r.statistics;
  nlohmann::ordered_json json;
  json["patches"] = r.mesh.patch_count();
  json["edge_m"] = r.mesh.edge_m;
  json["chord_m"] = r.mesh.chord_m;
  json["rows"] = s.rows;
  json["entries"] = s.entries;
  json["factor_bytes"] = s.factor_bytes;
  json["rays"] = s.rays;
  json["form_factors"] = factor_json(s.factors);
  json["mesh_ms"] = s.mesh_ms;
  json["tree_ms"] = s.tree_ms;
  json["factors_ms"] = s.factors_ms;
  json["solve_ms"] = s.solve_ms;
  json["peak_bytes"] = s.peak_bytes;
  json["emitted_w"] = s.emitted_w;
  json["absorbed_w"] = s.absorbed_w;
  json["converged"] = r.solution.converged;
  json["largest_radiosity"] = r.solution.largest;
  for (const SolveStep& step : r.solution.history) {
    nlohmann::ordered_json one;
    one["residual"] = step.residual;
    if (std::isfinite(step.bound)) {
      one["bound"] = step.bound;
    } else {
      one["bound"] = nullptr;
    }
    one["seconds"] = step.seconds;
    json["history"].push_back(one);
  }
  return json.dump(2) + "\n";
}

}  // namespace hemiray::app

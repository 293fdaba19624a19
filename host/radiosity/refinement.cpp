#include "host/radiosity/refinement.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "host/base/clock.hpp"
#include "host/radiosity/refine_choice.hpp"
#include "host/radiosity/refine_factors.hpp"
#include "host/radiosity/refine_mesh.hpp"

namespace hemiray {
namespace {

// Patches after a round to those before. Less finds boundaries better and computes more rows that are cut again.
constexpr double kGrowth = 1.5;
constexpr double kSlack = 16.0;        // what a cut of few patches takes along
constexpr double kLeastGrowth = 1.02;  // a round's price for less buys nothing that shows

}  // namespace

void refine_solution(Context& context, Parallel& parallel, AccelBuilder& builder, const FlatScene& flat,
                     const RadiosityOptions& options, const FactorOptions& factors, FactorMatrix matrix,
                     SideLight& light, Radiosity& result) {
  RadiosityStatistics& statistics = result.statistics;
  RefineReport& report = statistics.refinement;
  report.patches = result.mesh.patch_count();
  report.continuous = result.continuous;
  SolveOptions solve = options.solve;
  solve.continue_from.clear();
  solve.offer_state = {};
  double start = steady_ms();
  const auto lap = [&] {
    context.finish();
    const double before = std::exchange(start, steady_ms());
    return start - before;
  };
  for (;;) {
    const double least = 2.0 * options.solve.tolerance * result.solution.largest;
    const RefineChoice choice = patches_to_refine(result.mesh, result.irradiance, least);
    (report.rounds.empty() ? report.jump : report.rounds.back().jump) = choice.mean_jump;
    if (statistics.interrupted || !result.solution.converged) {
      report.end = statistics.interrupted ? "interrupted" : "the solution has not converged";
      return;
    }
    if (choice.patches.empty()) {
      report.end = fmt::format("neighbours differ by {:.3g} W/m^2 at most, which the tolerance leaves open",
                               choice.largest_jump);
      return;
    }
    report.end = fmt::format("{} patches leave no room for another round", options.refine_patches);
    const double patches = result.mesh.patch_count(),
                 most = std::min<double>(kGrowth * patches + kSlack, options.refine_patches);
    if (most < kLeastGrowth * patches) return;
    RefineRound round;
    RefinedMesh refined = refine_patch_mesh(result.mesh, choice.patches, static_cast<std::uint32_t>(most));
    if (refined.parts.empty()) return;
    SideLight parts_light = light_sides(context, builder, flat, refined.mesh);
    Hemicubes hemicubes(context, parallel, builder, refined.mesh, factors.hemicube);
    round.patches = refined.mesh.patch_count();
    round.cut = refined.cut;
    round.mesh_ms = lap();
    RefinedFactors made = refine_factors(context, parallel, hemicubes, matrix, refined, factors, [&](double fraction) {
      return !options.on_progress || options.on_progress("refinement", fraction);
    });
    if (made.interrupted) {
      statistics.interrupted = true;
      continue;
    }
    matrix = std::move(made.matrix);
    round.made_rows = made.made_rows;
    round.rows = matrix.rows();
    round.rays = made.rays;
    round.factors_ms = lap();
    const double compile_start = context.compile_ms();
    result.solution = solve_radiosity(context, refined.mesh, matrix, solve);
    statistics.solve_compile_ms += context.compile_ms() - compile_start;
    light = std::move(parts_light);
    result.irradiance = light.with_direct(result.solution.irradiance);
    round.solve_ms = lap();
    if (options.residual_samples > 0) {
      result.continuous = find_continuous_residual(context, hemicubes, refined.mesh, result.solution.radiosity,
                                                   options.residual_samples, options.factors.hemicube.seed);
      round.continuous = result.continuous;
      statistics.residual_ms += lap();
    }
    result.mesh = std::move(refined.mesh);
    statistics.mesh_ms += round.mesh_ms;
    statistics.factors_ms += round.factors_ms;
    statistics.solve_ms += round.solve_ms;
    statistics.rays += round.rays;
    statistics.rows = round.rows;
    statistics.entries = matrix.entries();
    statistics.factor_bytes = matrix.bytes();
    report.rounds.push_back(round);
  }
}

}  // namespace hemiray

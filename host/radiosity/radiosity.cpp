#include "host/radiosity/radiosity.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "host/base/clock.hpp"
#include "host/base/error.hpp"
#include "host/base/numbers.hpp"
#include "host/radiosity/factor_memory.hpp"
#include "host/radiosity/refinement.hpp"
#include "host/radiosity/side_light.hpp"
#include "host/radiosity/solution_key.hpp"

namespace hemiray {
namespace {

std::array<double, 3> rgb(const shared::float4& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

// All rows that light reaches, those that `matrix` has first; or none, where they would take more than their memory.
FactorMatrix stored_factors(Context& context, Hemicubes& hemicubes, const PatchMesh& mesh,
                            const std::vector<std::uint32_t>& sources, const RadiosityOptions& options,
                            FactorMatrix matrix, SolutionFile& file, RadiosityStatistics& statistics) {
  const FactorPrecision precision = options.factors.precision;
  statistics.factor_bytes_at_most = most_factor_bytes(mesh, options.factors.hemicube, precision);
  std::optional<FactorRounder> rounder;
  if (precision == FactorPrecision::half) rounder.emplace(context, mesh);
  hemicubes.add_rows_reached_from(sources, matrix, [&](std::uint64_t done, std::uint64_t known) {
    if (rounder && !matrix.blocks.back().is_rounded()) rounder->round(matrix.blocks.back(), false);
    statistics.expected_factor_bytes = expected_factor_bytes(hemicubes.entries_made(), done, known, precision);
    if (statistics.expected_factor_bytes > statistics.factor_limit) return false;
    const bool go_on = !options.on_progress ||
                       options.on_progress("form factors", static_cast<double>(done) / static_cast<double>(known));
    statistics.interrupted |= !go_on;
    file.offer(!go_on, FactorStage::some, statistics.expected_factor_bytes, matrix, {});
    return go_on;
  });
  context.finish();  // before rows go
  if (statistics.expected_factor_bytes <= statistics.factor_limit) return matrix;
  if (options.solve.kind != SolverKind::automatic && options.solve.kind != SolverKind::southwell) {
    throw InputError(
        "radiosity",
        fmt::format("the form factors need {}, and {} may be taken; {} keeps them: take --solver southwell, "
                    "which computes rows when it needs them, fewer patches, or more --factor-memory",
                    format_bytes(statistics.expected_factor_bytes), format_bytes(statistics.factor_limit),
                    to_string(options.solve.kind)));
  }
  FactorMatrix none;
  none.side_count = mesh.side_count();
  return none;
}

// Pair by pair; what the memory allows is known before.
FactorMatrix paired_factors(Context& context, Parallel& parallel, Hemicubes& hemicubes, const PatchMesh& mesh,
                            const std::vector<std::uint32_t>& sources, const FactorOptions& factors,
                            const RadiosityOptions& options, RadiosityStatistics& statistics) {
  FactorReport& report = statistics.factors;
  FactorMatrix matrix = make_form_factors(
      context, parallel, mesh, hemicubes, sources, factors, report,
      [&](double fraction) { return !options.on_progress || options.on_progress("form factors", fraction); });
  statistics.interrupted = report.interrupted;
  return matrix;
}

// What is asked for, or hemicubes where pair by pair might not fit: every patch may see every other, and factors are
// rounded only once they are whole.
FactorOptions fitting_factors(const PatchMesh& mesh, const RadiosityOptions& options, RadiosityStatistics& statistics) {
  FactorOptions factors = options.factors;
  if (factors.method == FormFactors::hemicube) return factors;
  statistics.factor_bytes_at_most =
      std::uint64_t{mesh.patch_count()} * mesh.patch_count() * entry_bytes(FactorPrecision::single);
  if (statistics.factor_bytes_at_most <= statistics.factor_limit) return factors;
  statistics.why_hemicubes =
      fmt::format("pair by pair they may take {}, and {} are allowed", format_bytes(statistics.factor_bytes_at_most),
                  format_bytes(statistics.factor_limit));
  factors.method = FormFactors::hemicube;
  factors.hemicube.resolution = std::max(factors.hemicube.resolution, HemicubeOptions{}.resolution);
  return factors;
}

Solution solve_on_demand(Context& context, Hemicubes& hemicubes, const PatchMesh& mesh, const SolveOptions& options) {
  const RowsOnDemand rows = [&hemicubes](std::span<const std::uint32_t> sides) {
    FactorMatrix some;
    hemicubes.add_rows(sides, some);
    return some;
  };
  return solve_radiosity_on_demand(context, mesh, rows, options);
}

void sum_power(const SideLight& light, Radiosity& result) {
  for (std::uint32_t s = 0; s < result.mesh.side_count(); s++) {
    const auto area = static_cast<double>(result.mesh.normals[s / 2].w);
    const std::array<double, 3> rho = rgb(result.mesh.reflectance[s]), tau = rgb(result.mesh.transmittance[s ^ 1U]),
                                e = rgb(light.emission[s]), d = rgb(light.direct[s]);
    for (std::size_t c = 0; c < 3; c++) {
      result.statistics.emitted_w += area * (e[c] + d[c]);
      result.statistics.absorbed_w += area * (1.0 - rho[c] - tau[c]) * result.irradiance[s][c];
    }
  }
}

// What is unshot, on all that is lit.
void add_ambient(Radiosity& result) {
  for (std::uint32_t s = 0; s < result.mesh.side_count(); s++) {
    if (std::ranges::none_of(result.solution.irradiance[s], [](double h) { return h > 0.0; })) continue;
    for (std::size_t c = 0; c < 3; c++) result.irradiance[s][c] += result.solution.ambient[c];
  }
}

// Before anything is computed, or before it is refined.
void check_refinable(const RadiosityOptions& options, const PatchMesh& mesh) {
  if (options.refine_patches == 0) return;
  if (options.factors.precision == FactorPrecision::half) {
    throw InputError("--refine",
                     "needs form factors in single precision, from which those of parts are made; leave "
                     "out --factor-precision half");
  }
  if (options.refine_patches > mesh.patch_count()) return;
  throw InputError("--refine", fmt::format("{} patches are no more than the {} that the mesh has to begin with; take "
                                           "more, or fewer --patches",
                                           options.refine_patches, mesh.patch_count()));
}

void check_refined_memory(const RadiosityOptions& options, const PatchMesh& mesh, bool on_demand,
                          const RadiosityStatistics& statistics) {
  if (options.refine_patches == 0) return;
  const double growth = static_cast<double>(options.refine_patches) / mesh.patch_count();
  const double bytes = static_cast<double>(statistics.factor_bytes) * growth * growth;
  if (!on_demand && bytes <= static_cast<double>(statistics.factor_limit)) return;
  throw InputError("--refine",
                   on_demand ? "needs form factors that are kept, and they do not fit; take fewer --patches, or more "
                               "--factor-memory"
                             : fmt::format("the form factors of {} patches may take {}, and {} may be taken; take "
                                           "fewer, or more --factor-memory",
                                           options.refine_patches, format_bytes(static_cast<std::uint64_t>(bytes)),
                                           format_bytes(statistics.factor_limit)));
}

}  // namespace

Radiosity compute_radiosity(Context& context, const FlatScene& flat, const RadiosityOptions& options) {
  Radiosity result;
  RadiosityStatistics& statistics = result.statistics;
  double start = steady_ms();
  const auto lap = [&start] {
    const double before = std::exchange(start, steady_ms());
    return start - before;
  };
  result.mesh = make_patch_mesh(flat, options.mesh);
  PatchMesh& mesh = result.mesh;
  check_refinable(options, mesh);
  SolutionFile file(context, options.keep, solution_key(context, flat, options), mesh);
  SolutionState kept = file.take_state();
  statistics.kept_rows = kept.factors.rows();
  statistics.mesh_ms = lap();

  statistics.factor_limit = options.factor_bytes > 0 ? options.factor_bytes : factor_memory_limit(context);
  const FactorOptions factors = fitting_factors(mesh, options, statistics);
  Parallel parallel(context);
  AccelBuilder builder(context, parallel);
  Hemicubes hemicubes(context, parallel, builder, mesh, factors.hemicube);
  SideLight light = light_sides(context, builder, flat, mesh);
  context.finish();
  statistics.tree_ms = lap();

  statistics.expected_factor_bytes = kept.expected_factor_bytes;
  FactorMatrix matrix =
      kept.stage != FactorStage::some ? std::move(kept.factors)
      : factors.method == FormFactors::hemicube
          ? stored_factors(context, hemicubes, mesh, light.sources, options, std::move(kept.factors), file, statistics)
          : paired_factors(context, parallel, hemicubes, mesh, light.sources, factors, options, statistics);
  const bool on_demand = statistics.expected_factor_bytes > statistics.factor_limit;
  context.finish();
  statistics.factors_ms = lap();
  statistics.factor_bytes = matrix.bytes();
  statistics.precision = options.factors.precision;
  if (matrix.precision() == FactorPrecision::half) statistics.rounding = rounding_of(matrix);
  statistics.entries = matrix.entries();
  statistics.rows = matrix.rows();
  check_refined_memory(options, mesh, on_demand, statistics);

  SolveOptions solve = options.solve;
  solve.continue_from = std::move(kept.solver);
  if (!statistics.interrupted) {  // else rows are missing
    solve.offer_state = [&](bool must, const std::function<std::vector<std::uint8_t>()>& state) {
      file.offer(must, on_demand ? FactorStage::on_demand : FactorStage::all, statistics.expected_factor_bytes, matrix,
                 state);
    };
  }
  const double compile_start = context.compile_ms();
  if (on_demand) {
    const std::uint64_t rows = hemicubes.rows_made(), entries = hemicubes.entries_made();
    result.solution = solve_on_demand(context, hemicubes, mesh, solve);
    statistics.rows = hemicubes.rows_made() - rows;
    statistics.entries = hemicubes.entries_made() - entries;
  } else {
    result.solution = solve_radiosity(context, mesh, matrix, solve);
  }
  statistics.rays = hemicubes.rays_traced() + statistics.factors.pair_rays + statistics.factors.sample_rays;
  statistics.solve_ms = lap();
  statistics.solve_compile_ms = context.compile_ms() - compile_start;
  result.irradiance = light.with_direct(result.solution.irradiance);
  if (options.residual_samples > 0) {
    result.continuous = find_continuous_residual(context, hemicubes, mesh, result.solution.radiosity,
                                                 options.residual_samples, options.factors.hemicube.seed);
    statistics.residual_ms = lap();
  }
  if (options.refine_patches > 0) {
    refine_solution(context, parallel, builder, flat, options, factors, std::move(matrix), light, result);
  }
  sum_power(light, result);
  add_ambient(result);
  statistics.peak_bytes = context.peak_bytes();
  return result;
}

}  // namespace hemiray

#include "host/radiosity/solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "host/base/clock.hpp"
#include "host/base/error.hpp"
#include "host/radiosity/factor_rounding.hpp"
#include "host/radiosity/solve_bound.hpp"
#include "host/radiosity/solve_checks.hpp"
#include "host/radiosity/solve_method.hpp"

namespace hemiray {
namespace {

// To know the bound costs about what an iteration does. So the next step to be judged is where the goal will be met if
// the bound goes on falling as it did between the last two, or, if it did not fall, a share of the iterations on. By
// that share, or a few, the end may be overshot.
constexpr std::uint32_t kJudgedShare = 4, kMostUnjudged = 4;

std::uint32_t next_judged(const std::vector<SolveStep>& history, double goal) {
  const SolveStep& last = history.back();
  const std::uint32_t share = last.iteration / kJudgedShare;
  if (history.size() < 2) return last.iteration + 1;
  const SolveStep& before = history[history.size() - 2];
  const double fall = std::log(before.bound / last.bound);  // infinite, or no number, where there was no bound
  if (!(fall > 0.0) || !std::isfinite(fall) || !(goal > 0.0)) return last.iteration + std::max(1U, share);
  const double steps = std::log(last.bound / goal) / fall * (last.iteration - before.iteration);
  const double most = std::max(kMostUnjudged, share);
  return last.iteration + static_cast<std::uint32_t>(std::clamp(std::ceil(steps), 1.0, most));
}

// What light that is still to be shot will bring on average (Cohen et al. 1988): it is reflected again and again with
// the mean reflectance of what light reaches.
void add_ambient(const PatchMesh& mesh, const SolverState& state, Solution& solution) {
  std::array<double, 3> unshot_w{}, reflected{};
  double area = 0.0;
  for (std::uint32_t s = 0; s < mesh.side_count(); s++) {
    if (state.reached[s] == 0) continue;
    const auto a = static_cast<double>(mesh.normals[s / 2].w);
    const shared::float4& rho = mesh.reflectance[s];
    const std::array<float, 3> rgb = {rho.x, rho.y, rho.z};
    for (std::size_t c = 0; c < 3; c++) {
      unshot_w[c] += a * state.residual[s][c];
      reflected[c] += a * static_cast<double>(rgb[c]);
    }
    area += a;
  }
  for (std::size_t c = 0; c < 3 && area > 0.0; c++) {
    solution.unshot_w += unshot_w[c];
    if (!solution.converged) solution.ambient[c] = unshot_w[c] / area / (1.0 - reflected[c] / area);
  }
}

// What rounding of factors takes from T B at most, relative to max |B|.
std::vector<double> rounding_sources(const PatchMesh& mesh, const std::vector<double>& changes) {
  const auto most = [](const shared::float4& v) { return static_cast<double>(std::max({v.x, v.y, v.z})); };
  std::vector<double> sources(changes.size());
  for (std::size_t s = 0; s < sources.size(); s++) {
    sources[s] = most(mesh.reflectance[s]) * changes[s] + most(mesh.transmittance[s]) * changes[s ^ 1U];
  }
  return sources;
}

// `matrix`: none where rows come on demand.
Solution iterate(const PatchMesh& mesh, const FactorMatrix* matrix, SolveMethod& method, const SolveOptions& options) {
  Solution solution;
  solution.kind = options.kind;
  std::vector<SolveStep>& history = solution.history;
  SolveBound bound;
  std::uint32_t iteration = 0, until = 0;  // iterations done; when the bound is known next
  const auto exchange = [&](Archive& archive) {
    archive.value(iteration);
    archive.value(until);
    archive.list(history);
    bound.exchange(archive);
    method.exchange(archive);
  };
  if (!options.continue_from.empty()) {
    Archive archive(options.continue_from);
    exchange(archive);
    archive.end();
    if (until > 0 && history.empty()) Archive::fail();
  }
  const auto offer = [&](bool ends) {
    if (!options.offer_state) return;
    options.offer_state(ends, [&exchange] {
      Archive archive;
      exchange(archive);
      return archive.take();
    });
  };
  const double start = steady_ms() - (history.empty() ? 0.0 : 1e3 * history.back().seconds);
  const auto seconds = [start] { return 1e-3 * (steady_ms() - start); };
  SolverState state;
  bool ended = false;
  for (;;) {
    while (iteration < until && !ended) {
      ended = (options.on_iteration && !options.on_iteration(iteration, history.back().bound)) ||
              (options.seconds > 0.0 && seconds() >= options.seconds);
      offer(ended);
      if (ended) break;
      method.step();
      iteration++;
    }
    if (ended && !state.radiosity.empty() && iteration == history.back().iteration) break;  // as judged
    state = method.state();
    SolveStep step = bound.judge(state);
    step.iteration = iteration;
    step.seconds = seconds();
    history.push_back(step);
    solution.largest = 0.0;
    for (const auto& b : state.radiosity) solution.largest = std::max({solution.largest, b[0], b[1], b[2]});
    const double goal = options.tolerance * solution.largest;
    solution.converged = step.bound <= goal;
    if (solution.converged || ended || iteration == options.iterations) break;
    until = std::min(next_judged(history, goal), options.iterations);
  }
  if (!ended) {
    // As before the last state was judged: who goes on from here does that again, and is at the end.
    const SolveStep last = history.back();
    history.pop_back();
    offer(true);
    history.push_back(last);
  }
  solution.irradiance = method.irradiance();
  solution.bounds = bound.of_sides();
  if (matrix != nullptr && matrix->precision() == FactorPrecision::half) {
    solution.rounding_bound =
        options.kind == SolverKind::southwell
            ? std::numeric_limits<double>::infinity()
            : bound.of_change(rounding_sources(mesh, row_changes(*matrix)), solution.largest + history.back().bound);
  }
  for (const auto& b : state.radiosity) solution.radiosity.push_back({b[0], b[1], b[2]});
  if (method.is_progressive()) add_ambient(mesh, state, solution);
  return solution;
}

// Which solver, and why.
struct Choice {
  SolverKind kind;
  std::string why;
  double asymmetry = 0.0;
};

Choice choose(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix, SolverKind asked) {
  if (asked != SolverKind::automatic && asked != SolverKind::cg) return {asked, ""};
  const bool must = asked == SolverKind::cg;
  if (is_translucent(mesh)) {
    if (must) {
      throw InputError("radiosity", "conjugate gradients need opaque sides, and some are translucent; take gmres");
    }
    return {SolverKind::gmres, "sides are translucent"};
  }
  const double asymmetry = find_asymmetry(context, mesh, matrix, kSymmetric);
  if (asymmetry <= kSymmetric) return {SolverKind::cg, must ? "" : "form factors are symmetric", asymmetry};
  if (must) {
    throw InputError("radiosity",
                     fmt::format("conjugate gradients need symmetric form factors, A_i F_ij = A_j F_ji, and these are "
                                 "apart by {:.2g} of the largest ({:.0e} is allowed); enforce symmetry or take gmres",
                                 asymmetry, kSymmetric));
  }
  return {SolverKind::gmres, "form factors are not symmetric", asymmetry};
}

}  // namespace

const char* to_string(SolverKind kind) {
  switch (kind) {
    case SolverKind::automatic:
      return "auto";
    case SolverKind::jacobi:
      return "jacobi";
    case SolverKind::gauss_seidel:
      return "gauss-seidel";
    case SolverKind::southwell:
      return "southwell";
    case SolverKind::cg:
      return "cg";
    case SolverKind::gmres:
      return "gmres";
  }
  return "";
}

Solution solve_radiosity(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix,
                         const SolveOptions& options) {
  check_solver_input(mesh, options);
  check_rows(context, mesh, matrix);
  const Choice choice = choose(context, mesh, matrix, options.kind);
  SolveOptions chosen = options;
  chosen.kind = choice.kind;
  std::unique_ptr<SolveMethod> method;
  if (chosen.kind == SolverKind::southwell) {
    method = make_shooting(context, mesh, &matrix, {}, chosen);
  } else if (chosen.kind == SolverKind::cg || chosen.kind == SolverKind::gmres) {
    method = make_krylov(context, mesh, matrix, chosen);
  } else {
    method = make_relaxation(context, mesh, matrix, chosen);
  }
  Solution solution = iterate(mesh, &matrix, *method, chosen);
  solution.why = choice.why;
  solution.asymmetry = choice.asymmetry;
  return solution;
}

Solution solve_radiosity_on_demand(Context& context, const PatchMesh& mesh, const RowsOnDemand& rows,
                                   const SolveOptions& options) {
  check_solver_input(mesh, options);
  SolveOptions chosen = options;
  chosen.kind = SolverKind::southwell;
  const std::unique_ptr<SolveMethod> method = make_shooting(context, mesh, nullptr, rows, chosen);
  Solution solution = iterate(mesh, nullptr, *method, chosen);
  solution.on_demand = true;
  if (options.kind == SolverKind::automatic) solution.why = "it needs no matrix";
  return solution;
}

}  // namespace hemiray

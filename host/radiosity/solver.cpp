#include "host/radiosity/solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "host/base/clock.hpp"
#include "host/base/error.hpp"
#include "host/gpu/program.hpp"

namespace hemiray {
namespace {

// Four columns of the device's `real`.
template <typename Real>
struct alignas(4 * sizeof(Real)) Real4 {
  Real v[4];
};

template <typename Real>
class System {
 public:
  System(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix)
      : context_(context),
        matrix_(matrix),
        count_(mesh.side_count()),
        program_(context, "radiosity", {"radiosity/solve.cl"}, program_options()),
        emission_(context, "emission", std::span(mesh.emission)),
        reflectance_(context, "reflectance", std::span(mesh.reflectance)),
        transmittance_(context, "transmittance", std::span(mesh.transmittance)),
        radiosity_(context, "radiosity", count_),
        incident_(context, "incident", count_),
        residual_(context, "residual", count_),
        own_(context, "own factors", count_) {
    incident_.clear();
    own_.clear();
    std::vector<Real4<Real>> start(count_);
    for (std::uint32_t s = 0; s < count_; s++) {
      const shared::float4& e = mesh.emission[s];
      start[s] = {{Real(e.x), Real(e.y), Real(e.z), Real(e.w)}};
    }
    radiosity_.write(start);
    for (const FactorBlock& block : matrix.blocks) {
      launch(context, program_.kernel("radiosity_find_own"), block.row_count,
             arguments(arg("rows", block.rows), arg("starts", block.starts), arg("columns", block.columns),
                       arg("values", block.values), arg("row_count", block.row_count), arg("own", own_)));
    }
  }

  void gather(const FactorBlock& block, std::uint32_t first, std::uint32_t count) {
    launch(context_, program_.kernel("radiosity_gather"), count,
           arguments(arg("rows", block.rows), arg("starts", block.starts), arg("columns", block.columns),
                     arg("values", block.values), arg("first", first), arg("count", count),
                     arg("radiosity", radiosity_), arg("incident", incident_)));
  }

  // residual = E + rho H(B) + tau H' - B.
  void find_residual() {
    for (const FactorBlock& block : matrix_.blocks) gather(block, 0, block.row_count);
    launch(context_, program_.kernel("radiosity_residual"), count_,
           arguments(materials(), arg("incident", incident_), arg("radiosity", radiosity_), arg("count", count_),
                     arg("residual", residual_)));
  }

  void jacobi() {
    launch(context_, program_.kernel("radiosity_add"), count_,
           arguments(arg("y", radiosity_), arg("x", residual_), arg("a", 1.0F), arg("count", count_)));
  }

  void gauss_seidel(std::uint32_t group) {
    for (const FactorBlock& block : matrix_.blocks) {
      for (std::uint32_t first = 0; first < block.row_count; first += group) {
        const std::uint32_t count = std::min(group, block.row_count - first);
        gather(block, first, count);
        launch(context_, program_.kernel("radiosity_relax"), count,
               arguments(arg("rows", block.rows), arg("first", first), arg("count", count), materials(),
                         arg("incident", incident_), arg("own", own_), arg("radiosity", radiosity_)));
      }
    }
  }

  [[nodiscard]] std::vector<Real4<Real>> radiosity() const { return radiosity_.read(); }
  [[nodiscard]] std::vector<Real4<Real>> incident() const { return incident_.read(); }
  [[nodiscard]] std::vector<Real4<Real>> residual() const { return residual_.read(); }

 private:
  static ProgramOptions program_options() {
    ProgramOptions options;
    options.double_precision = sizeof(Real) == sizeof(double);
    return options;
  }
  [[nodiscard]] Arguments materials() const {
    return arguments(arg("emission", emission_), arg("reflectance", reflectance_),
                     arg("transmittance", transmittance_));
  }

  Context& context_;
  const FactorMatrix& matrix_;
  std::uint32_t count_;
  Program program_;
  Buffer<shared::float4> emission_, reflectance_, transmittance_;
  Buffer<Real4<Real>> radiosity_, incident_, residual_;
  Buffer<float> own_;
};

// What the sums of a residual may be rounded by, per unit of E + rho H + B: a row has at most that many terms.
template <typename Real>
double rounding_of(const FactorMatrix& matrix) {
  const double unit = 0.5 * static_cast<double>(std::numeric_limits<Real>::epsilon());
  return (static_cast<double>(matrix.side_count) + 6.0) * unit;
}

template <typename Real>
void judge(const PatchMesh& mesh, const FactorMatrix& matrix, const std::vector<Real4<Real>>& radiosity,
           const std::vector<Real4<Real>>& residual, Solution& solution) {
  const double rounding = rounding_of<Real>(matrix);
  double largest_residual = 0.0, ratio = 0.0, largest = 0.0;
  for (std::uint32_t s = 0; s < mesh.side_count(); s++) {
    const double slack_w = rounding * (2.0 * static_cast<double>(radiosity[s].v[3]) + 1.0);
    const double margin = 1.0 - static_cast<double>(residual[s].v[3]) - slack_w;  // s = (I - rho F) w
    double r = 0.0;
    for (int c = 0; c < 3; c++) {
      const auto b = static_cast<double>(radiosity[s].v[c]);
      largest = std::max(largest, b);
      r = std::max(r, std::abs(static_cast<double>(residual[s].v[c])) + rounding * 2.0 * b);
    }
    largest_residual = std::max(largest_residual, r);
    ratio = margin > 0.0 ? std::max(ratio, r / margin) : std::numeric_limits<double>::infinity();
    if (!std::isfinite(ratio)) break;
  }
  double bound = 0.0;
  solution.bounds.resize(mesh.side_count());
  solution.radiosity.resize(mesh.side_count());
  for (std::uint32_t s = 0; s < mesh.side_count(); s++) {
    const Real* b = radiosity[s].v;
    solution.radiosity[s] = {static_cast<double>(b[0]), static_cast<double>(b[1]), static_cast<double>(b[2])};
    solution.bounds[s] = static_cast<double>(b[3]) * ratio;
    bound = std::max(bound, solution.bounds[s]);
  }
  solution.largest = largest;
  solution.history.push_back({largest_residual, bound, 0.0});
}

template <typename Real>
Solution solve(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix, const SolveOptions& options) {
  System<Real> system(context, mesh, matrix);
  Solution solution;
  const double start = steady_ms();
  for (std::uint32_t iteration = 0;; iteration++) {
    system.find_residual();
    judge<Real>(mesh, matrix, system.radiosity(), system.residual(), solution);
    SolveStep& step = solution.history.back();
    step.seconds = 1e-3 * (steady_ms() - start);
    solution.converged = step.bound <= options.tolerance * solution.largest;
    if (options.on_iteration && !options.on_iteration(iteration, step.bound)) break;
    if (solution.converged || iteration == options.iterations) break;
    if (options.seconds > 0.0 && step.seconds >= options.seconds) break;
    if (options.kind == SolverKind::jacobi) {
      system.jacobi();
    } else {
      system.gauss_seidel(options.group);
    }
  }
  for (const Real4<Real>& h : system.incident()) {
    solution.irradiance.push_back(
        {static_cast<double>(h.v[0]), static_cast<double>(h.v[1]), static_cast<double>(h.v[2])});
  }
  return solution;
}

}  // namespace

Solution solve_radiosity(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix,
                         const SolveOptions& options) {
  if (context.device().has_fp64) return solve<double>(context, mesh, matrix, options);
  return solve<float>(context, mesh, matrix, options);
}

}  // namespace hemiray

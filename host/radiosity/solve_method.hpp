// What the solvers have in common: they step, and tell where they stand.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "host/base/archive.hpp"
#include "host/gpu/program.hpp"
#include "host/radiosity/solver.hpp"

namespace hemiray {

/// Columns r, g, b, w of every side.
using SideColumns = std::vector<std::array<double, 4>>;

/// Where a solver stands. A residual is off by at most rounding (2 B + |r|) + residual_rounding |r|.
struct SolverState {
  SideColumns radiosity, residual;
  std::vector<std::uint32_t> reached;  ///< not 0: the side is of the system; empty: all are
  double rounding = 0.0, residual_rounding = 0.0;
};

class SolveMethod {
 public:
  SolveMethod() = default;
  SolveMethod(const SolveMethod&) = delete;
  SolveMethod& operator=(const SolveMethod&) = delete;
  SolveMethod(SolveMethod&&) = delete;
  SolveMethod& operator=(SolveMethod&&) = delete;
  virtual ~SolveMethod() = default;

  /// Writes, or reads, all that what follows depends on: steps after it give the same bits.
  virtual void exchange(Archive& archive) = 0;
  /// One iteration.
  virtual void step() = 0;
  virtual SolverState state() = 0;
  /// H, for the last state().
  virtual std::vector<std::array<double, 3>> irradiance() = 0;
  /// True: there is light that it has not sent, which the display may guess at.
  [[nodiscard]] virtual bool is_progressive() const { return false; }
};

std::unique_ptr<SolveMethod> make_relaxation(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix,
                                             const SolveOptions& options);
std::unique_ptr<SolveMethod> make_krylov(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix,
                                         const SolveOptions& options);
/// With rows from `matrix`, or, if there is none, from `rows`.
std::unique_ptr<SolveMethod> make_shooting(Context& context, const PatchMesh& mesh, const FactorMatrix* matrix,
                                           const RowsOnDemand& rows, const SolveOptions& options);

inline ProgramOptions solver_program_options(FactorPrecision factors, bool in_double) {
  ProgramOptions options;
  options.double_precision = in_double;
  options.defines = factor_defines(factors);
  return options;
}

/// The kernels of the checks and of all solvers but southwell: one program, since each takes tens of milliseconds to
/// load even where it was compiled before.
inline Program solver_program(Context& context, FactorPrecision factors, bool in_double) {
  return {context,
          "radiosity",
          {"radiosity/solve.cl", "radiosity/krylov.cl", "radiosity/symmetry.cl"},
          solver_program_options(factors, in_double)};
}

/// Whether the solver computes in double.
inline bool solves_in_double(const Context& context, const SolveOptions& options) {
  return context.device().has_fp64 && !options.single_precision;
}

}  // namespace hemiray

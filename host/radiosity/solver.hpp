// Solves the radiosity system on the device, to a bound of the error that the solution itself proves.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host/radiosity/factor_matrix.hpp"
#include "host/radiosity/patch_mesh.hpp"

namespace hemiray {

/// jacobi: all sides at once. gauss_seidel: in groups of rows, each with the newest values of those before (the
/// source's way, a group being one row there). shooting: the sides with most unshot power first, by reciprocity
/// (Southwell; Cohen et al. 1988). conjugate_gradients: on the area-weighted symmetric form; needs symmetric factors
/// and no translucent side.
enum class SolverKind { jacobi, gauss_seidel };

struct SolveOptions {
  SolverKind kind = SolverKind::gauss_seidel;
  double tolerance = 1e-4;                                  ///< of the bound, relative to the largest radiosity
  std::uint32_t iterations = 1000;                          ///< at most
  double seconds = 0.0;                                     ///< at most; 0: no limit
  std::uint32_t group = 128;                                ///< rows of gauss_seidel that are relaxed together
  std::function<bool(std::uint32_t, double)> on_iteration;  ///< gets number and bound; returning false ends it
};

/// After an iteration.
struct SolveStep {
  double residual = 0.0;  ///< largest |E + rho H - B| of all sides and colours [W/m^2]
  double bound = 0.0;     ///< no side's radiosity is farther off than this [W/m^2]; infinite: not known yet
  double seconds = 0.0;   ///< since the start
};

struct Solution {
  std::vector<std::array<double, 3>> radiosity;   ///< B of the sides, rgb [W/m^2]
  std::vector<std::array<double, 3>> irradiance;  ///< H, what arrives on the sides from others, rgb [W/m^2]
  std::vector<double> bounds;  ///< of each side's error, all colours [W/m^2]: |B* - B|_i <= bounds[i], B* solving the
                               ///< system with these factors
  std::vector<SolveStep> history;
  bool converged = false;
  double largest = 0.0;  ///< of the radiosities [W/m^2]
};

/// Solves B = E + rho F B. The bound: with w > 0 and s = (I - rho F) w > 0 for the largest rho of the colours, |B* - B|
/// <= w max |r| / s, r the residual (a weighted maximum norm; Collatz 1966; w approximates (I - rho F)^-1 1, so that it
/// stays sharp for rho near 1). Residuals are computed in double where the device has it, else in float, and what they
/// may be rounded by is in the bound. Throws InputError where no solution exists (a row sum with rho makes 1 or more
/// wherever light goes), with the patch.
Solution solve_radiosity(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix,
                         const SolveOptions& options = {});

}  // namespace hemiray

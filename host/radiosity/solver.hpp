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

/// automatic: conjugate gradients where they can be had, else gmres; southwell without a matrix.
/// jacobi: all sides at once.
/// gauss_seidel: in groups of rows, each with the newest values of those before (the source's way, a group being one
/// row there).
/// southwell: the sides with most unshot light first, columns by reciprocity from rows (Cohen et al. 1988): what it
/// solves is the system with F_ki = F_ik A_i / A_k, the same one only where factors are symmetric.
/// cg: conjugate gradients on A / rho B - A F B = A / rho E, preconditioned by A / rho (Hestenes, Stiefel 1952); needs
/// symmetric A_i F_ij and no translucent side.
/// gmres: restarted generalised minimal residuals (Saad, Schultz 1986), which needs neither.
enum class SolverKind { automatic, jacobi, gauss_seidel, southwell, cg, gmres };
const char* to_string(SolverKind kind);

/// What southwell picks by: unshot power |e_i| A_i, or the residual |e_i| (the source's). Colours are summed.
enum class ShotPick { power, residual };

struct SolveOptions {
  SolverKind kind = SolverKind::automatic;
  double tolerance = 1e-4;                                  ///< of the bound, relative to the largest radiosity
  std::uint32_t iterations = 10000;                         ///< at most
  double seconds = 0.0;                                     ///< at most; 0: no limit
  std::uint32_t group = 128;                                ///< rows of gauss_seidel that are relaxed together
  std::uint32_t shots = 16;                                 ///< sides that southwell shoots an iteration, 1 to 256
  ShotPick pick = ShotPick::power;                          ///< of southwell
  std::uint32_t restart = 30;                               ///< iterations of gmres and cg between fresh residuals, > 0
  bool single_precision = false;                            ///< as on a device without double
  std::function<bool(std::uint32_t, double)> on_iteration;  ///< gets number and last bound; returning false ends it
  /// Offered between iterations and, with `ends`, after the last one: `state` gives what a solver of the same system
  /// with the same options takes as continue_from, to end with the same bits as one that was never stopped.
  std::function<void(bool ends, const std::function<std::vector<std::uint8_t>()>& state)> offer_state;
  std::vector<std::uint8_t> continue_from;  ///< empty: the start
};

/// What holds after an iteration. Not after each: what it costs to know stays a fraction of the iterations.
struct SolveStep {
  std::uint32_t iteration = 0;  ///< iterations done
  double residual = 0.0;        ///< largest |E + rho H - B| of all sides and colours [W/m^2]
  double bound = 0.0;           ///< no side's radiosity is farther off than this [W/m^2]; infinite: not known yet
  double seconds = 0.0;         ///< since the start
};

struct Solution {
  SolverKind kind = SolverKind::automatic;        ///< that was used
  std::string why;                                ///< it, where it was chosen
  std::vector<std::array<double, 3>> radiosity;   ///< B of the sides, rgb [W/m^2]
  std::vector<std::array<double, 3>> irradiance;  ///< H, what arrives on the sides from others, rgb [W/m^2]
  std::vector<double> bounds;  ///< of each side's error, all colours [W/m^2]: |B* - B|_i <= bounds[i], B* solving the
                               ///< system with these factors
  std::vector<SolveStep> history;
  bool converged = false;
  bool on_demand = false;  ///< rows were computed when sides were shot, and dropped
  double largest = 0.0;    ///< of the radiosities [W/m^2]
  /// With factors in half precision: no radiosity differs by more from that with factors in single [W/m^2], both exact.
  /// Infinite where it is not known: of southwell, which takes columns from rounded rows. In single: 0.
  double rounding_bound = 0.0;
  double asymmetry = 0.0;  ///< max |A_i F_ij - A_j F_ji| / max A_i F_ij; where it was not asked: 0
  double unshot_w = 0.0;   ///< southwell's power not shot yet, all colours [W]
  std::array<double, 3> ambient{0.0, 0.0, 0.0};  ///< irradiance that it will bring on average, rgb [W/m^2]; 0 once
                                                 ///< converged
};

/// Solves B = E + rho F B (+ tau of what comes to the other side). The bound: with w > 0 and s = (I - rho F) w > 0 for
/// the largest rho of the colours, |B* - B| <= w max |r| / s, r the residual (a weighted maximum norm; Collatz 1966; w
/// approximates (I - rho F)^-1 1, so that it stays sharp for rho near 1; the best w so far counts). Residuals are
/// computed in double where the device has it, else in float-float, and what they may be rounded by is in the bound.
/// Throws InputError with the side at fault where rho + tau >= 1, a factor is negative or no number, a row sum times
/// rho (and tau) is 1 or more, or options are out of range; with advice where cg is asked for and factors are not
/// symmetric to 1e-5 of the largest, or a side is translucent; where continue_from does not fit the system.
Solution solve_radiosity(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix,
                         const SolveOptions& options = {});

/// Gives rows of sides, in blocks whose rows keep the order.
using RowsOnDemand = std::function<FactorMatrix(std::span<const std::uint32_t> sides)>;

/// The same by southwell, without a matrix: the rows of the sides to be shot are asked for and dropped.
Solution solve_radiosity_on_demand(Context& context, const PatchMesh& mesh, const RowsOnDemand& rows,
                                   const SolveOptions& options = {});

}  // namespace hemiray

// A scene's diffuse light, from mesh to solution.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/radiosity/continuous_residual.hpp"
#include "host/radiosity/display.hpp"
#include "host/radiosity/factor_rounding.hpp"
#include "host/radiosity/form_factors.hpp"
#include "host/radiosity/hemicubes.hpp"
#include "host/radiosity/patch_mesh.hpp"
#include "host/radiosity/solution_file.hpp"
#include "host/radiosity/solver.hpp"

namespace hemiray {

struct RadiosityOptions {
  PatchOptions mesh;
  FactorOptions factors;
  SolveOptions solve;
  std::uint64_t factor_bytes = 0;  ///< for form factors, at most; 0: most of what is free on the device
  KeepOptions keep;
  /// The mesh is refined where the solution asks for it, to at most so many patches; 0: it is not. More than the mesh
  /// has to begin with.
  std::uint32_t refine_patches = 0;
  std::uint32_t residual_samples = 4096;  ///< points at which the equation of light is tried; 0: none
  std::function<bool(const std::string& step, double fraction)> on_progress;  ///< returning false ends the step early
};

/// A mesh refined once, and its solution.
struct RefineRound {
  std::uint32_t patches = 0, cut = 0;     ///< now; of those before, how many were cut
  std::uint64_t made_rows = 0, rows = 0;  ///< form factors computed anew; of all
  std::uint64_t rays = 0;                 ///< for them
  double jump = 0.0;                      ///< after it: between neighbours, as RefineReport::jump
  double mesh_ms = 0.0, factors_ms = 0.0, solve_ms = 0.0;
  ContinuousResidual continuous;  ///< after it
};

struct RefineReport {
  std::uint32_t patches = 0;  ///< before
  /// What neighbours' light differs by (refine_choice.hpp), the root of its mean square over area [W/m^2], before: what
  /// the continuous residual is due to, without the noise of its rays, which a small lamp is lost in.
  double jump = 0.0;
  ContinuousResidual continuous;  ///< before
  std::vector<RefineRound> rounds;
  std::string end;  ///< why there are no more
};

struct RadiosityStatistics {
  double mesh_ms = 0.0, tree_ms = 0.0, factors_ms = 0.0, solve_ms = 0.0;
  double solve_compile_ms = 0.0;  ///< of solve_ms, for kernels: compiling, or loading what was compiled before
  std::uint64_t rays = 0;         ///< through cells of hemicubes and between pairs
  std::uint64_t rows = 0;         ///< sides that light comes to, or rows computed on demand
  std::uint64_t kept_rows = 0;    ///< of them, those that a file had
  std::uint64_t entries = 0;      ///< factors that are not zero, in them
  std::uint64_t factor_bytes = 0, peak_bytes = 0;
  std::uint64_t factor_limit = 0;           ///< for factors, bytes
  std::uint64_t factor_bytes_at_most = 0;   ///< bound before any row was known
  std::uint64_t expected_factor_bytes = 0;  ///< last, from the rows known and to come
  double emitted_w = 0.0;                   ///< power that sources send and lights bring, all colours
  double absorbed_w = 0.0;                  ///< power that surfaces take
  double residual_ms = 0.0;
  FactorPrecision precision = FactorPrecision::single;  ///< asked for; rows on demand are in single
  std::optional<FactorRounding> rounding;               ///< what it did to the factors that are kept
  FactorReport factors;
  std::string why_hemicubes;  ///< where pair by pair was asked for, and the factors would not fit; else empty
  RefineReport refinement;
  bool interrupted = false;
};

struct Radiosity {
  PatchMesh mesh;
  Solution solution;
  /// Of the sides, from other patches and from lights, rgb [W/m^2]; with the ambient term where light is unshot.
  std::vector<std::array<double, 3>> irradiance;
  ContinuousResidual continuous;
  RadiosityStatistics statistics;
};

/// Meshes the scene, computes form factors for all sides that light reaches, and solves. Lights that are no surfaces
/// come in as rho times the irradiance they bring. Where the factors would take more than their memory, which is known
/// from the first rows before the others are computed, southwell solves without a matrix; InputError if another solver
/// is asked for. `keep` has a file written at the start, between batches of hemicubes' rows (factors pair by pair are
/// kept once they are whole), between iterations, on interrupt and at the end; from it the same bits come out. Then the
/// mesh is refined, if asked for; the file has the solution before. Mesh, solution and its bounds, irradiance and
/// continuous residual are then those of the refined mesh, as are the statistics' rows, entries and bytes; rays and
/// times are of all, the report of factors and the forecast of memory of the first mesh. Throws InputError for what
/// cannot be meshed, solved or refined, DeviceError if the device fails or is too small.
Radiosity compute_radiosity(Context& context, const FlatScene& flat, const RadiosityOptions& options);

}  // namespace hemiray

// A scene's diffuse light, from mesh to solution.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/radiosity/display.hpp"
#include "host/radiosity/form_factors.hpp"
#include "host/radiosity/hemicubes.hpp"
#include "host/radiosity/patch_mesh.hpp"
#include "host/radiosity/solver.hpp"

namespace hemiray {

struct RadiosityOptions {
  PatchOptions mesh;
  FactorOptions factors;
  SolveOptions solve;
  std::function<bool(const std::string& step, double fraction)> on_progress;  ///< returning false ends the step early
};

struct RadiosityStatistics {
  double mesh_ms = 0.0, tree_ms = 0.0, factors_ms = 0.0, solve_ms = 0.0;
  std::uint64_t rays = 0;     ///< through cells of hemicubes and between pairs
  std::uint64_t rows = 0;     ///< sides that light comes to
  std::uint64_t entries = 0;  ///< factors that are not zero
  std::uint64_t factor_bytes = 0, peak_bytes = 0;
  double emitted_w = 0.0;   ///< power that sources send and lights bring, all colours
  double absorbed_w = 0.0;  ///< power that surfaces take
  FactorReport factors;
  bool interrupted = false;
};

struct Radiosity {
  PatchMesh mesh;
  Solution solution;
  std::vector<std::array<double, 3>> irradiance;  ///< of the sides, from other patches and from lights, rgb [W/m^2]
  RadiosityStatistics statistics;
};

/// Meshes the scene, computes form factors for all sides that light reaches, and solves. Lights that are no surfaces
/// come in as rho times the irradiance they bring. Throws InputError for what cannot be meshed or solved, DeviceError
/// if the device fails or is too small.
Radiosity compute_radiosity(Context& context, const FlatScene& flat, const RadiosityOptions& options);

}  // namespace hemiray

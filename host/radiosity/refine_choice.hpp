// Which patches a solution is too coarse on.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/radiosity/patch_mesh.hpp"

namespace hemiray {

/// What a patch's light differs by from its neighbours'.
struct RefineChoice {
  std::vector<std::uint32_t> patches;  ///< that differ by more than was asked for: those that err most first
  double largest_jump = 0.0;           ///< of all patches [W/m^2]
  double mean_jump = 0.0;              ///< root of their mean square over area [W/m^2]
};

/// `irradiance` of the sides, rgb [W/m^2]. The jump of a patch is that of rho H, of its own rho (what a texture varies
/// by does not count) as the root of the mean square of its colours, to the neighbours across its edges, but for
/// creases (20 degrees); it stands for the light's gradient, a shadow's boundary, and lamps that are seen in part.
/// Patches are ordered by area times jump squared, their share in the mean square of the equation's residual; at equal
/// ones the lower number comes first.
RefineChoice patches_to_refine(const PatchMesh& mesh, const std::vector<std::array<double, 3>>& irradiance,
                               double least_jump);

}  // namespace hemiray

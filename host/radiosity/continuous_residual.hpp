// What the mesh costs: how far a solution, constant on each patch, is from the equation of light at points of it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/radiosity/hemicubes.hpp"

namespace hemiray {

/// The root of the mean square over area and colours of E + K B_h - B_h, with where it lies by 95 %. Times 1 / (1 -
/// rho) it bounds the mean error of B_h in the same norm (Arvo, Torrance, Smits 1994). Emission, reflectance and what
/// lights that are no surfaces bring count as the patches' means.
struct ContinuousResidual {
  std::uint32_t samples = 0;                        ///< points; 0: not asked for
  std::uint32_t rays = 0;                           ///< a point
  double rms = 0.0, rms_low = 0.0, rms_high = 0.0;  ///< [W/m^2]
  double radiosity_rms = 0.0;                       ///< of B_h, to compare with [W/m^2]
};

/// Looks from `samples` random points of the sides that have light, by area.
ContinuousResidual find_continuous_residual(Context& context, const Hemicubes& hemicubes, const PatchMesh& mesh,
                                            const std::vector<std::array<double, 3>>& radiosity, std::uint32_t samples,
                                            std::uint32_t seed);

}  // namespace hemiray

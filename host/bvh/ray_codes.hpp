// What kernels/lib/ray_code.h needs from the host.
#pragma once

#include <algorithm>

#include "shared/scalar.h"

namespace hemiray {

inline constexpr unsigned kRayCodeBits = 21;  ///< HR_RAY_CODE_BITS

inline constexpr float kMostCells = 1e37F;  ///< a metre: times a float's least distance still finite

/// Cells per metre of the lattice over bounds lo, hi [m] in which rays start; 0 along an axis without extent.
inline shared::float4 ray_code_scale(const shared::float4& lo, const shared::float4& hi) {
  const auto cells = [](float from, float to) { return to > from ? std::min(16.0F / (to - from), kMostCells) : 0.0F; };
  return {cells(lo.x, hi.x), cells(lo.y, hi.y), cells(lo.z, hi.z), 0.0F};
}

}  // namespace hemiray

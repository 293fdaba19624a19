// An oracle of rays against one implicit polynomial surface: every root along the exact ray, in multi-precision
// (host/stability/precise_line.hpp).
//
// The bound. A hit is right if a root lies within kBoundUlps ulps of t or of the origin's coordinates, whichever are
// larger, or if the surface's value there is below what float-float arithmetic makes of the terms that add up to it. A
// miss is right if no root lies within the clip; at the clip's boundary, within kAtClip of it, both are. The kernels
// also say where they cannot tell (`uncertain`): whoever asks them counts that.
#pragma once

#include <span>
#include <vector>

#include "host/scene/flat_scene.hpp"
#include "host/stability/precise_line.hpp"
#include "host/stability/rates.hpp"
#include "shared/bvh_types.h"

namespace hemiray::stability {

inline constexpr double kAtClip = 1e-4;  ///< of the clip's size, and a tenth of that of the way to its middle

/// What one ray meets.
struct ImplicitTruth {
  struct Meeting {
    double t = 0.0;        ///< [in lengths of the direction]
    bool certain = false;  ///< the sign changes there, well within the clip and beyond t_min
  };
  std::vector<Meeting> meetings;  ///< the nearest first
  PrecisePolynomial polynomial;   ///< of s, t = m + h s; empty where the ray passes the clip
  double m = 0.0, h = 1.0;
};

/// One scene of one implicit surface and nothing else, which must outlive it; std::logic_error for any other.
class ImplicitOracle {
 public:
  explicit ImplicitOracle(const FlatScene& flat);
  [[nodiscard]] ImplicitTruth meet(const shared::QueryRay& ray) const;
  /// Adds an answer to the counts.
  void judge(const shared::QueryRay& ray, const ImplicitTruth& truth, const shared::QueryHit& answer,
             Tally& tally) const;

 private:
  [[nodiscard]] bool is_noise(const shared::QueryRay& ray, const ImplicitTruth& truth, double t) const;

  const shared::Shape* surface_;
  std::span<const shared::uint4> tape_;
};

}  // namespace hemiray::stability

// How far off a solution can be, from its residual.
#pragma once

#include "host/radiosity/solve_method.hpp"

namespace hemiray {

/// The certificate: |B* - B|_i <= w_i max_k |r_k| / s_k for any w > 0 with s = (I - rho F) w > 0. What w and s were at
/// any time stays true of the matrix, so the best pair is kept.
class SolveBound {
 public:
  /// Largest residual and bound of a state; infinite while no w is certified.
  SolveStep judge(const SolverState& state);

  /// How far radiosities can be from those of other factors, if all |(T' - T) B|_i <= sources[i] max |B|, T = I - rho F
  /// - tau F' of these and T' of the others, and `largest` >= |B| of these: by T (B' - B) = (T - T') B' and the
  /// certificate. Infinite if there is none, or if it is too large to tell.
  [[nodiscard]] double of_change(const std::vector<double>& sources, double largest) const;

  void exchange(Archive& archive);

  /// Of each side, for the state judged last.
  [[nodiscard]] std::vector<double> of_sides() const;

 private:
  std::vector<double> weights_, margins_;  ///< w and what s is at least, of the best so far; empty: none
  double ratio_ = 0.0;                     ///< max |r| / s of the last state
  std::size_t sides_ = 0;
};

}  // namespace hemiray

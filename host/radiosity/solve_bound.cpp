#include "host/radiosity/solve_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hemiray {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

bool is_reached(const SolverState& state, std::size_t side) {
  return state.reached.empty() || state.reached[side] != 0;
}

// What a residual may be, rounding counted.
double at_most(const SolverState& state, std::size_t side, std::size_t column) {
  const double b = std::abs(state.radiosity[side][column]), r = std::abs(state.residual[side][column]);
  return r * (1.0 + state.rounding + state.residual_rounding) + state.rounding * 2.0 * b;
}

double ratio_of(const std::vector<double>& residuals, const std::vector<double>& margins) {
  double ratio = 0.0;
  for (std::size_t s = 0; s < residuals.size(); s++) {
    if (residuals[s] > 0.0) ratio = margins[s] > 0.0 ? std::max(ratio, residuals[s] / margins[s]) : kInfinite;
    if (!std::isfinite(ratio)) break;
  }
  return ratio;
}

double largest_of(const std::vector<double>& values) {
  return values.empty() ? kInfinite : *std::max_element(values.begin(), values.end());
}

}  // namespace

SolveStep SolveBound::judge(const SolverState& state) {
  sides_ = state.radiosity.size();
  std::vector<double> residuals(sides_, 0.0), weights(sides_, 0.0), margins(sides_, 0.0);
  bool certified = true;
  for (std::size_t s = 0; s < sides_; s++) {
    for (std::size_t c = 0; c < 3; c++) {
      const double r = at_most(state, s, c);
      residuals[s] = r <= residuals[s] ? residuals[s] : r;  // takes NaN
    }
    if (!is_reached(state, s)) continue;
    weights[s] = state.radiosity[s][3];
    const double slack = at_most(state, s, 3) - std::abs(state.residual[s][3]);
    margins[s] = 1.0 - state.residual[s][3] - slack;
    certified = certified && weights[s] > 0.0 && margins[s] > 0.0;
  }
  SolveStep step;
  step.residual = largest_of(residuals);
  ratio_ = weights_.empty() ? kInfinite : ratio_of(residuals, margins_);
  step.bound = weights_.empty() ? kInfinite : ratio_ * largest_of(weights_);
  if (certified) {
    const double ratio = ratio_of(residuals, margins), bound = ratio * largest_of(weights);
    if (!(bound >= step.bound)) {
      ratio_ = ratio;
      step.bound = bound;
      weights_ = std::move(weights);
      margins_ = std::move(margins);
    }
  }
  if (std::isnan(step.residual)) step.bound = kInfinite;
  return step;
}

double SolveBound::of_change(const std::vector<double>& sources, double largest) const {
  if (weights_.empty()) return kInfinite;
  const double share = ratio_of(sources, margins_) * largest_of(weights_);  // of max |B'| <= largest + what is sought
  return share < 1.0 ? share * largest / (1.0 - share) : kInfinite;
}

void SolveBound::exchange(Archive& archive) {
  archive.list(weights_);
  archive.list(margins_);
  archive.value(ratio_);
}

std::vector<double> SolveBound::of_sides() const {
  std::vector<double> bounds(sides_, kInfinite);
  for (std::size_t s = 0; s < weights_.size(); s++)
    bounds[s] = std::isfinite(ratio_) ? weights_[s] * ratio_ : kInfinite;
  return bounds;
}

}  // namespace hemiray

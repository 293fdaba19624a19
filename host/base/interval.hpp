// Intervals of doubles that surely hold what they stand for: every result is rounded outwards.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace hemiray {

struct Interval {
  double lo = 0.0, hi = 0.0;

  Interval() = default;
  Interval(double value) : lo(value), hi(value) {}  // NOLINT(google-explicit-constructor): a number is an interval
  Interval(double low, double high) : lo(low), hi(high) {}

  /// False only if 0 is surely not in it; what is not a number may be anything.
  [[nodiscard]] bool may_be_zero() const { return !(lo > 0.0 || hi < 0.0); }
};

/// [lo, hi] as computed with one rounding each, moved outwards by more than that; everything if that is not finite.
/// As Rump 2010, "Verification methods", (2.18), without changing the mode of rounding.
inline Interval outwards(double lo, double hi) {
  constexpr double kUlp = std::numeric_limits<double>::epsilon(), kLeast = std::numeric_limits<double>::min();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (!std::isfinite(hi - lo)) return {-kInfinity, kInfinity};
  return {lo - (std::abs(lo) * kUlp + kLeast), hi + (std::abs(hi) * kUlp + kLeast)};
}

inline Interval operator-(const Interval& a) { return {-a.hi, -a.lo}; }
inline Interval operator+(const Interval& a, const Interval& b) { return outwards(a.lo + b.lo, a.hi + b.hi); }
inline Interval operator-(const Interval& a, const Interval& b) { return outwards(a.lo - b.hi, a.hi - b.lo); }

inline Interval operator*(const Interval& a, const Interval& b) {
  const double p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
  if (!std::isfinite(p + q + r + s)) return outwards(p, std::numeric_limits<double>::quiet_NaN());
  return outwards(std::min(std::min(p, q), std::min(r, s)), std::max(std::max(p, q), std::max(r, s)));
}

inline Interval square(const Interval& a) {
  const double low = a.lo * a.lo, high = a.hi * a.hi;
  Interval result = outwards(a.may_be_zero() ? 0.0 : std::min(low, high), std::max(low, high));
  result.lo = std::max(result.lo, 0.0);
  return result;
}

/// What is in both; they must have something in common.
inline Interval common(const Interval& a, const Interval& b) { return {std::max(a.lo, b.lo), std::min(a.hi, b.hi)}; }

}  // namespace hemiray

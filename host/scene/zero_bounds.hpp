// How far a surface f(x, y, z) = 0 reaches within a clip: by interval arithmetic, so never too little.
#pragma once

#include <array>
#include <functional>

#include "host/base/interval.hpp"
#include "host/base/vec.hpp"
#include "host/scene/bounds.hpp"

namespace hemiray {

/// A function's value and gradient, each within an interval.
struct Jet {
  Interval value;
  std::array<Interval, 3> slope;

  Jet(double constant = 0.0) : value(constant) {}  // NOLINT(google-explicit-constructor): a number is constant
  explicit Jet(const Interval& constant) : value(constant) {}
};

Jet operator-(const Jet& a);
Jet operator+(const Jet& a, const Jet& b);
Jet operator-(const Jet& a, const Jet& b);
Jet operator*(const Jet& a, const Jet& b);
Jet square(const Jet& a);

/// f of three coordinates in two arithmetics; both must be enclosures of the same function.
struct BoxFunction {
  std::function<Jet(const Jet& x, const Jet& y, const Jet& z)> jet;
  std::function<Interval(const Interval& x, const Interval& y, const Interval& z)> value;
};

/// A box, or with `ball` the ball of radius half.x, in the surface's frame.
struct ClipRegion {
  DVec3 center{0.0};
  DVec3 half{1.0};
  bool ball = false;
};

/// The largest of toward . p for the points p of the clip where f may be 0: larger than the truth by about 1/250 of
/// the clip, or more where the search's budget ends, but never smaller; -infinity if f surely is 0 nowhere in it.
[[nodiscard]] double farthest_zero(const BoxFunction& f, const ClipRegion& clip, const DVec3& toward);

/// Bounds of place + to_world p for these points; empty if there surely are none.
[[nodiscard]] WorldBounds zero_bounds(const BoxFunction& f, const ClipRegion& clip, const glm::dmat3& to_world,
                                      const DVec3& place);

}  // namespace hemiray

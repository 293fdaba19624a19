#include "host/scene/zero_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <vector>

namespace hemiray {
namespace {

// A part this small a share of the clip is not cut any more.
constexpr double kFinest = 1.0 / 256.0;
// Parts cut in one search; what is open then counts as full.
constexpr int kMostCuts = 1000;

struct Part {
  DVec3 middle, half;
  double top;  // of toward . p over it
  // Of those that reach equally far the smallest goes first, as it ends the search.
  bool operator<(const Part& other) const { return top < other.top || (top == other.top && half.x > other.half.x); }
};

Jet coordinate(int axis, const Interval& value) {
  Jet jet(value);
  jet.slope[static_cast<std::size_t>(axis)] = 1.0;
  return jet;
}

// Whether f may be 0 in the part, and where the part is `inside` of the clip, be farthest there: then its gradient has
// the direction of `toward` or its opposite, or is 0.
bool may_be_farthest(const BoxFunction& f, const Part& part, const DVec3& toward, bool inside) {
  const DVec3 &m = part.middle, &h = part.half;
  const auto side = [&](int k) { return outwards(m[k] - h[k], m[k] + h[k]); };
  if (!f.value(side(0), side(1), side(2)).may_be_zero()) return false;
  const Jet over = f.jet(coordinate(0, side(0)), coordinate(1, side(1)), coordinate(2, side(2)));
  if (inside) {
    for (int k = 0; k < 3; k++) {
      const int a = (k + 1) % 3, b = (k + 2) % 3;
      const Interval across = Interval(toward[a]) * over.slope[static_cast<std::size_t>(b)] -
                              Interval(toward[b]) * over.slope[static_cast<std::size_t>(a)];
      if (!across.may_be_zero()) return false;
    }
  }
  // The mean value form: its width beyond the truth falls with the square of the part's size.
  Interval value = f.value(m.x, m.y, m.z);
  for (int k = 0; k < 3; k++) {
    value = value + over.slope[static_cast<std::size_t>(k)] * outwards(-h[k], h[k]);
  }
  return value.may_be_zero();
}

}  // namespace

Jet operator-(const Jet& a) {
  Jet result(-a.value);
  for (std::size_t k = 0; k < 3; k++) result.slope[k] = -a.slope[k];
  return result;
}

Jet operator+(const Jet& a, const Jet& b) {
  Jet result(a.value + b.value);
  for (std::size_t k = 0; k < 3; k++) result.slope[k] = a.slope[k] + b.slope[k];
  return result;
}

Jet operator-(const Jet& a, const Jet& b) { return a + -b; }

Jet operator*(const Jet& a, const Jet& b) {
  Jet result(a.value * b.value);
  for (std::size_t k = 0; k < 3; k++) result.slope[k] = a.value * b.slope[k] + a.slope[k] * b.value;
  return result;
}

Jet square(const Jet& a) {
  Jet result(square(a.value));
  for (std::size_t k = 0; k < 3; k++) result.slope[k] = Interval(2.0) * a.value * a.slope[k];
  return result;
}

// Branch and bound, always on with the part that reaches farthest: what it reaches to bounds all that is left.
double farthest_zero(const BoxFunction& f, const ClipRegion& clip, const DVec3& toward) {
  const double radius = clip.half.x;
  const auto part_at = [&](const DVec3& middle, const DVec3& half) {
    double top = glm::dot(toward, middle) + glm::dot(glm::abs(toward), half);
    if (clip.ball) top = std::min(top, glm::dot(toward, clip.center) + glm::length(toward) * radius);
    return Part{middle, half, top};
  };
  std::priority_queue<Part> parts;
  parts.push(part_at(clip.center, clip.half));
  for (int cuts = 0; !parts.empty() && cuts < kMostCuts; cuts++) {
    const Part whole = parts.top();
    if (whole.half.x <= kFinest * clip.half.x) return whole.top;
    parts.pop();
    const DVec3 half = 0.5 * whole.half;
    for (unsigned corner = 0; corner < 8; corner++) {
      const DVec3 side((corner & 1U) != 0 ? 1.0 : -1.0, (corner & 2U) != 0 ? 1.0 : -1.0,
                       (corner & 4U) != 0 ? 1.0 : -1.0);
      const Part part = part_at(whole.middle + side * half, half);
      const DVec3 from = glm::abs(part.middle - clip.center);
      if (clip.ball && glm::length(glm::max(from - half, 0.0)) > radius) continue;
      const bool inside =
          clip.ball ? glm::length(from + half) < radius : glm::all(glm::lessThan(from + 1.5 * half, clip.half));
      if (may_be_farthest(f, part, toward, inside)) parts.push(part);
    }
  }
  return parts.empty() ? -std::numeric_limits<double>::infinity() : parts.top().top;
}

WorldBounds zero_bounds(const BoxFunction& f, const ClipRegion& clip, const glm::dmat3& to_world, const DVec3& place) {
  WorldBounds bounds;
  for (int axis = 0; axis < 3; axis++) {
    const DVec3 row(to_world[0][axis], to_world[1][axis], to_world[2][axis]);
    bounds.max[axis] = place[axis] + farthest_zero(f, clip, row);
    bounds.min[axis] = place[axis] - farthest_zero(f, clip, -row);
  }
  if (bounds.empty()) return {};
  return bounds;
}

}  // namespace hemiray

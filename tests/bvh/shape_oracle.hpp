// An oracle of rays against shapes, in long double and by other formulas than the kernels': from the numbers as stored
// on the device. It knows how sure it is.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "host/base/vec.hpp"
#include "shared/bvh_types.h"
#include "shared/scene_types.h"

namespace hemiray::test {

using Wide = glm::vec<3, long double>;
using WideMatrix = glm::mat<3, 3, long double>;

inline Wide wide(const shared::float4& v) { return {v.x, v.y, v.z}; }

/// One place where the ray meets the shape's surface.
struct SurfaceHit {
  long double t = 0;
  long double cosine = 0;  ///< between ray and normal, without sign
  long double margin = 0;  ///< how far inside of its rim or clip, and how deep the ray goes below a curved surface [m]
  int part = HR_PART_SIDE;
};

class ShapeOracle {
 public:
  explicit ShapeOracle(const shared::Shape& shape)
      : shape_(shape),
        rows_(WideMatrix(wide(shape.to_own_x), wide(shape.to_own_y), wide(shape.to_own_z))),
        to_own_(glm::transpose(rows_)),
        to_world_(glm::inverse(to_own_)),
        place_(shape.to_own_x.w, shape.to_own_y.w, shape.to_own_z.w) {}

  [[nodiscard]] long double reach() const { return shape_.lo.w; }
  [[nodiscard]] const Wide& place() const { return place_; }
  [[nodiscard]] Wide own(const Wide& p) const { return to_own_ * (p - place_); }
  [[nodiscard]] Wide world(const Wide& p) const { return place_ + to_world_ * p; }
  [[nodiscard]] Wide world_direction(const Wide& d) const { return to_world_ * d; }

  /// The part's function at a world point as a distance [m]: its value over the length of its gradient in the world.
  /// Near a point without normal (a quadric cone's apex) the distance to the nearest such cone is no more than that.
  [[nodiscard]] long double distance(int part, const Wide& p_world) const {
    const Wide p = own(p_world);
    const Wide g = world_gradient(gradient(part, p));
    const long double f = value(part, p), steep = glm::length(g);
    if (f == 0) return 0;
    const long double curved = shape_.kind == HR_SHAPE_QUADRIC ? curvature() : 0;
    // The distance x at which steep x + curved x^2 = |f|, at least.
    const long double root = std::sqrt(steep * steep + 4 * curved * std::abs(f));
    return 2 * std::abs(f) / (steep + root);
  }

  /// Unit normal in the world, to the front.
  [[nodiscard]] Wide normal(int part, const Wide& p_world) const {
    return glm::normalize(world_gradient(gradient(part, own(p_world))));
  }

  /// How far a point of the part's surface lies inside of what bounds it; negative outside [m, nearly].
  [[nodiscard]] long double margin(int part, const Wide& p_world) const {
    const Wide p = own(p_world);
    const long double distance = std::hypot(p.x, p.y), unit = scale();
    if (shape_.kind == HR_SHAPE_DISK) return (shape_.form.x - distance) * unit;
    if (shape_.kind == HR_SHAPE_CONE) {
      if (part == HR_PART_SIDE) return (shape_.form.z - std::abs(p.z)) * unit;
      return (radius_at(part == HR_PART_UPPER_CAP ? shape_.form.z : -shape_.form.z) - distance) * unit;
    }
    if ((shape_.flags & HR_SHAPE_CLIP_SPHERE) != 0) return (shape_.clip.w - glm::length(p)) * unit;
    if ((shape_.flags & HR_SHAPE_CLIP_BOX) == 0) return reach();
    const Wide room = wide(shape_.clip) - glm::abs(p);
    return std::min({room.x, room.y, room.z}) * unit;
  }

  /// All hits along o + t d for any t, in no order; those up to `slack` metres outside of their rim among them.
  [[nodiscard]] std::vector<SurfaceHit> hits(const Wide& o_world, const Wide& d_world, long double slack) const {
    std::vector<SurfaceHit> all;
    const Wide o = own(o_world), d = to_own_ * d_world;
    const auto add = [&](long double t, int part, long double depth) {
      if (!std::isfinite(t)) return;
      const Wide p = o_world + d_world * t;
      const long double m = std::min(margin(part, p), depth);
      if (m < -slack) return;
      all.push_back({t, std::abs(glm::dot(normal(part, p), glm::normalize(d_world))), m, part});
    };
    const auto add_plane = [&](long double z, int part) {
      if (d.z != 0) add((z - o.z) / d.z, part, reach());
    };
    if (shape_.kind == HR_SHAPE_DISK) {
      add_plane(0, HR_PART_SIDE);
      return all;
    }
    if (shape_.kind == HR_SHAPE_CONE && (shape_.flags & HR_SHAPE_CAPPED) != 0) {
      add_plane(-shape_.form.z, HR_PART_LOWER_CAP);
      add_plane(shape_.form.z, HR_PART_UPPER_CAP);
    }
    // The side's or quadric's polynomial about the ray's point nearest to the shape.
    const long double start = -glm::dot(o, d) / glm::dot(d, d);
    const Wide m = o + d * start;
    const auto [a, b, c] = polynomial(m, d);
    const long double disc = b * b - a * c;
    const long double size = glm::length(d) * (glm::length(m) + reach());
    if (std::abs(a) * size < 1e-16L * std::abs(b) * glm::length(d)) {
      if (b != 0) add(start - c / (2 * b), HR_PART_SIDE, reach());
      return all;
    }
    // Where it nearly touches: the depth of the chord's middle, or how far from it the ray passes.
    const Wide middle = o_world + d_world * (start - b / a);
    const long double depth = distance(HR_PART_SIDE, middle) * (disc < 0 ? -1 : 1);
    const long double root = std::sqrt(std::max(disc, 0.0L));
    const long double q = -(b + (b < 0 ? -root : root));
    add(start + q / a, HR_PART_SIDE, depth);
    add(start + (q != 0 ? c / q : q / a), HR_PART_SIDE, depth);
    return all;
  }

 private:
  // Metres a unit of the shape's frame, at least.
  [[nodiscard]] long double scale() const {
    return std::min({glm::length(to_world_[0]), glm::length(to_world_[1]), glm::length(to_world_[2])});
  }
  [[nodiscard]] long double radius_at(long double z) const {
    return static_cast<long double>(shape_.form.x) + static_cast<long double>(shape_.form.y) * z;
  }
  [[nodiscard]] Wide world_gradient(const Wide& g) const { return rows_ * g; }
  [[nodiscard]] WideMatrix matrix() const {
    const shared::float4 &k = shape_.form, &m = shape_.mixed;
    return {Wide(k.x, m.x, m.z), Wide(m.x, k.y, m.y), Wide(m.z, m.y, k.z)};
  }
  [[nodiscard]] long double curvature() const {
    const WideMatrix a = rows_ * matrix() * to_own_;
    return glm::length(a[0]) + glm::length(a[1]) + glm::length(a[2]);
  }
  [[nodiscard]] long double value(int part, const Wide& p) const {
    if (shape_.kind == HR_SHAPE_DISK) return p.z;
    if (part != HR_PART_SIDE) return part == HR_PART_UPPER_CAP ? p.z - shape_.form.z : -p.z - shape_.form.z;
    if (shape_.kind == HR_SHAPE_CONE) return std::hypot(p.x, p.y) - radius_at(p.z);
    return glm::dot(p, matrix() * p) + 2 * glm::dot(wide(shape_.linear), p) + shape_.form.w;
  }
  [[nodiscard]] Wide gradient(int part, const Wide& p) const {
    if (shape_.kind == HR_SHAPE_DISK) return {0, 0, 1};
    if (part != HR_PART_SIDE) return {0, 0, part == HR_PART_UPPER_CAP ? 1 : -1};
    if (shape_.kind == HR_SHAPE_CONE) {
      const long double distance = std::hypot(p.x, p.y);
      return distance > 0 ? Wide(p.x / distance, p.y / distance, -shape_.form.y) : Wide(0, 0, 1);
    }
    return 2.0L * (matrix() * p + wide(shape_.linear));
  }
  // a, b, c of a t^2 + 2 b t + c along m + t d.
  [[nodiscard]] std::array<long double, 3> polynomial(const Wide& m, const Wide& d) const {
    if (shape_.kind == HR_SHAPE_CONE) {
      const long double r = radius_at(m.z), k = shape_.form.y * d.z;
      return {d.x * d.x + d.y * d.y - k * k, m.x * d.x + m.y * d.y - r * k, m.x * m.x + m.y * m.y - r * r};
    }
    return {glm::dot(d, matrix() * d), glm::dot(d, matrix() * m + wide(shape_.linear)), value(HR_PART_SIDE, m)};
  }

  shared::Shape shape_;
  WideMatrix rows_;  // columns are the rows of L: L^T
  WideMatrix to_own_, to_world_;
  Wide place_;
};

/// Float's errors on a shape of this reach, for a ray that hits at t: where its point lies [m].
inline long double shape_tolerance(const ShapeOracle& oracle, const Wide& d, long double t) {
  constexpr long double kOfReach = 4e-6L;  // a few dozen roundings in the shape's frame
  constexpr long double kOfWay = 1.2e-7L;  // two of t
  return kOfReach * oracle.reach() + kOfWay * std::abs(t) * glm::length(d);
}

struct ShapeVerdict {
  const char* objection = nullptr;  ///< null if the answer can be right
  bool sure = false;                ///< only one answer could have been right
};

/// Judges the answer for one ray and one shape in (t_min, infinity).
inline ShapeVerdict judge_shape(const ShapeOracle& oracle, const shared::QueryRay& ray,
                                const shared::QueryHit& answer) {
  const Wide o = wide(ray.origin), d = wide(ray.direction);
  const long double length = glm::length(d);
  const bool found = answer.primitive != HR_NO_PRIMITIVE;
  ShapeVerdict verdict;
  if (found) {
    const long double t = answer.t, tolerance = shape_tolerance(oracle, d, t);
    const Wide p = o + d * t;
    const int part = static_cast<int>(answer.u);
    if (oracle.distance(part, p) > tolerance) verdict.objection = "the hit is off the surface";
    if (oracle.margin(part, p) < -tolerance) verdict.objection = "the hit is beyond the rim";
    if (!(t > static_cast<long double>(ray.origin.w))) verdict.objection = "the hit is not beyond t_min";
  }
  long double nearest = std::numeric_limits<long double>::infinity();
  bool doubt = false;  // a hit that float may or may not see
  for (const SurfaceHit& hit : oracle.hits(o, d, 4 * shape_tolerance(oracle, d, 0))) {
    const long double tolerance = shape_tolerance(oracle, d, hit.t);
    const long double along = tolerance / std::max(hit.cosine, 1e-9L) / length;  // of t
    const bool certain = hit.margin > 4 * tolerance && hit.cosine > 1e-3L;
    if (hit.t < ray.origin.w - along) continue;
    if (!certain || hit.t <= ray.origin.w + along) {
      doubt = true;
      continue;
    }
    nearest = std::min(nearest, hit.t + along);
  }
  if (!found && std::isfinite(nearest)) verdict.objection = "a hit is missed";
  if (found && answer.t > nearest) verdict.objection = "the hit is not the nearest";
  verdict.sure = !doubt;
  return verdict;
}

}  // namespace hemiray::test

// An oracle of rays against disks, cones, cylinders and quadrics, in long double and by other formulas than the
// kernels': from the numbers as stored on the device. It knows how sure it is.
//
// The bound. A hit is right if it lies within shape_tolerance() of the surface and of what bounds that, and a miss if
// the ray passes a rim or a silhouette no farther inside than four times that. The oracle's own error is far less: long
// double rounds by 2^-64 of the reach, and where a ray just touches, by the root of a few of these: 2^-30, a thousandth
// of the bound.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "host/base/vec.hpp"
#include "shared/bvh_types.h"
#include "shared/scene_types.h"

namespace hemiray::stability {

using Wide = glm::vec<3, long double>;
using WideMatrix = glm::mat<3, 3, long double>;

inline Wide wide(const shared::float4& v) { return {v.x, v.y, v.z}; }

/// The size of an ulp of t, or of the origin's coordinates in lengths of the direction, whichever is larger.
double ulp_along(const shared::QueryRay& ray, double t);

/// One place where the ray meets the shape's surface.
struct SurfaceHit {
  long double t = 0;
  long double cosine = 0;  ///< between ray and normal, without sign
  /// How far inside of its rim or clip, and how deep the ray goes below a curved surface, or into a cone [m].
  long double margin = 0;
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
  [[nodiscard]] long double distance(int part, const Wide& p_world) const;

  /// Unit normal in the world, to the front.
  [[nodiscard]] Wide normal(int part, const Wide& p_world) const;

  /// How far a point of the part's surface lies inside of what bounds it; negative outside [m, nearly].
  [[nodiscard]] long double margin(int part, const Wide& p_world) const;

  /// All hits along o + t d for any t, in no order; those up to `slack` metres outside of their rim among them.
  [[nodiscard]] std::vector<SurfaceHit> hits(const Wide& o_world, const Wide& d_world, long double slack) const;

 private:
  // Margins of a cone's hits, its caps among them, end at how deep it goes in. Depth is concave along the ray, so
  // nowhere more than twice that in the middle of the way. Drops what is on caps that it has not.
  void cut_short(const Wide& o_world, const Wide& d_world, std::vector<SurfaceHit>* hits) const;
  // Metres a unit of the shape's frame, at least.
  [[nodiscard]] long double scale() const {
    return std::min({glm::length(to_world_[0]), glm::length(to_world_[1]), glm::length(to_world_[2])});
  }
  [[nodiscard]] long double radius_at(long double z) const {
    return static_cast<long double>(shape_.form.x) + static_cast<long double>(shape_.form.y) * z;
  }
  [[nodiscard]] Wide world_gradient(const Wide& g) const { return rows_ * g; }
  [[nodiscard]] WideMatrix matrix() const;
  [[nodiscard]] long double curvature() const;
  [[nodiscard]] long double value(int part, const Wide& p) const;
  [[nodiscard]] Wide gradient(int part, const Wide& p) const;
  // a, b, c of a t^2 + 2 b t + c along m + t d.
  [[nodiscard]] std::array<long double, 3> polynomial(const Wide& m, const Wide& d) const;

  shared::Shape shape_;
  WideMatrix rows_;  // columns are the rows of L: L^T
  WideMatrix to_own_, to_world_;
  Wide place_;
};

/// What single precision may make of a point of a shape, for a ray that hits at t [m].
long double shape_tolerance(const ShapeOracle& shape, const Wide& d, long double t);

/// What is wrong with an answer. The first three are about what is named, the others about what is not.
enum class ShapeFault { none, off_surface, beyond_rim, before_start, missed, not_nearest };

struct ShapeVerdict {
  ShapeFault fault = ShapeFault::none;
  bool sure = false;   ///< only one answer could have been right
  bool exact = false;  ///< the exact ray meets the same, or nothing either
  double t = 0.0;      ///< of the exact ray; only if it meets the same
};

/// Judges the answer for one ray in (t_min, infinity). Primitives from `first` on are these shapes.
ShapeVerdict judge_shapes(std::span<const ShapeOracle> shapes, std::uint32_t first, const shared::QueryRay& ray,
                          const shared::QueryHit& answer);

}  // namespace hemiray::stability

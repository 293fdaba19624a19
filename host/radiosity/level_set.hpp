// A quadric or an implicit surface, f = 0 within a clip, as something that is cut into triangles.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "host/base/vec.hpp"
#include "shared/scene_types.h"

namespace hemiray {

/// Of an edge, the arrow of an arc of 106 degrees: what leaves its chord farther is not smooth there.
inline constexpr double kMostArrow = 0.25;

/// In the shape's own frame; the tapes of implicit surfaces must outlive it.
class LevelSet {
 public:
  struct Value {
    double f = 0.0;
    DVec3 gradient{0.0};
  };
  using Triangle = std::array<DVec3, 3>;

  /// `tapes` are those of the whole scene.
  LevelSet(const shared::Shape& shape, std::span<const shared::uint4> tapes);

  [[nodiscard]] Value at(const DVec3& p) const;
  /// Half of the longest side of the box that is searched.
  [[nodiscard]] double size() const;
  /// The point of the surface near the middle of two of its points; on the clip where both are. Nothing where there is
  /// none within reach, as beside a point without normal.
  [[nodiscard]] std::optional<DVec3> halfway(const DVec3& a, const DVec3& b) const;
  /// The surface by marching through the tetrahedra of a grid, corners on the surface, fronts where f is positive. The
  /// grid is made finer until triangles and normals agree on all but 1 % of it, or to 48 cells; what is thinner than a
  /// cell may be missed.
  [[nodiscard]] std::vector<Triangle> triangles() const;

 private:
  struct Plane {  // or a ball; negative within
    double value;
    DVec3 gradient;
  };
  void find_box(const shared::Shape& shape);
  [[nodiscard]] int degree() const;
  [[nodiscard]] Plane ball_at(const DVec3& p) const;
  [[nodiscard]] std::optional<DVec3> onto(const DVec3& from, bool to_ball, int fixed_axis, double reach) const;
  [[nodiscard]] std::vector<Triangle> march(int cells) const;
  void add_within_ball(const Triangle& triangle, std::vector<Triangle>& triangles) const;
  [[nodiscard]] double share_of_sharp(const std::vector<Triangle>& triangles) const;

  std::span<const shared::uint4> tape_;  // of an implicit surface, else empty
  DMat3 a_{0.0};                         // of a quadric
  DVec3 b_{0.0};
  double c_ = 0.0;
  DVec3 middle_{0.0}, lo_{0.0}, hi_{0.0};  // of the clip; of the box that is searched
  double ball_ = 0.0;                      // radius of a clip that is one, else 0
};

}  // namespace hemiray

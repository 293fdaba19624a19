// Round surfaces that are cut into triangles: where new vertices go, and what is cut to begin with.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "host/base/vec.hpp"
#include "host/radiosity/level_set.hpp"
#include "shared/scene_types.h"

namespace hemiray {

/// A sphere, or the rim and the side of a disk, cylinder or cone, or a level set, in its own frame: p_own = to_own (p -
/// place).
struct RoundSurface {
  enum class Kind { sphere, cone, level };  ///< a disk is a cone of height 0, of which only the lower cap is there
  Kind kind = Kind::sphere;
  DMat3 to_own{1.0}, to_world{1.0};
  DVec3 place{0.0};                                     ///< [m]
  std::shared_ptr<const LevelSet> level;                ///< then radius is its size
  double radius = 1.0, slope = 0.0, half_height = 0.0;  ///< of a cone: radius + slope z, |z| <= half_height

  /// The point halfway between two of the surface's (or of its caps'): on the surface if both are on its round part.
  [[nodiscard]] DVec3 halfway(const DVec3& a, const DVec3& b) const;
  /// How far that point is from the middle of the chord [m]. Where a level set has none, as much as could be: such
  /// edges are cut until they are short, as all around them are.
  [[nodiscard]] double arrow(const DVec3& a, const DVec3& b) const;
  /// Distance of a point from the round part [m], approximately: along its normal in the own frame.
  [[nodiscard]] double distance(const DVec3& p) const;
  /// Unit normal outwards at a point of the round part, in the world.
  [[nodiscard]] DVec3 normal(const DVec3& p) const;
};

/// What a round surface is cut from: corners in the world and what they are on.
struct RoundFace {
  std::array<DVec3, 3> corners;
  bool flat;  ///< of a cap: its rim is round, it is not
};

RoundSurface round_sphere(const shared::Sphere& sphere);
/// A shape of the scene; `tapes` are those of all implicit surfaces and must outlive what is returned.
RoundSurface round_shape(const shared::Shape& shape, std::span<const shared::uint4> tapes);
/// An icosahedron; what a level set finds; or triangles of the side and around the caps' middles, fronts outwards.
std::vector<RoundFace> round_faces(const RoundSurface& surface, const shared::Shape* shape);

}  // namespace hemiray

// Where the scene's finite things lie in the world.
#pragma once

#include <limits>

#include "host/scene/scene.hpp"

namespace hemiray {

/// An axis-aligned box in world space [m]; empty until something is added.
struct WorldBounds {
  DVec3 min{std::numeric_limits<double>::infinity()};
  DVec3 max{-std::numeric_limits<double>::infinity()};

  [[nodiscard]] bool empty() const { return !(min.x <= max.x); }
  [[nodiscard]] DVec3 center() const { return 0.5 * (min + max); }
  void add(const DVec3& point) {
    min = glm::min(min, point);
    max = glm::max(max, point);
  }
};

/// Bounds of all objects' triangles, spheres, shapes and visible area lights. Planes are unbounded and do not count.
/// Indices must be in range.
WorldBounds world_bounds(const Scene& scene);

/// The smallest radius [m] of a sphere around `center` that holds everything world_bounds() counts; 0 for nothing.
double bounding_radius(const Scene& scene, const DVec3& center);

}  // namespace hemiray

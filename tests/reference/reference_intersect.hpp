// Ray queries of the reference tracer: brute force over all primitives, or a median-split box tree over the triangles.
#pragma once

#include <optional>
#include <vector>

#include "tests/reference/reference_world.hpp"

namespace hemiray::reference {

/// A half line. `origin_error_m` > 0 says that the origin lies on a surface, within that distance: surfaces that pass
/// through the origin are then not hit there (0 for camera rays).
struct Ray {
  DVec3 origin{0.0};
  DVec3 direction{0.0, 0.0, -1.0};  ///< unit length
  double origin_error_m = 0.0;
};

struct Hit {
  double t_m = 0.0;  ///< distance along the ray
  PrimitiveId primitive;
  DVec3 barycentrics{0.0};  ///< weights of a triangle's corners; sum 1
};

/// The error of a point computed at distance `t_m` along a ray, with a wide margin for double precision.
double point_error(const DVec3& point, double t_m);

/// The intersection of one ray with one primitive at t > 0, if any.
std::optional<Hit> intersect(const World& world, const PrimitiveId& primitive, const Ray& ray);

/// Answers queries against a World, which must outlive it.
class Intersector {
 public:
  enum class Method { automatic, brute_force, tree };

  /// `automatic` builds the tree above 2000 triangles.
  explicit Intersector(const World& world, Method method = Method::automatic);

  /// The nearest hit; among equally near ones the first in the order of Kind, then index.
  [[nodiscard]] std::optional<Hit> nearest(const Ray& ray) const;

  /// Whether anything but the primitives `ignored` blocks the ray before `distance_m` (infinity allowed).
  [[nodiscard]] bool occluded(const Ray& ray, double distance_m, const std::vector<PrimitiveId>& ignored) const;

 private:
  struct Node {
    DVec3 low, high;
    std::size_t begin = 0, end = 0;   ///< range of order_
    std::size_t left = 0, right = 0;  ///< 0: a leaf
  };
  std::size_t build(std::size_t begin, std::size_t end);
  template <class Visit>
  void for_each_triangle(const Ray& ray, double& t_max, const Visit& visit) const;

  const World& world_;
  std::vector<std::size_t> order_;
  std::vector<Node> nodes_;  ///< empty: brute force
};

}  // namespace hemiray::reference

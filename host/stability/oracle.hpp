// The judge of hits: what the exact ray through the floats given meets, and whether an answer is right, within the
// bound that is published for it, or wrong.
//
// The bound. The watertight test finds the hits of triangles whose vertices, seen from the ray's origin, are rounded
// (kernels/lib/intersect.h): each lies within kBoundUlps ulps of its distance from the origin from where it should, in
// each coordinate of the plane across the ray. So a hit is right if the ray passes the triangle no farther off than
// that, and a miss if it passes an outline no farther off. Spheres are those of a radius wrong by as many ulps of
// |centre - origin| + radius. From this follows how far t may be off: by the bound times the slope of the surface along
// the ray, and by what the rounded products of the edge functions, which weigh the vertices' distances, make of a thin
// triangle; but never out of the range of the vertices' distances.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "host/scene/flat_scene.hpp"
#include "host/stability/rates.hpp"
#include "shared/bvh_types.h"

namespace hemiray::stability {

/// One rounding each of a difference, a product and a sum, and of the shear, a reciprocal of 2.5 ulps times a
/// component: at most 5 ulps along an axis; all three axes together make it less than 8.
inline constexpr double kBoundUlps = 8.0;

struct Met {
  std::uint32_t primitive = HR_NO_PRIMITIVE;
  double t = 0.0;        ///< [in lengths of the direction], correctly rounded but for 2^-40 of it
  double nearest = 0.0;  ///< the published bound: what may be told for t
  double farthest = 0.0;
};

/// What one ray meets, the nearest first; of primitives that are the same the first one.
using Truth = std::vector<Met>;

/// One scene of triangles and spheres (no planes, no instances), which must outlive it.
class Oracle {
 public:
  explicit Oracle(const FlatScene& flat);

  /// Triangles by their places: equal ones are one, and what is not finite or has no area is none.
  [[nodiscard]] std::size_t distinct_triangles() const { return triangles_.size(); }

  /// Asks about one ray after the other; rays of one origin in a row are answered faster. One for each thread.
  class Session {
   public:
    explicit Session(const Oracle& oracle) : oracle_(&oracle) {}
    /// What the exact ray meets in (t_min, t_max).
    Truth meet(const shared::QueryRay& ray);
    /// Adds an answer to the counts. `inside`: the ray starts inside a closed mesh, so that no miss is borderline.
    void judge(const shared::QueryRay& ray, const Truth& truth, const shared::QueryHit& answer, bool inside,
               Tally& tally);

   private:
    void move_to(const shared::QueryRay& ray);
    std::optional<Met> meet_triangle(std::uint32_t index, const shared::QueryRay& ray) const;

    const Oracle* oracle_;
    Vec3 origin_{0.0F};
    bool at_origin_ = false;
    std::array<std::vector<double>, 9> normals_;  // of the planes through the origin and an edge, by coordinate
    std::vector<double> reach_;                   // bound of the products in these
    std::vector<unsigned char> near_;
  };

 private:
  struct Triangle {
    std::array<Vec3, 3> corner;
    std::array<std::uint32_t, 3> place;  // numbers of corners: equal ones lie in one place
    std::uint32_t primitive;             // the first of those that are the same
  };
  struct Side {
    std::array<std::uint32_t, 2> ends;  // places, the smaller first
    std::uint32_t triangle;
  };

  [[nodiscard]] bool is_sure(std::uint32_t triangle, const shared::QueryRay& ray) const;
  [[nodiscard]] std::span<const Side> sides_at(const std::array<std::uint32_t, 2>& ends) const;
  std::optional<Met> meet_sphere(std::uint32_t index, const shared::QueryRay& ray, bool& sure) const;

  const FlatScene* flat_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> triangle_of_;  // by primitive; kNoTriangle
  std::vector<Side> sides_;                 // sorted by ends
};

}  // namespace hemiray::stability

// Nearest-neighbour searches, for arrays of points: the closest point of a scene, and the k nearest of given points.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host/base/vec.hpp"
#include "host/bvh/accel.hpp"

namespace hemiray {

/// Where to search from: xyz [m], and in w how far [m], >= 0, infinite for everywhere. Lengths that matter must lie in
/// [1e-15, 1e18] m, since their squares are compared as floats.
using QueryPoint = shared::float4;

/// The closest points to some queries, in their order.
struct ClosestPoints {
  std::vector<shared::float4> points;     ///< xyz [m], w = distance [m]; the query itself and infinity if none
  std::vector<std::uint32_t> primitives;  ///< triangles, then spheres; HR_NO_PRIMITIVE if none
};

/// Closest points on a scene's triangles and spheres (their surfaces; shapes and planes are left out). Boxes of the
/// tree are discarded by their distance. The scene and its tree must outlive it.
class NearestQueries {
 public:
  /// Throws InputError if the tree is not a BVH, or the scene has instances.
  NearestQueries(Context& context, const DeviceScene& scene, const Accel& accel);

  /// The closest point to each query that is not farther than its w. Of equal distances the smaller primitive.
  [[nodiscard]] ClosestPoints closest(std::span<const QueryPoint> queries);

  /// The same for what is on the device; queues the kernel and does not wait.
  void closest(const Buffer<QueryPoint>& queries, const Buffer<shared::float4>& nearest,
               const Buffer<std::uint32_t>& primitives, std::uint32_t count);

 private:
  Context* context_;
  const DeviceScene* scene_;
  const Accel* accel_;
  Program program_;
};

/// The k nearest points to some queries: k entries a query, nearest first.
struct Neighbours {
  std::vector<float> distances;        ///< [m]; infinity where there are fewer than k
  std::vector<std::uint32_t> indices;  ///< of the points; HR_NO_PRIMITIVE where there are fewer than k
};

/// A tree of points, such as a scene's vertices or photons, asked for the nearest ones. It is a BVH like any other,
/// over spheres of the smallest radius there is, whose centres are the points.
class PointTree {
 public:
  static constexpr unsigned kMaxNeighbours = 16;

  /// `points`: xyz [m]; those that are not finite are left out. The builder must outlive it. Throws DeviceError.
  PointTree(Context& context, AccelBuilder& builder, std::span<const Vec3> points, const AccelOptions& options = {});

  /// The k points, 1 to 16, nearest to each query and not farther than its w. Of equal distances the smaller index
  /// comes first, equal points included. Distances are as single precision computes them, so is their order. Throws
  /// InputError for another k.
  [[nodiscard]] Neighbours nearest(std::span<const QueryPoint> queries, unsigned k);

  [[nodiscard]] const AccelStatistics& statistics() const { return accel_->statistics(); }

 private:
  Context* context_;
  DeviceScene scene_;
  std::optional<Accel> accel_;
  std::optional<Program> program_;
};

}  // namespace hemiray

// The acceleration structure: built wholly by kernels on the device, asked by arrays of rays or by other effects'
// kernels.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/gpu/buffer.hpp"
#include "host/gpu/parallel.hpp"
#include "host/gpu/program.hpp"
#include "host/scene/device_scene.hpp"
#include "shared/bvh_types.h"
#include "shared/params.h"

namespace hemiray {

struct AccelOptions {
  /// Bits of the Morton codes: 30 or 63; 0 chooses by the number of primitives.
  unsigned morton_bits = 0;
};

/// What the build found and made.
struct AccelStatistics {
  std::uint32_t primitives = 0;  ///< in the tree
  std::uint32_t non_finite = 0;  ///< dropped: NaN or infinite
  std::uint32_t degenerate = 0;  ///< dropped: no area or radius
  unsigned morton_bits = 0;
  shared::float4 lo{}, hi{};  ///< bounds [m]; lo > hi if there is no primitive
  double build_ms = 0.0;      ///< wall time without compilation
};

/// The program that builds trees, compiled once a context and shared by all of them.
class AccelBuilder {
 public:
  AccelBuilder(Context& context, Parallel& parallel);

 private:
  friend class Accel;
  Context* context_;
  Parallel* parallel_;

 public:
  Program program;  ///< "bvh": exposed for its statistics and cache
};

/// A binary BVH (Karras 2012) over a scene's triangles and spheres. The DeviceScene must outlive it.
class Accel {
 public:
  /// Bounds, Morton codes, radix sort, emission, refit: 5 + 3 per 8 bits launches. Throws DeviceError.
  Accel(AccelBuilder& builder, const DeviceScene& scene, const AccelOptions& options = {});

  [[nodiscard]] const AccelStatistics& statistics() const { return statistics_; }
  /// bvh_nodes and bvh_leaves, for kernels that trace.
  [[nodiscard]] Arguments tree_arguments() const;
  [[nodiscard]] const Buffer<shared::BvhNode>& nodes() const { return nodes_; }
  [[nodiscard]] const Buffer<shared::BvhLeaf>& leaves() const { return leaves_; }

 private:
  void bound_primitives(AccelBuilder& builder, const DeviceScene& scene);
  Buffer<std::uint32_t> sort_primitives(AccelBuilder& builder, const DeviceScene& scene, Buffer<std::uint64_t>& keys);
  void emit_tree(AccelBuilder& builder, const DeviceScene& scene, const Buffer<std::uint64_t>& keys,
                 const Buffer<std::uint32_t>& order);

  AccelStatistics statistics_;
  shared::float4 centroid_lo_{}, centroid_hi_{};
  Buffer<shared::BvhNode> nodes_;
  Buffer<shared::BvhLeaf> leaves_;
};

/// Answers ray queries for arrays of rays against one scene and its tree, which must outlive it.
class RayQueries {
 public:
  RayQueries(Context& context, const DeviceScene& scene, const Accel& accel, bool strict = false);

  /// Closest hit of each ray in its (t_min, t_max). Ties in t go to the smaller primitive index.
  [[nodiscard]] std::vector<shared::QueryHit> intersect(std::span<const shared::QueryRay> rays);
  /// 1 for each ray that meets anything, else 0.
  [[nodiscard]] std::vector<std::uint32_t> occluded(std::span<const shared::QueryRay> rays);

 private:
  template <typename Result>
  std::vector<Result> ask(const char* kernel, const char* result_name, std::span<const shared::QueryRay> rays);

  Context* context_;
  const DeviceScene* scene_;
  const Accel* accel_;
  Program program_;
};

}  // namespace hemiray

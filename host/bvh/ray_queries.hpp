// Questions to a built tree, for arrays of rays.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/bvh/accel.hpp"
#include "shared/params.h"

namespace hemiray {

/// How rays are traced. single: in the order given. packets: neighbours that share their origin (camera, point light,
/// hemicube) together; a packet whose rays do not is traced one by one, and so are all through trees that are not laid
/// out in vectors, or not bvhs, or asked in double precision. sorted: by origin and direction first, which pays for
/// many incoherent rays.
enum class RayGrouping { single, packets, sorted };

/// What kernels that answer single rays need to know of the scene.
shared::RenderParams query_params(const DeviceScene& scene);

/// Answers ray queries for arrays of rays against one scene and its tree, which must outlive it.
class RayQueries {
 public:
  RayQueries(Context& context, const DeviceScene& scene, const Accel& accel, bool strict = false,
             RayGrouping grouping = RayGrouping::single, bool double_precision = false);

  /// Closest hit of each ray in its (t_min, t_max). Ties in t go to the smaller primitive index.
  [[nodiscard]] std::vector<shared::QueryHit> intersect(std::span<const shared::QueryRay> rays);
  /// 1 for each ray that meets anything, else 0.
  [[nodiscard]] std::vector<std::uint32_t> occluded(std::span<const shared::QueryRay> rays);

  /// The same for what is on the device already; queues the kernel and does not wait.
  void intersect(const Buffer<shared::QueryRay>& rays, const Buffer<shared::QueryHit>& hits, std::uint32_t count);
  void occluded(const Buffer<shared::QueryRay>& rays, const Buffer<std::uint32_t>& occluded, std::uint32_t count);

 private:
  template <typename Result>
  void ask(const std::string& kernel, const char* result_name, const Buffer<shared::QueryRay>& rays,
           const Buffer<Result>& results, std::uint32_t count);

  Context* context_;
  const DeviceScene* scene_;
  const Accel* accel_;
  /// Keys of sorted rays, in the order to trace them.
  void sort_rays(const Buffer<shared::QueryRay>& rays, std::uint32_t count, std::uint32_t index_bits);

  RayGrouping grouping_;
  Program program_;
  std::unique_ptr<Parallel> parallel_;  ///< of sorted rays
  Buffer<std::uint64_t> keys_, keys_other_;
};

}  // namespace hemiray

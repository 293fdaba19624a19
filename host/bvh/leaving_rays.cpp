#include "host/bvh/leaving_rays.hpp"

#include <stdexcept>

#include "host/bvh/ray_queries.hpp"
#include "host/gpu/program.hpp"

namespace hemiray {

LeavingRays leave_surfaces(Context& context, const DeviceScene& scene, const Accel& accel,
                           std::span<const shared::QueryRay> rays, std::span<const shared::float4> wanted,
                           bool strict) {
  if (rays.size() != wanted.size()) throw std::logic_error("a direction for each ray");
  if (rays.empty()) return {};
  Program program(context, "leave", {"bvh/leave.cl"}, accel.program_options(scene.features(), strict));
  const auto count = static_cast<std::uint32_t>(rays.size());
  const Buffer<shared::QueryRay> given(context, "rays", rays), leaving(context, "leaving", rays.size());
  const Buffer<shared::float4> directions(context, "wanted", wanted);
  const Buffer<shared::QueryHit> hits(context, "hits", rays.size()), next(context, "next", rays.size());
  launch(context, program.kernel("query_leave_surface"), count,
         arguments(scene.shading_arguments(), accel.tree_arguments(), arg("rays", given), arg("wanted", directions),
                   arg("hits", hits), arg("leaving", leaving), arg("next", next), arg("count", count),
                   arg("params", query_params(scene))));
  return {hits.read(), leaving.read(), next.read()};
}

}  // namespace hemiray

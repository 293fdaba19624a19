#include "host/bvh/visit_counts.hpp"

#include <stdexcept>

#include "host/bvh/ray_queries.hpp"
#include "host/gpu/program.hpp"

namespace hemiray {

VisitCounts count_visits(Context& context, const DeviceScene& scene, const Accel& accel,
                         const Buffer<shared::QueryRay>& rays, std::uint32_t count, bool any_hit) {
  if (accel.config().kind != AccelKind::bvh) throw std::logic_error("visits are counted in a BVH");
  Program program(context, "count_visits", {"bvh/count_visits.cl"}, accel.program_options(scene.features(), false));
  const std::uint32_t chunks = context.profile().chunks;
  const Buffer<shared::uint2> visits(context, "visits", chunks);
  launch(context, program.kernel("query_count_visits"), chunks,
         arguments(scene.shading_arguments(), accel.tree_arguments(), arg("rays", rays), arg("visits", visits),
                   arg("count", count), arg("any_hit", std::uint32_t{any_hit}), arg("params", query_params(scene))));
  VisitCounts sum;
  for (const shared::uint2& part : visits.read()) {
    sum.nodes += part.x;
    sum.blocks += part.y;
  }
  return {sum.nodes / count, sum.blocks / count};
}

}  // namespace hemiray

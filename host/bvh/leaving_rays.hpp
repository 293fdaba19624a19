// Rays sent on from the hits of others, as the renderer sends reflected and refracted ones.
#pragma once

#include <span>
#include <vector>

#include "host/bvh/accel.hpp"
#include "host/gpu/context.hpp"
#include "host/scene/device_scene.hpp"

namespace hemiray {

/// Of each ray; where it hits nothing, `leaving` is the ray itself and `next` a miss.
struct LeavingRays {
  std::vector<shared::QueryHit> hits;     ///< of the rays given
  std::vector<shared::QueryRay> leaving;  ///< those that go on
  std::vector<shared::QueryHit> next;     ///< what they hit
};

/// kernels/bvh/leave.cl: `wanted` says which way to go on, w >= 0 on the side that the ray came from, w < 0 beyond the
/// surface. Compiles a program. Throws DeviceError; std::logic_error if there are not as many as rays.
LeavingRays leave_surfaces(Context& context, const DeviceScene& scene, const Accel& accel,
                           std::span<const shared::QueryRay> rays, std::span<const shared::float4> wanted,
                           bool strict = false);

}  // namespace hemiray

// What a tree is worth to rays, free of the noise of times.
#pragma once

#include <cstdint>

#include "host/bvh/accel.hpp"
#include "host/gpu/buffer.hpp"
#include "host/gpu/context.hpp"
#include "host/scene/device_scene.hpp"

namespace hemiray {

/// Per ray, on average.
struct VisitCounts {
  double nodes = 0.0, blocks = 0.0;
};

/// How many nodes and leaf blocks of a BVH the first `count` > 0 rays come to one by one, asking for the closest hit or
/// for any. Compiles a program. Throws DeviceError; std::logic_error for a tree of cells.
VisitCounts count_visits(Context& context, const DeviceScene& scene, const Accel& accel,
                         const Buffer<shared::QueryRay>& rays, std::uint32_t count, bool any_hit);

}  // namespace hemiray

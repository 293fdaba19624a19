// How much device memory a scene will need.
#pragma once

#include <cstdint>

#include "host/scene/scene.hpp"

namespace hemiray {

/// Estimated bytes of the scene's buffers and its acceleration structure on the device, build scratch included; image
/// and queues come on top. Indices must be in range.
std::uint64_t predict_device_bytes(const Scene& scene);

}  // namespace hemiray

// How much device memory a render takes, known before any is taken.
#pragma once

#include <cstdint>

#include "host/bvh/accel_config.hpp"
#include "host/gpu/device_profile.hpp"
#include "host/path/engine.hpp"
#include "host/scene/flat_scene.hpp"

namespace hemiray {

/// Peak bytes of a render of width x height pixels with that many bounces: the scene, then the larger of building the
/// tree and tracing. `features` as features_of() gives. Compared with the measured peak in tests/path.
std::uint64_t predict_render_bytes(const FlatScene& flat, std::uint32_t features, EngineKind engine, int width,
                                   int height, int depth, const AccelOptions& tree, const DeviceProfile& profile,
                                   bool double_precision = false);

}  // namespace hemiray

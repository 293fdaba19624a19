#include "host/path/memory_prediction.hpp"

#include <algorithm>

#include "host/bvh/accel_memory.hpp"
#include "host/scene/device_scene.hpp"
#include "host/scene/features.hpp"
#include "shared/path_state.def"

namespace hemiray {
namespace {

// One path: its sums, and in the wavefront engine the whole state, two queues and the next stage.
std::uint64_t slot_bytes(std::uint32_t features, EngineKind engine, int depth) {
  using shared::real4;
  using shared::uint;
  using shared::uint4;
  std::uint64_t bytes = engine == EngineKind::wavefront ? 3 * sizeof(std::uint32_t) : sizeof(shared::uint2);
#define HR_COUNT_FIELD(group, feature, type, name)                              \
  if (has_feature(features, HR_FEATURE_##feature) &&                            \
      (engine == EngineKind::wavefront || HR_GROUP_##group == HR_GROUP_SUMS)) { \
    bytes += sizeof(type);                                                      \
  }
  HR_PATH_STATE(HR_COUNT_FIELD)
#undef HR_COUNT_FIELD
  constexpr std::uint64_t kPendingBranch = 3 * sizeof(real4) + sizeof(uint4);
  if (has_feature(features, HR_FEATURE_BRANCHING)) {
    bytes += kPendingBranch * static_cast<std::uint64_t>(std::max(depth, 1));
  }
  return bytes;
}

std::uint64_t pixel_bytes(std::uint32_t features) {
  std::uint64_t bytes = sizeof(shared::real4) + 2 * sizeof(shared::float4);
  if (has_feature(features, HR_FEATURE_REFLECTION)) bytes += sizeof(shared::real4);
  if (has_feature(features, HR_FEATURE_REFRACTION)) bytes += sizeof(shared::real4);
  return bytes;
}

}  // namespace

std::uint64_t predict_render_bytes(const FlatScene& flat, std::uint32_t features, EngineKind engine, int width,
                                   int height, int depth, const AccelOptions& tree, const DeviceProfile& profile) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  const std::uint64_t slots = std::min<std::uint64_t>(pixels, profile.wave_slots);
  const AccelMemory accel = predict_accel_bytes(flat, tree, profile);
  const std::uint64_t tail = engine == EngineKind::wavefront ? std::min<std::uint64_t>(slots, profile.tail_paths) : 0;
  const std::uint64_t trace = accel.tree + pixels * pixel_bytes(features) +
                              slots * slot_bytes(features, engine, depth) + tail * sizeof(shared::uint2);
  return predict_scene_bytes(flat, features) + std::max(accel.peak, trace);
}

}  // namespace hemiray

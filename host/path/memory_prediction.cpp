#include "host/path/memory_prediction.hpp"

#include <algorithm>
#include <type_traits>

#include "host/bvh/accel_memory.hpp"
#include "host/scene/device_scene.hpp"
#include "host/scene/features.hpp"
#include "shared/path_state.def"
#include "shared/stages.def"

namespace hemiray {
namespace {

// One path: its sums, and in the wavefront engine the whole state, two queues and the next stage.
std::uint64_t slot_bytes(std::uint32_t features, EngineKind engine, int depth, bool double_precision) {
  using shared::float4;
  using shared::real4;
  using shared::uint;
  using shared::uint4;
  std::uint64_t bytes = engine == EngineKind::wavefront ? 3 * sizeof(std::uint32_t) : sizeof(shared::uint2);
#define HR_COUNT_FIELD(group, feature, type, name)                                         \
  if (has_feature(features, HR_FEATURE_##feature) &&                                       \
      (engine == EngineKind::wavefront || HR_GROUP_##group == HR_GROUP_SUMS)) {            \
    const bool is_real = HR_GROUP_##group != HR_GROUP_SUMS && std::is_same_v<type, real4>; \
    bytes += sizeof(type) * (is_real && double_precision ? 2 : 1);                         \
  }
  HR_PATH_STATE(HR_COUNT_FIELD)
#undef HR_COUNT_FIELD
  const std::uint64_t pending_branch = (3 * sizeof(real4) + sizeof(uint4)) * (double_precision ? 2 : 1);
  if (has_feature(features, HR_FEATURE_BRANCHING)) {
    bytes += pending_branch * static_cast<std::uint64_t>(std::max(depth, 1));
  }
  return bytes;
}

std::uint64_t pixel_bytes(std::uint32_t features) {
  std::uint64_t bytes = sizeof(shared::float4) + 2 * sizeof(shared::float4);
  if (has_feature(features, HR_FEATURE_REFLECTION)) bytes += sizeof(shared::float4);
  if (has_feature(features, HR_FEATURE_REFRACTION)) bytes += sizeof(shared::float4);
  return bytes;
}

}  // namespace

std::uint64_t predict_render_bytes(const FlatScene& flat, std::uint32_t features, EngineKind engine, int width,
                                   int height, int depth, const AccelOptions& tree, const DeviceProfile& profile,
                                   bool double_precision) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  const std::uint64_t slots = std::min<std::uint64_t>(pixels, profile.wave_slots);
  const AccelMemory accel = predict_accel_bytes(flat, tree, profile);
  const bool is_wavefront = engine == EngineKind::wavefront;
  const std::uint64_t tail = is_wavefront ? std::min<std::uint64_t>(slots, profile.tail_paths) : 0;
  const std::uint64_t counts = is_wavefront ? std::uint64_t{HR_STAGE_done} * profile.queue_chunks + 1 : 0;
  const std::uint64_t trace = accel.tree + pixels * pixel_bytes(features) +
                              slots * slot_bytes(features, engine, depth, double_precision) +
                              tail * sizeof(shared::uint2) + counts * sizeof(std::uint32_t);
  return predict_scene_bytes(flat, features) + std::max(accel.peak, trace);
}

}  // namespace hemiray

#include "host/path/memory_prediction.hpp"

#include <algorithm>

#include "host/bvh/accel_memory.hpp"
#include "host/scene/features.hpp"
#include "shared/path_state.def"

namespace hemiray {
namespace {

template <typename T>
std::uint64_t bytes_of(const std::vector<T>& data) {
  return std::max<std::uint64_t>(data.size(), 1) * sizeof(T);
}

std::uint64_t scene_bytes(const FlatScene& flat, std::uint32_t features) {
  const auto if_on = [features](std::uint32_t feature, std::uint64_t bytes) {
    return has_feature(features, feature) ? bytes : 0;
  };
  constexpr std::uint64_t kSrgbTable = 256 * sizeof(float);
  return bytes_of(flat.positions) + bytes_of(flat.triangles) + bytes_of(flat.spheres) + bytes_of(flat.materials) +
         if_on(HR_FEATURE_TRIANGLES, bytes_of(flat.triangle_objects)) +
         if_on(HR_FEATURE_SMOOTH_NORMALS, bytes_of(flat.normals)) +
         if_on(HR_FEATURE_VERTEX_COLORS, bytes_of(flat.colors)) + if_on(HR_FEATURE_PLANES, bytes_of(flat.planes)) +
         if_on(HR_FEATURE_INSTANCES, bytes_of(flat.instances)) + if_on(HR_FEATURE_LIGHTS, bytes_of(flat.lights)) +
         if_on(HR_FEATURE_EMITTERS, bytes_of(flat.emitters)) +
         if_on(HR_FEATURE_TEXTURES, bytes_of(flat.uvs) + bytes_of(flat.textures) + bytes_of(flat.texels) + kSrgbTable);
}

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
  return scene_bytes(flat, features) + std::max(accel.peak, trace);
}

}  // namespace hemiray

#include "host/path/render_setup.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "host/base/error.hpp"
#include "host/base/numbers.hpp"
#include "host/gpu/device_list.hpp"
#include "host/path/camera_params.hpp"
#include "host/path/memory_prediction.hpp"
#include "host/scene/features.hpp"

namespace hemiray {
namespace {

constexpr int kMaxSide = 65536;                             // [pixels]
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 30;  // slots and pixels are counted in 32 bits
constexpr int kMaxSamples = 1 << 20;
constexpr int kMaxDepth = 64;  // a pending branch a bounce and slot is kept
constexpr std::uint32_t kSeedFactor = 0x9E3779B9U;

void check_range(const char* option, int value, int least, int most) {
  if (value < least || value > most) {
    throw InputError(option, fmt::format("{} is out of range; it must be from {} to {}", value, least, most));
  }
}

}  // namespace

RenderSetup::RenderSetup(const Scene& scene_given, const RenderOptions& options_given)
    : scene(scene_given),
      options(options_given),
      width(options.width > 0 ? options.width : scene.camera.width),
      height(options.height > 0 ? options.height : scene.camera.height),
      depth(options.depth >= 0 ? options.depth : scene.depth) {
  check_range("--size", width, 1, kMaxSide);
  check_range("--size", height, 1, kMaxSide);
  if (std::int64_t{width} * height > kMaxPixels) {
    throw InputError("--size", fmt::format("{} x {} is more than 2^30 pixels", width, height));
  }
  check_range("--spp", options.spp, 1, kMaxSamples);
  check_range("--depth", depth, 0, kMaxDepth);
  pixels = static_cast<std::uint32_t>(width) * static_cast<std::uint32_t>(height);
  const double start = steady_ms();
  flat = options.patches != nullptr
             ? *options.patches
             : flatten_scene(scene, options.accel.kind == AccelKind::bvh ? options.instancing : Instancing::never);
  features = features_of(scene, flat, depth);
  // What the ambient light stands for is in the solution, which is physical.
  if (options.patches != nullptr) features &= ~(HR_FEATURE_AMBIENT | HR_FEATURE_PHONG_SHADING);
  flatten_ms = steady_ms() - start;
}

std::uint32_t RenderSetup::slots(const DeviceProfile& profile) const { return std::min(pixels, profile.wave_slots); }

std::uint64_t RenderSetup::predicted_bytes(const DeviceProfile& profile) const {
  return predict_render_bytes(flat, features, options.engine, width, height, depth, options.accel, profile,
                              options.double_precision);
}

void RenderSetup::check_memory(const DeviceInfo& device, std::uint64_t available) const {
  const std::uint64_t needed = predicted_bytes(profile_for(device));
  if (needed <= available) return;
  const std::string less = available < device.global_bytes ? " left beside the other devices" : "";
  throw DeviceError(
      fmt::format("device memory: the scene at {} x {} needs {}, {} has {}{}; take a smaller --size or "
                  "another device",
                  width, height, format_bytes(needed), device.name, format_bytes(available), less));
}

WaveFacts RenderSetup::wave_facts() const {
  return {scene.camera.kind == CameraKind::perspective, options.strict, options.double_precision,
          std::uint64_t{pixels} * static_cast<std::uint64_t>(options.spp)};
}

shared::RenderParams RenderSetup::params(const DeviceScene& device_scene) const {
  shared::RenderParams params{};
  set_camera(params, scene.camera, width, height);
  params.background = {scene.background.x, scene.background.y, scene.background.z, 0.0F};
  params.ambient = {scene.ambient.x, scene.ambient.y, scene.ambient.z, 0.0F};
  params.samples = static_cast<std::uint32_t>(options.spp);
  params.seed_key = options.seed * kSeedFactor;
  params.max_depth = static_cast<std::uint32_t>(depth);
  params.triangle_count = device_scene.triangle_count();
  params.sphere_count = device_scene.sphere_count();
  params.shape_count = device_scene.shape_count();
  params.plane_count = device_scene.plane_count();
  params.light_count = device_scene.light_count();
  params.emitter_count = device_scene.emitter_count();
  params.instance_count = device_scene.instance_count();
  params.gather_rays = flat.gather_rays;
  return params;
}

DeviceStatistics statistics_of(const DeviceInfo& device, const RenderSetup& setup) {
  DeviceStatistics statistics;
  statistics.index = device.index;
  statistics.name = label_of(device);
  statistics.platform = device.platform;
  statistics.driver = device.driver;
  statistics.predicted_bytes = setup.predicted_bytes(profile_for(device));
  return statistics;
}

}  // namespace hemiray

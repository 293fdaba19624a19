#include "host/bvh/ray_queries.hpp"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "host/bvh/ray_codes.hpp"
#include "shared/params.h"

namespace hemiray {

namespace {

constexpr std::uint32_t kGroupRays = 16;  // of a packet, kernels/lib/packet.h

ProgramOptions query_options(const Context& context, const DeviceScene& scene, const Accel& accel, bool strict,
                             bool double_precision) {
  ProgramOptions options = accel.program_options(scene.features(), strict, double_precision);
  options.defines += fmt::format(" -DHR_RAYS_PER_ITEM={} -DHR_PACKET_GROUPS={}", context.profile().rays_per_item,
                                 context.profile().packet_groups);
  return options;
}

}  // namespace

shared::RenderParams query_params(const DeviceScene& scene) {
  shared::RenderParams params{};
  params.triangle_count = scene.triangle_count();
  params.sphere_count = scene.sphere_count();
  params.shape_count = scene.shape_count();
  params.plane_count = scene.plane_count();
  params.instance_count = scene.instance_count();
  return params;
}

RayQueries::RayQueries(Context& context, const DeviceScene& scene, const Accel& accel, bool strict,
                       RayGrouping grouping, bool double_precision)
    : context_(&context),
      scene_(&scene),
      accel_(&accel),
      grouping_(grouping == RayGrouping::packets && (double_precision || !accel.config().has_packets())
                    ? RayGrouping::single
                    : grouping),
      program_(context, grouping_ == RayGrouping::packets ? "packet_query" : "query",
               {grouping_ == RayGrouping::packets ? "bvh/packet_query.cl" : "bvh/query.cl"},
               query_options(context, scene, accel, strict, double_precision)) {
  if (grouping_ == RayGrouping::sorted) parallel_ = std::make_unique<Parallel>(context);
}

void RayQueries::sort_rays(const Buffer<shared::QueryRay>& rays, std::uint32_t count, std::uint32_t index_bits) {
  if (keys_.size() < count) {
    keys_ = Buffer<std::uint64_t>(*context_, "ray keys", count);
    keys_other_ = Buffer<std::uint64_t>(*context_, "ray keys", count);
  }
  const AccelStatistics& bounds = accel_->statistics();
  launch(
      *context_, program_.kernel("query_code_rays"), context_->profile().chunks,
      arguments(arg("rays", rays), arg("count", count), arg("lo", bounds.lo),
                arg("scale", ray_code_scale(bounds.lo, bounds.hi)), arg("index_bits", index_bits), arg("keys", keys_)));
  parallel_->sort(keys_, keys_other_, count, index_bits, kRayCodeBits);
}

template <typename Result>
void RayQueries::ask(const std::string& kernel, const char* result_name, const Buffer<shared::QueryRay>& rays,
                     const Buffer<Result>& results, std::uint32_t count) {
  if (count == 0) return;
  const shared::RenderParams params = query_params(*scene_);
  const bool packets = grouping_ == RayGrouping::packets;
  const DeviceProfile& profile = context_->profile();
  const std::uint32_t per_item = packets ? kGroupRays * profile.packet_groups : profile.rays_per_item;
  Arguments order;
  std::string name = (packets ? "query_packets_" : "query_") + kernel;
  if (grouping_ == RayGrouping::sorted) {
    const auto index_bits = static_cast<std::uint32_t>(std::bit_width(std::max(count, 2U) - 1));
    sort_rays(rays, count, index_bits);
    order = arguments(arg("keys", keys_), arg("index_bits", index_bits));
    name += "_sorted";
  }
  launch(*context_, program_.kernel(name), (count + per_item - 1) / per_item,
         arguments(scene_->shading_arguments(), accel_->tree_arguments(), arg("rays", rays), arg(result_name, results),
                   arg("count", count), arg("params", params), order));
}

void RayQueries::intersect(const Buffer<shared::QueryRay>& rays, const Buffer<shared::QueryHit>& hits,
                           std::uint32_t count) {
  ask("intersect", "hits", rays, hits, count);
}

void RayQueries::occluded(const Buffer<shared::QueryRay>& rays, const Buffer<std::uint32_t>& occluded,
                          std::uint32_t count) {
  ask("occluded", "occluded", rays, occluded, count);
}

std::vector<shared::QueryHit> RayQueries::intersect(std::span<const shared::QueryRay> rays) {
  if (rays.empty()) return {};
  const Buffer<shared::QueryRay> device_rays(*context_, "rays", rays);
  const Buffer<shared::QueryHit> hits(*context_, "hits", rays.size());
  intersect(device_rays, hits, static_cast<std::uint32_t>(rays.size()));
  return hits.read();
}

std::vector<std::uint32_t> RayQueries::occluded(std::span<const shared::QueryRay> rays) {
  if (rays.empty()) return {};
  const Buffer<shared::QueryRay> device_rays(*context_, "rays", rays);
  const Buffer<std::uint32_t> results(*context_, "occluded", rays.size());
  occluded(device_rays, results, static_cast<std::uint32_t>(rays.size()));
  return results.read();
}

}  // namespace hemiray

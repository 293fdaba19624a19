#include "host/bvh/accel.hpp"

#include <algorithm>
#include <chrono>
#include <limits>

namespace hemiray {
namespace {

// Up to here 30 bits tell primitives apart well enough and cost half the sorting.
constexpr std::uint32_t kMaxShortCodes = 1U << 16U;

double now_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void grow(shared::float4& lo, shared::float4& hi, const shared::float4& part_lo, const shared::float4& part_hi) {
  lo = {std::min(lo.x, part_lo.x), std::min(lo.y, part_lo.y), std::min(lo.z, part_lo.z), 0.0F};
  hi = {std::max(hi.x, part_hi.x), std::max(hi.y, part_hi.y), std::max(hi.z, part_hi.z), 0.0F};
}

}  // namespace

AccelBuilder::AccelBuilder(Context& context, Parallel& parallel)
    : context_(&context),
      parallel_(&parallel),
      program(context, "bvh", {"bvh/morton.cl", "bvh/lbvh_emit.cl", "bvh/refit.cl"}, ProgramOptions{}) {}

Accel::Accel(AccelBuilder& builder, const DeviceScene& scene, const AccelOptions& options) {
  const double start = now_ms();
  const double compile_start = builder.context_->launch_compile_ms();
  statistics_.morton_bits =
      options.morton_bits != 0 ? options.morton_bits : (scene.primitive_count() <= kMaxShortCodes ? 30 : 63);
  bound_primitives(builder, scene);
  Buffer<std::uint64_t> keys(*builder.context_, "Morton codes", scene.primitive_count());
  const Buffer<std::uint32_t> order = sort_primitives(builder, scene, keys);
  emit_tree(builder, scene, keys, order);
  builder.context_->finish();  // keys, order and the links must outlive the kernels
  statistics_.build_ms = now_ms() - start - (builder.context_->launch_compile_ms() - compile_start);
}

void Accel::bound_primitives(AccelBuilder& builder, const DeviceScene& scene) {
  Context& context = *builder.context_;
  const std::uint32_t chunks = context.profile().chunks;
  Buffer<shared::BoundsPartial> partials(context, "bounds", chunks);
  launch(context, builder.program.kernel("bvh_bound_primitives"), chunks,
         arguments(scene.geometry_arguments(), arg("primitive_count", scene.primitive_count()),
                   arg("partials", partials)));
  constexpr float kInf = std::numeric_limits<float>::infinity();
  statistics_.lo = centroid_lo_ = {kInf, kInf, kInf, 0.0F};
  statistics_.hi = centroid_hi_ = {-kInf, -kInf, -kInf, 0.0F};
  for (const shared::BoundsPartial& part : partials.read()) {
    statistics_.primitives += part.valid;
    statistics_.non_finite += part.non_finite;
    statistics_.degenerate += part.degenerate;
    grow(statistics_.lo, statistics_.hi, part.lo, part.hi);
    grow(centroid_lo_, centroid_hi_, part.centroid_lo, part.centroid_hi);
  }
}

Buffer<std::uint32_t> Accel::sort_primitives(AccelBuilder& builder, const DeviceScene& scene,
                                             Buffer<std::uint64_t>& keys) {
  Context& context = *builder.context_;
  Buffer<std::uint32_t> order(context, "primitive order", scene.primitive_count());
  const std::uint32_t axis_bits = statistics_.morton_bits / 3;
  launch(context, builder.program.kernel("bvh_code_primitives"), context.profile().chunks,
         arguments(scene.geometry_arguments(), arg("primitive_count", scene.primitive_count()),
                   arg("centroid_lo", centroid_lo_), arg("centroid_hi", centroid_hi_), arg("axis_bits", axis_bits),
                   arg("keys", keys), arg("values", order)));
  // One bit more than the code: dropped primitives sort behind all others.
  builder.parallel_->sort(keys, order, scene.primitive_count(), statistics_.morton_bits + 1);
  return order;
}

void Accel::emit_tree(AccelBuilder& builder, const DeviceScene& scene, const Buffer<std::uint64_t>& keys,
                      const Buffer<std::uint32_t>& order) {
  Context& context = *builder.context_;
  const std::uint32_t count = statistics_.primitives;
  const std::uint32_t inner = std::max(count, 2U) - 1;
  nodes_ = Buffer<shared::BvhNode>(context, "bvh_nodes", inner);
  leaves_ = Buffer<shared::BvhLeaf>(context, "bvh_leaves", std::max(count, 1U));
  Buffer<std::uint32_t> node_parents(context, "node parents", inner);
  Buffer<std::uint32_t> leaf_parents(context, "leaf parents", std::max(count, 1U));
  Buffer<std::uint32_t> flags(context, "refit flags", inner);
  launch(context, builder.program.kernel("bvh_emit_nodes"), inner,
         arguments(arg("keys", keys), arg("nodes", nodes_), arg("node_parents", node_parents),
                   arg("leaf_parents", leaf_parents), arg("flags", flags), arg("count", count)));
  launch(context, builder.program.kernel("bvh_refit_nodes"), std::max(count, 1U),
         arguments(scene.geometry_arguments(), arg("order", order), arg("leaves", leaves_), arg("nodes", nodes_),
                   arg("node_parents", node_parents), arg("leaf_parents", leaf_parents), arg("flags", flags),
                   arg("count", count)));
  context.finish();
}

Arguments Accel::tree_arguments() const { return arguments(arg("bvh_nodes", nodes_), arg("bvh_leaves", leaves_)); }

RayQueries::RayQueries(Context& context, const DeviceScene& scene, const Accel& accel, bool strict)
    : context_(&context),
      scene_(&scene),
      accel_(&accel),
      program_(context, "query", {"bvh/query.cl"}, ProgramOptions{scene.features(), strict}) {}

template <typename Result>
std::vector<Result> RayQueries::ask(const char* kernel, const char* result_name,
                                    std::span<const shared::QueryRay> rays) {
  if (rays.empty()) return {};
  const Buffer<shared::QueryRay> device_rays(*context_, "rays", rays);
  const Buffer<Result> results(*context_, result_name, rays.size());
  shared::RenderParams params{};
  params.triangle_count = scene_->triangle_count();
  params.sphere_count = scene_->sphere_count();
  params.plane_count = scene_->plane_count();
  launch(*context_, program_.kernel(kernel), rays.size(),
         arguments(scene_->shading_arguments(), accel_->tree_arguments(), arg("rays", device_rays),
                   arg(result_name, results), arg("count", static_cast<std::uint32_t>(rays.size())),
                   arg("params", params)));
  return results.read();
}

std::vector<shared::QueryHit> RayQueries::intersect(std::span<const shared::QueryRay> rays) {
  return ask<shared::QueryHit>("query_intersect", "hits", rays);
}

std::vector<std::uint32_t> RayQueries::occluded(std::span<const shared::QueryRay> rays) {
  return ask<std::uint32_t>("query_occluded", "occluded", rays);
}

}  // namespace hemiray

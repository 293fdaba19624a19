#include "host/bvh/nearest_queries.hpp"

#include <limits>
#include <string>

#include "host/base/error.hpp"

namespace hemiray {
namespace {

ProgramOptions nearest_options(const DeviceScene& scene, const Accel& accel) {
  if (scene.instance_count() > 0) {
    throw InputError("nearest-neighbour search",
                     "needs every object in the world; flatten the scene without instances");
  }
  if (accel.config().kind != AccelKind::bvh) {
    throw InputError("nearest-neighbour search", "needs a tree of boxes; build it with kind bvh");
  }
  // Strict: distances are computed alike wherever a point or a box stands in the tree.
  return accel.program_options(HR_FEATURE_TRIANGLES | HR_FEATURE_SPHERES, true);
}

FlatScene as_spheres(std::span<const Vec3> points) {
  FlatScene flat;
  flat.materials.emplace_back();
  flat.spheres.resize(points.size());
  for (std::size_t i = 0; i < points.size(); i++) {
    flat.spheres[i].center_radius = {points[i].x, points[i].y, points[i].z, std::numeric_limits<float>::min()};
  }
  return flat;
}

}  // namespace

NearestQueries::NearestQueries(Context& context, const DeviceScene& scene, const Accel& accel)
    : context_(&context),
      scene_(&scene),
      accel_(&accel),
      program_(context, "nearest", {"bvh/nearest.cl"}, nearest_options(scene, accel)) {}

void NearestQueries::closest(const Buffer<QueryPoint>& queries, const Buffer<shared::float4>& nearest,
                             const Buffer<std::uint32_t>& primitives, std::uint32_t count) {
  if (count == 0) return;
  launch(*context_, program_.kernel("nearest_on_scene"), count,
         arguments(scene_->geometry_arguments(), accel_->tree_arguments(), arg("queries", queries), arg("count", count),
                   arg("nearest", nearest), arg("primitives", primitives)));
}

ClosestPoints NearestQueries::closest(std::span<const QueryPoint> queries) {
  if (queries.empty()) return {};
  const Buffer<QueryPoint> device_queries(*context_, "queries", queries);
  const Buffer<shared::float4> nearest(*context_, "nearest points", queries.size());
  const Buffer<std::uint32_t> primitives(*context_, "nearest primitives", queries.size());
  closest(device_queries, nearest, primitives, static_cast<std::uint32_t>(queries.size()));
  return {nearest.read(), primitives.read()};
}

PointTree::PointTree(Context& context, AccelBuilder& builder, std::span<const Vec3> points, const AccelOptions& options)
    : context_(&context), scene_(context, as_spheres(points), HR_FEATURE_SPHERES) {
  accel_.emplace(builder, scene_, options);
  program_.emplace(context, "nearest", std::vector<std::string>{"bvh/nearest.cl"}, nearest_options(scene_, *accel_));
}

Neighbours PointTree::nearest(std::span<const QueryPoint> queries, unsigned k) {
  if (k < 1 || k > kMaxNeighbours) {
    throw InputError("nearest neighbours", std::to_string(k) + " cannot be searched for; take 1 to 16");
  }
  if (queries.empty()) return {};
  const auto count = static_cast<std::uint32_t>(queries.size());
  const Buffer<QueryPoint> device_queries(*context_, "queries", queries);
  const Buffer<float> distances(*context_, "distances", queries.size() * k);
  const Buffer<std::uint32_t> indices(*context_, "neighbours", queries.size() * k);
  launch(*context_, program_->kernel("nearest_points"), count,
         arguments(accel_->tree_arguments(), arg("queries", device_queries), arg("count", count),
                   arg("k", std::uint32_t{k}), arg("distances", distances), arg("indices", indices)));
  return {distances.read(), indices.read()};
}

}  // namespace hemiray

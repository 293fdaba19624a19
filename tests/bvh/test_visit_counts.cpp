// Counted visits of nodes and blocks are those that a walk on the host needs.
#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "host/bvh/visit_counts.hpp"
#include "tests/bvh/query_bench.hpp"

namespace hemiray {
namespace {

using test::make_ray;
using test::QueryBench;
using test::Rays;

// Boxes that a ray only just misses may be entered by the device's padded slabs.
constexpr double kRoundingShare = 1e-4;

bool meets(const shared::QueryRay& ray, const float* lane, unsigned width) {
  const DVec3 origin(ray.origin.x, ray.origin.y, ray.origin.z);
  const DVec3 direction(ray.direction.x, ray.direction.y, ray.direction.z);
  double t_in = ray.origin.w, t_out = ray.direction.w;
  for (int axis = 0; axis < 3; axis++) {
    const double lo = (double{lane[(2 * axis) * static_cast<int>(width)]} - origin[axis]) / direction[axis];
    const double hi = (double{lane[(2 * axis + 1) * static_cast<int>(width)]} - origin[axis]) / direction[axis];
    t_in = std::max(t_in, std::min(lo, hi));
    t_out = std::min(t_out, std::max(lo, hi));
  }
  return t_in <= t_out;
}

// Of a ray that nothing stops: every node and block whose boxes it meets, whatever the order.
VisitCounts walk(const Accel& accel, const Rays& rays) {
  const std::vector<float> nodes = accel.nodes().read();
  const unsigned width = accel.config().width;
  VisitCounts sum;
  for (const shared::QueryRay& ray : rays) {
    std::vector<std::int32_t> open = {0};
    while (!open.empty()) {
      const float* node = &nodes[static_cast<std::size_t>(open.back()) * accel.config().node_words()];
      open.pop_back();
      sum.nodes += 1.0;
      for (unsigned lane = 0; lane < width; lane++) {
        const auto child = std::bit_cast<std::int32_t>(node[HR_NODE_CHILD_ROW * width + lane]);
        if (child == -1 || !meets(ray, node + lane, width)) continue;
        if (child >= 0) {
          open.push_back(child);
        } else {
          sum.blocks += ~child & HR_MAX_LEAF_BLOCKS;
        }
      }
    }
  }
  const auto count = static_cast<double>(rays.size());
  return {sum.nodes / count, sum.blocks / count};
}

VisitCounts counted(QueryBench& bench, Context& context, const Rays& rays, bool any_hit) {
  const Buffer<shared::QueryRay> buffer(context, "rays", std::span<const shared::QueryRay>(rays));
  return count_visits(context, bench.tree.scene, bench.tree.accel, buffer, static_cast<std::uint32_t>(rays.size()),
                      any_hit);
}

}  // namespace

TEST_CASE("rays that nothing stops visit what their boxes say, for the closest hit as for any") {
  test::TreeWorkshop workshop;
  const FlatScene flat = test::soup(3000, 0, 0.05F, 301);
  for (const unsigned width : {8U, 2U}) {
    AccelOptions options;
    options.width = width;
    QueryBench bench(workshop, flat, options);
    Rays rays;
    const Rays all = test::random_rays(4000, 302);
    const std::vector<std::uint32_t> occluded = bench.queries.occluded(all);
    for (std::size_t i = 0; i < all.size(); i++) {
      if (occluded[i] == 0) rays.push_back(all[i]);
    }
    REQUIRE(rays.size() > 500);
    const VisitCounts expected = walk(bench.tree.accel, rays);
    CHECK(expected.blocks > 0.1);
    for (const bool any_hit : {false, true}) {
      const VisitCounts found = counted(bench, workshop.context, rays, any_hit);
      INFO(width << " wide, " << (any_hit ? "any" : "closest"));
      CHECK(found.nodes == Approx(expected.nodes).epsilon(kRoundingShare));
      CHECK(found.blocks == Approx(expected.blocks).epsilon(kRoundingShare));
    }
  }
}

TEST_CASE("a ray that something stops visits no more than it must") {
  test::TreeWorkshop workshop;
  FlatScene flat = test::empty_flat_scene();
  test::add_triangle(flat, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
  QueryBench bench(workshop, flat, {});
  const Rays hit = {make_ray({0, 0, 1}, {0, 0, -1})}, past = {make_ray({5, 0, 1}, {0, 0, -1})};
  for (const bool any_hit : {false, true}) {
    CHECK(counted(bench, workshop.context, hit, any_hit).nodes == 1.0);
    CHECK(counted(bench, workshop.context, hit, any_hit).blocks == 1.0);
    CHECK(counted(bench, workshop.context, past, any_hit).nodes == 1.0);
    CHECK(counted(bench, workshop.context, past, any_hit).blocks == 0.0);
  }
}

}  // namespace hemiray

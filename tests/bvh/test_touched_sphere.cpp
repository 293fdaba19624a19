// Rays that all but touch a sphere: rounding must not let them leave it on the wrong side.
#include <catch2/catch.hpp>

#include <vector>

#include "host/bvh/leaving_rays.hpp"
#include "tests/bvh/query_bench.hpp"

namespace hemiray {
namespace {

using test::Places;
using test::Rays;

}  // namespace

TEST_CASE("a ray from outside that touches a sphere leaves it on the side that it is to go on to") {
  test::TreeWorkshop workshop;
  Places places(101);
  for (const float far : {0.0F, 1e2F, 1e4F, 1e6F}) {
    const Vec3 center = far * Vec3(1.0F, -0.7F, 0.3F);
    FlatScene flat = test::empty_flat_scene();
    test::add_sphere(flat, center, 1.0F);
    Rays rays;
    std::vector<shared::float4> wanted;
    while (rays.size() < 20000) {
      const Vec3 normal = places.direction(), along = glm::normalize(glm::cross(normal, places.direction()));
      const Vec3 from = center + normal * (1.0F - places.in(0.0F, 1e-6F)) - 2.0F * along;
      rays.push_back(test::make_ray(from, along));
      wanted.push_back({along.x, along.y, along.z, places.below(2) == 0 ? 1.0F : -1.0F});
    }
    for (const bool strict : {false, true}) {
      const test::BuiltTree tree(workshop, flat);
      const LeavingRays answers = leave_surfaces(workshop.context, tree.scene, tree.accel, rays, wanted, strict);
      std::size_t found = 0, wrong_side = 0, self_hit = 0, tunnelled = 0;
      for (std::size_t i = 0; i < rays.size(); i++) {
        if (answers.hits[i].primitive == test::kMiss) continue;
        found++;
        const shared::float4& o = answers.leaving[i].origin;
        const bool outside = glm::length(DVec3(o.x, o.y, o.z) - DVec3(center)) > 1.0,
                   meets = answers.next[i].primitive == 0;
        const bool stays_outside = wanted[i].w > 0.0F;
        wrong_side += outside != stays_outside ? 1 : 0;
        self_hit += stays_outside && meets ? 1 : 0;
        tunnelled += !stays_outside && !meets ? 1 : 0;
      }
      INFO("at " << far << (strict ? ", strict" : "") << ", " << found << " of " << rays.size());
      CHECK(found > rays.size() / 5);
      CHECK(wrong_side == 0);
      CHECK(self_hit == 0);
      CHECK(tunnelled == 0);
    }
  }
}

}  // namespace hemiray

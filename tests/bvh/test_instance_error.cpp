// The error bound of a hit on an instance: what leaves the surface does not meet it again.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "tests/bvh/instanced_scenes.hpp"

namespace hemiray {
namespace {

using test::add_mesh;
using test::add_object;
using test::InstancedTree;
using test::make_ray;
using test::Places;
using test::random_turn;
using test::Rays;

// Where each ray meets the scene another one leaves, mirrored, as far off as the error bound says, and may meet
// anything again: met[i] = 1 if it does, 2 if the first missed.
constexpr const char* kLeave = R"(#include "lib/offset.h"
#include "lib/surface.h"
#include "lib/traverse.h"
kernel void leave_surface(HR_SCENE_PARAMETERS global const QueryRay* restrict rays, global uint* restrict met,
                          const RenderParams params) {
  const uint i = (uint)get_global_id(0);
  HR_MAKE_SCENE_VIEW(params)
  const real3 origin = (real3)(rays[i].origin.x, rays[i].origin.y, rays[i].origin.z);
  const real3 d = (real3)(rays[i].direction.x, rays[i].direction.y, rays[i].direction.z);
  const Skip nothing = {HR_NO_PRIMITIVE, 1, 0};
  const Ray ray = make_ray(origin, d, 0, INFINITY);
  const Hit hit = traverse_closest(&view, &ray, &nothing);
  met[i] = 2;
  if (hit.primitive == HR_NO_PRIMITIVE) return;
  const Surface s = surface_at(&view, origin, d, &hit);
  const real3 away = d - s.normal * (2 * dot3(d, s.normal));
  const Ray next = make_ray(offset_origin(s.position, s.error, s.normal, away), away, 0, INFINITY);
  met[i] = traverse_any(&view, &next, &nothing) ? 1 : 0;
}
)";

// A flat grid on a unit square around `middle`, then turned.
Mesh flat_grid(int n, DVec3 middle, const DMat4& turn) {
  Mesh mesh;
  for (int i = 0; i <= n; i++) {
    for (int j = 0; j <= n; j++) {
      const DVec3 p = middle + DVec3(i, j, 0) / static_cast<double>(n) - DVec3(0.5, 0.5, 0);
      mesh.positions.emplace_back(turn * glm::dvec4(p, 1.0));
    }
  }
  const auto corner = [n](int i, int j) { return static_cast<std::uint32_t>(i * (n + 1) + j); };
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      mesh.triangles.emplace_back(corner(i, j), corner(i + 1, j), corner(i + 1, j + 1));
      mesh.triangles.emplace_back(corner(i, j), corner(i + 1, j + 1), corner(i, j + 1));
    }
  }
  mesh.triangle_materials.assign(mesh.triangles.size(), 0);
  return mesh;
}

}  // namespace

TEST_CASE("a ray that leaves an instance does not meet it again, however it is stretched and however far away") {
  const test::KernelFolder folder("probe/leave.cl", kLeave);
  test::TreeWorkshop workshop;
  Places places(22);
  // The grid's plane holds the direction in which it is squeezed, and lies askew in its own space: coordinates that the
  // way back makes large cancel at right angles to the plane, so that is where their roundings show.
  const DMat4 upright = glm::rotate(DMat4(1.0), glm::radians(90.0), DVec3(0, 1, 0));
  const DMat4 askew = glm::rotate(DMat4(1.0), 0.9, glm::normalize(DVec3(1.0, 2.0, 0.5)));
  for (const double far : {0.0, 1e4}) {
    for (const double off : {0.0, 100.0}) {  // the mesh's distance from the origin of its own space
      for (const DVec3 scale : {DVec3(1.0), DVec3(-1.0, 0.01, 1.0), DVec3(0.7, 1.0, 0.005), DVec3(1e-3, 2e-3, 1e-3)}) {
        const DVec3 middle = off * DVec3(0.6, 0.8, 0.5);
        const DMat4 placed = random_turn(places, DVec3(far, -far, 0.5 * far), scale) * upright;
        const DMat4 to_world = placed * glm::transpose(askew);
        Scene scene;
        add_object(scene, add_mesh(scene, flat_grid(16, middle, askew)), to_world);
        const FlatScene flat = flatten_scene(scene, Instancing::always);
        REQUIRE(flat.instances.size() == 1);
        const DVec3 place(placed * glm::dvec4(middle, 1.0)), u(placed[0]), v(placed[1]);
        const DVec3 n = glm::normalize(glm::cross(u, v));
        const double size = std::max(glm::length(u), glm::length(v));
        Rays rays;
        for (int i = 0; i < 20000; i++) {  // from all heights, so that some graze
          const double a = places.in(-0.45F, 0.45F), b = places.in(-0.45F, 0.45F);
          const DVec3 target = place + a * u + b * v;
          const DVec3 from = DVec3(places.direction()), flat_way = from - n * glm::dot(n, from);
          const double height = std::exp2(places.in(-5.0F, 2.0F)) * (i % 2 == 0 ? 1.0 : -1.0);
          const Vec3 origin(target + size * (flat_way + height * n));
          rays.push_back(make_ray(origin, Vec3(glm::normalize(target - DVec3(origin)))));
        }
        const InstancedTree tree(workshop, flat);
        constexpr std::uint32_t kFeatures = test::kAllPrimitives | HR_FEATURE_INSTANCES;
        Program program(workshop.context, "leave", {"probe/leave.cl"}, tree.accel.program_options(kFeatures, false));
        const Buffer<shared::QueryRay> device_rays(workshop.context, "rays", std::span<const shared::QueryRay>(rays));
        const Buffer<std::uint32_t> met(workshop.context, "met", rays.size());
        shared::RenderParams params{};
        params.instance_count = 1;
        launch(workshop.context, program.kernel("leave_surface"), rays.size(),
               arguments(tree.scene.shading_arguments(), tree.accel.tree_arguments(), arg("rays", device_rays),
                         arg("met", met), arg("params", params)));
        const std::vector<std::uint32_t> answers = met.read();
        INFO("at " << far << ", off by " << off << ", scaled by " << scale.x << ", " << scale.y << ", " << scale.z);
        CHECK(std::count(answers.begin(), answers.end(), 0U) > 15000);
        CHECK(std::count(answers.begin(), answers.end(), 1U) == 0);
      }
    }
  }
}

}  // namespace hemiray

// What is known of a shape's surface: its box, and the hit's place, error bound and normal, by which secondary rays
// leave.
#include <catch2/catch.hpp>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "tests/bvh/shape_rays.hpp"

namespace hemiray {
namespace {

// Nearer to the surface than the rounding of its normal, a mirrored ray may go into it.
constexpr long double kGrazing = 2e-7L;
// Nearer to a quadric's apex than this share of the reach, squares are zero in float.
constexpr long double kUnderflow = 1e-19L;

using test::NamedShape;
using test::Places;
using test::random_point;
using test::Rays;
using test::rays_at_shape;
using test::rim_point;
using test::scene_of;
using test::ShapeOracle;
using test::shapes_of_size_one;
using test::turned;
using test::Wide;

}  // namespace

TEST_CASE("a shape's box holds it, and hardly more") {
  Places places(80);
  for (NamedShape& named : shapes_of_size_one()) {
    INFO(named.name);
    named.shape.to_world =
        glm::translate(DMat4(1.0), DVec3(3, -2, 1)) * turned(places) * glm::scale(DMat4(1.0), DVec3(1.0, 0.5, 2.0));
    const shared::Shape shape = flatten_shape(named.shape);
    const ShapeOracle oracle(shape);
    Wide lo(1e30L), hi(-1e30L);
    for (int i = 0; i < 40000; i++) {
      const Wide p = i % 4 == 0 ? rim_point(shape, oracle, places) : random_point(oracle, places).p;
      lo = glm::min(lo, p);
      hi = glm::max(hi, p);
    }
    const Wide box_lo = test::wide(shape.lo), box_hi = test::wide(shape.hi);
    for (int axis = 0; axis < 3; axis++) {
      CHECK(box_lo[axis] <= lo[axis]);
      CHECK(box_hi[axis] >= hi[axis]);
      // A clip is cut into 32 parts along each side; samples miss a little themselves.
      const long double slack = (named.shape.clip != Clip::none ? 0.17L : 0.06L) * oracle.reach();
      CHECK(box_lo[axis] >= lo[axis] - slack);
      CHECK(box_hi[axis] <= hi[axis] + slack);
    }
  }
}

namespace {

// Where rays meet the shape, and another that leaves it mirrored from as far off as the error bound says. surfaces[2i]
// = position, and the bound's length along the normal; surfaces[2i + 1] = normal, and 1 if the second ray meets the
// shape again, 2 if there is no hit. Launch: an item a ray.
constexpr const char* kLeaveShape = R"(#include "lib/offset.h"
#include "lib/surface.h"
#include "lib/traverse.h"
kernel void leave_shape(HR_SCENE_PARAMETERS global const QueryRay* restrict rays, global float4* restrict surfaces,
                        const RenderParams params) {
  const uint i = (uint)get_global_id(0);
  HR_MAKE_SCENE_VIEW(params)
  const real3 origin = (real3)(rays[i].origin.x, rays[i].origin.y, rays[i].origin.z);
  const real3 d = (real3)(rays[i].direction.x, rays[i].direction.y, rays[i].direction.z);
  const Skip nothing = {HR_NO_PRIMITIVE, 1, 0};
  const Ray ray = make_ray(origin, d, 0, INFINITY);
  const Hit hit = traverse_closest(&view, &ray, &nothing);
  surfaces[2 * i] = (float4)(0.0f);
  surfaces[2 * i + 1] = (float4)(0.0f, 0.0f, 0.0f, 2.0f);
  if (hit.primitive == HR_NO_PRIMITIVE) return;
  const Surface s = surface_at(&view, origin, d, &hit);
  const real3 away = d - s.normal * (2 * dot3(d, s.normal));
  const Skip self = {is_curved_shape(&view, hit.primitive) ? HR_NO_PRIMITIVE : hit.primitive, 1, 0};
  const Ray next = make_ray(offset_origin(s.position, s.error, s.normal, away), away, 0, INFINITY);
  surfaces[2 * i] = (float4)(s.position.x, s.position.y, s.position.z, dot3(fabs(s.normal), s.error));
  surfaces[2 * i + 1] =
      (float4)(s.normal.x, s.normal.y, s.normal.z, s.front && traverse_any(&view, &next, &self) ? 1.0f : 0.0f);
}
)";

}  // namespace

TEST_CASE("a hit lies on the shape within its error bound, and what leaves a convex shape does not meet it again") {
  const test::KernelFolder folder("probe/leave_shape.cl", kLeaveShape);
  test::TreeWorkshop workshop;
  Places places(81);
  for (const NamedShape& named : shapes_of_size_one()) {
    for (const double size : {1e-3, 1.0, 1e3}) {
      for (const double far : {0.0, 1e3}) {
        Shape placed = named.shape;
        placed.to_world = glm::translate(DMat4(1.0), far * DVec3(places.direction())) * turned(places) *
                          glm::scale(DMat4(1.0), DVec3(size));
        const shared::Shape shape = flatten_shape(placed);
        const ShapeOracle oracle(shape);
        const Rays rays = rays_at_shape(shape, 6000, 900);
        const test::BuiltTree tree(workshop, scene_of(shape));
        Program program(workshop.context, "leave_shape", {"probe/leave_shape.cl"},
                        tree.accel.program_options(test::kAllPrimitives, false));
        const Buffer<shared::QueryRay> device_rays(workshop.context, "rays", std::span<const shared::QueryRay>(rays));
        const Buffer<shared::float4> surfaces(workshop.context, "surfaces", 2 * rays.size());
        launch(workshop.context, program.kernel("leave_shape"), rays.size(),
               arguments(tree.scene.shading_arguments(), tree.accel.tree_arguments(), arg("rays", device_rays),
                         arg("surfaces", surfaces), arg("params", query_params(tree.scene))));
        const std::vector<shared::float4> answers = surfaces.read();
        const test::Hits hits = RayQueries(workshop.context, tree.scene, tree.accel).intersect(rays);
        std::size_t found = 0, off = 0, again = 0, loose = 0;
        std::ostringstream detail;  // of the first that fail
        for (std::size_t i = 0; i < rays.size(); i++) {
          const shared::float4 &position = answers[2 * i], &normal = answers[2 * i + 1];
          if (normal.w == 2.0F) continue;
          found++;
          const Wide p = test::wide(position);
          const long double away = oracle.distance(static_cast<int>(hits[i].u), p);
          const bool is_off = away > static_cast<long double>(position.w) + kUnderflow * oracle.reach();
          if (is_off && off++ == 0) {
            detail << "ray " << i << " of kind " << i % test::kRayKinds << " off by " << away << ", bound "
                   << position.w << ", t " << hits[i].t << " part " << hits[i].u << "; ";
          }
          const long double sizes = oracle.reach() + glm::length(oracle.place());
          if (static_cast<long double>(position.w) > 2e-5L * sizes) loose++;
          const long double cosine = glm::dot(test::wide(normal), glm::normalize(test::wide(rays[i].direction)));
          if (normal.w == 1.0F && std::abs(cosine) > kGrazing && again++ == 0) {
            detail << "ray " << i << " of kind " << i % test::kRayKinds << " meets it again, part " << hits[i].u
                   << ", cosine " << cosine << "; ";
          }
        }
        INFO(detail.str() << named.name << " of size " << size << " at " << far << ", " << found << " hits");
        CHECK(found > 300);
        CHECK(off == 0);
        CHECK(loose <= found / 20);  // near an apex a quadric cone knows its own place less well
        if (named.convex) CHECK(again == 0);
      }
    }
  }
}

}  // namespace hemiray

// Double precision: what it buys against the reference and against exact distances, and where it is refused.
#include <catch2/catch.hpp>

#include <cmath>
#include <string>

#include "host/base/error.hpp"
#include "host/path/render.hpp"
#include "tests/bvh/query_bench.hpp"
#include "tests/reference/comparison_scenes.hpp"
#include "tests/reference/image_agreement.hpp"

namespace hemiray {
namespace {

// What is left is the scene's rounding to floats, which the reference does not do, over bounces off spheres (seen:
// 1.1e-12; single precision is allowed 3e-7), and single precision sums. Where the camera looks exactly along the edges
// of a box that rounding changes pixels outright, as it does in single.
constexpr double kDoubleRelMse = 1e-11;
constexpr double kDoubleOutliers = 0.01;

bool has_double() { return choose_device("").has_fp64; }

Image render_double(const reference::ComparisonScene& item, EngineKind engine) {
  RenderOptions options;
  options.width = item.options.width;
  options.height = item.options.height;
  options.spp = item.options.spp;
  options.depth = item.options.depth;
  options.seed = item.options.seed;
  options.engine = engine;
  options.double_precision = true;
  Context context(choose_device(""));
  return render_scene(context, item.scene, options).image;
}

}  // namespace

TEST_CASE("pictures in double precision are the reference's but for single precision sums") {
  if (!has_double()) return;
  const auto scenes = reference::comparison_scenes();
  for (std::size_t i = 0; i < scenes.size(); i += 3) {
    const Image expected = render_reference(scenes[i].scene, scenes[i].options);
    const EngineKind engine = i % 2 == 0 ? EngineKind::wavefront : EngineKind::megakernel;
    for (const reference::LayerAgreement& layer :
         reference::compare_layers(render_double(scenes[i], engine), expected)) {
      INFO("scene '" << scenes[i].name << "', layer '" << layer.layer << "': relMSE " << layer.rel_mse << ", outliers "
                     << layer.outlier_share);
      CHECK(layer.outlier_share <= kDoubleOutliers);
      CHECK(layer.rel_mse <= kDoubleRelMse);
    }
  }
}

// A ball of triangles 1e5 m from the origin of coordinates, hit from 2 km away at whatever angle: the exact distance is
// that of the plane of the triangle that is named.
TEST_CASE("distances in double precision are exact but for the float they are told in") {
  if (!has_double()) return;
  test::TreeWorkshop workshop;
  const FlatScene mesh = test::closed_mesh(12, true, Vec3(1e5F, -5e4F, 7e4F));
  test::Places places(71);
  test::Rays rays;
  for (int i = 0; i < 20000; i++) {
    const Vec3 from = Vec3(1e5F, -5e4F, 7e4F) + 2e3F * places.direction();
    rays.push_back(test::make_ray(from, Vec3(1e5F, -5e4F, 7e4F) + 0.5F * places.direction() - from));
  }
  const test::BuiltTree tree(workshop, mesh, {});
  const auto worst_ulps = [&](bool double_precision) {
    RayQueries queries(workshop.context, tree.scene, tree.accel, false, RayGrouping::single, double_precision);
    const test::Hits hits = queries.intersect(rays);
    CHECK(test::count_found(hits) == rays.size());
    double worst = 0.0;
    for (std::size_t i = 0; i < rays.size(); i++) {
      if (hits[i].primitive == test::kMiss) continue;
      const shared::uint4 t = mesh.triangles[hits[i].primitive];
      const DVec3 a = test::vertex(mesh, t.x), b = test::vertex(mesh, t.y), c = test::vertex(mesh, t.z);
      const DVec3 o(rays[i].origin.x, rays[i].origin.y, rays[i].origin.z);
      const DVec3 d(rays[i].direction.x, rays[i].direction.y, rays[i].direction.z);
      const DVec3 n = glm::cross(b - a, c - a);
      const double exact = glm::dot(a - o, n) / glm::dot(d, n);
      const double ulp = std::nextafter(hits[i].t, INFINITY) - hits[i].t;
      worst = std::max(worst, std::abs(hits[i].t - exact) / ulp);
    }
    return worst;
  };
  const double in_double = worst_ulps(true), in_single = worst_ulps(false);
  INFO("worst error of t [ulps]: " << in_double << " in double, " << in_single << " in single precision");
  CHECK(in_double <= 0.5001);
  CHECK(in_single > 1.0);
}

TEST_CASE("no ray leaves a closed mesh in double precision") {
  if (!has_double()) return;
  test::TreeWorkshop workshop;
  for (const bool round : {true, false}) {
    const FlatScene mesh = test::closed_mesh(12, round, Vec3(100.0F));
    const test::Rays rays = test::rays_from_inside(mesh, 50000, 72);
    const test::BuiltTree tree(workshop, mesh, {});
    RayQueries queries(workshop.context, tree.scene, tree.accel, false, RayGrouping::single, true);
    CHECK(test::count_found(queries.intersect(rays)) == rays.size());
    for (const std::uint32_t met : queries.occluded(rays)) REQUIRE(met == 1);
  }
}

TEST_CASE("a device without double precision refuses it, and says why") {
  DeviceInfo device = choose_device("");
  device.has_fp64 = false;
  Context context(device);
  RenderOptions options;
  options.width = options.height = 8;
  options.double_precision = true;
  std::string message;
  try {
    render_scene(context, reference::comparison_scenes().front().scene, options);
  } catch (const DeviceError& error) {
    message = error.what();
  }
  CHECK(message.find("--precision single") != std::string::npos);
}

TEST_CASE("packets are refused in double precision") {
  if (!has_double()) return;
  Context context(choose_device(""));
  RenderOptions options;
  options.width = options.height = 8;
  options.double_precision = true;
  options.rays = RayGrouping::packets;
  CHECK_THROWS_AS(render_scene(context, reference::comparison_scenes().front().scene, options), InputError);
}

}  // namespace hemiray

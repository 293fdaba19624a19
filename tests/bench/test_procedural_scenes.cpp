// The benchmark's scenes: as many triangles as asked for, the same on every call, and of the shape they promise.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>

#include "host/base/error.hpp"
#include "host/bench/flat_mesh.hpp"
#include "host/bench/procedural_scenes.hpp"
#include "host/scene/load.hpp"

namespace hemiray {
namespace {

using bench::BenchScene;
using bench::procedural_scene;
using bench::vertex_of;

// Lengths of a triangle's edges, the shortest first.
std::array<float, 3> edges_of(const FlatScene& flat, const shared::uint4& t) {
  const Vec3 a = vertex_of(flat, t.x), b = vertex_of(flat, t.y), c = vertex_of(flat, t.z);
  std::array<float, 3> edges{glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)};
  std::sort(edges.begin(), edges.end());
  return edges;
}

double median_of(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

}  // namespace

TEST_CASE("procedural scenes have the number of triangles asked for, within 1 %") {
  for (const std::string_view name : bench::procedural_scene_names()) {
    for (const std::uint32_t wanted : {10'000U, 12'345U, 100'000U}) {
      const FlatScene flat = procedural_scene(name, wanted).flat;
      INFO(name << " " << wanted << ": " << flat.triangles.size());
      CHECK(std::abs(static_cast<double>(flat.triangles.size()) - wanted) <= 0.01 * wanted);
    }
  }
}

TEST_CASE("procedural scenes are the same on every call, finite and consistent") {
  for (const std::string_view name : bench::procedural_scene_names()) {
    INFO(name);
    const BenchScene scene = procedural_scene(name, 20'000), again = procedural_scene(name, 20'000);
    CHECK(scene.flat.positions == again.flat.positions);
    REQUIRE(scene.flat.triangles.size() == again.flat.triangles.size());
    CHECK(std::memcmp(scene.flat.triangles.data(), again.flat.triangles.data(),
                      scene.flat.triangles.size() * sizeof(shared::uint4)) == 0);
    CHECK(scene.flat.triangle_objects.size() == scene.flat.triangles.size());
    CHECK(scene.flat.materials.size() == 1);
    CHECK(std::all_of(scene.flat.positions.begin(), scene.flat.positions.end(),
                      [](float x) { return std::isfinite(x); }));
    const std::size_t vertices = scene.flat.positions.size() / 3;
    std::size_t flat_triangles = 0;
    for (const shared::uint4& t : scene.flat.triangles) {
      REQUIRE(std::max({t.x, t.y, t.z}) < vertices);
      if (edges_of(scene.flat, t)[0] <= 0.0F) flat_triangles++;
    }
    CHECK(flat_triangles == 0);
    CHECK(glm::length(scene.view.forward) == Approx(1.0));
  }
}

TEST_CASE("the interior is a room of uneven triangles") {
  const BenchScene scene = procedural_scene("interior", 250'000);
  Vec3 lo(1e9F), hi(-1e9F);
  std::vector<double> longest;
  for (const shared::uint4& t : scene.flat.triangles) {
    for (const std::uint32_t v : {t.x, t.y, t.z}) {
      lo = glm::min(lo, vertex_of(scene.flat, v));
      hi = glm::max(hi, vertex_of(scene.flat, v));
    }
    longest.push_back(edges_of(scene.flat, t)[2]);
  }
  // The walls are the bounds but for what the clutter pokes through them.
  CHECK(lo.x == Approx(-10.0).margin(1.0));
  CHECK(hi.x == Approx(10.0).margin(1.0));
  CHECK(hi.y == Approx(6.0).margin(0.8));
  CHECK(*std::max_element(longest.begin(), longest.end()) > 20.0);  // a wall
  CHECK(median_of(longest) < 0.1);
  CHECK(scene.view.eye == Vec3(-8.5F, 3.2F, -8.5F));
}

TEST_CASE("hair is made of slivers and terrain of even triangles") {
  const auto median_ratio = [](const FlatScene& flat) {
    std::vector<double> ratios;
    for (const shared::uint4& t : flat.triangles) ratios.push_back(edges_of(flat, t)[2] / edges_of(flat, t)[0]);
    return median_of(ratios);
  };
  CHECK(median_ratio(procedural_scene("hair", 10'000).flat) > 30.0);
  CHECK(median_ratio(procedural_scene("terrain", 10'000).flat) < 3.0);
}

TEST_CASE("instances share one mesh and become its copies when flattened") {
  const Scene scene = bench::instanced_scene(50'000);
  REQUIRE(scene.meshes.size() == 1);
  validate_scene(scene);
  CHECK(scene.objects.size() == 260);  // 50,000 / 192
  CHECK(std::all_of(scene.objects.begin(), scene.objects.end(), [](const Object& o) { return o.mesh == 0; }));
  const FlatScene flat = procedural_scene("instances", 50'000).flat;
  CHECK(flat.triangles.size() == scene.objects.size() * scene.meshes[0].triangles.size());
  CHECK(flat.positions == flatten_scene(scene).positions);
}

TEST_CASE("unknown scenes and counts out of range are errors") {
  CHECK_THROWS_AS(procedural_scene("interiour", 10'000), InputError);
  CHECK_THROWS_WITH(procedural_scene("terain", 10'000), Catch::Contains("did you mean \"terrain\""));
  CHECK_THROWS_WITH(procedural_scene("interior", 9'999), Catch::Contains("--triangles"));
  CHECK_THROWS_AS(procedural_scene("interior", 20'000'001), InputError);
}

}  // namespace hemiray

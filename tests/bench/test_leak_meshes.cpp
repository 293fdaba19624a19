// Closed meshes and rays at their edges and vertices.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <map>

#include "host/bench/flat_mesh.hpp"
#include "host/bench/leaks.hpp"
#include "tests/bench/fake_tracer.hpp"

namespace hemiray {
namespace {

Vec3 direction_of(const shared::QueryRay& ray) { return {ray.direction.x, ray.direction.y, ray.direction.z}; }
float largest(Vec3 v) { return std::max({v.x, v.y, v.z}); }
Vec3 origin_of(const shared::QueryRay& ray) { return {ray.origin.x, ray.origin.y, ray.origin.z}; }

}  // namespace

TEST_CASE("leak meshes are closed, share their vertices and face outward") {
  for (const bench::LeakMesh& mesh : bench::leak_meshes(5)) {
    INFO(mesh.name);
    CHECK(mesh.flat.triangles.size() == 12 * 25);
    CHECK(mesh.flat.positions.size() / 3 == 6 * 25 + 2);  // Euler: V = F / 2 + 2
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const shared::uint4& t : mesh.flat.triangles) {
      edges[{t.x, t.y}]++;
      edges[{t.y, t.z}]++;
      edges[{t.z, t.x}]++;
      const Vec3 a = bench::vertex_of(mesh.flat, t.x), b = bench::vertex_of(mesh.flat, t.y),
                 c = bench::vertex_of(mesh.flat, t.z);
      REQUIRE(glm::dot(glm::cross(b - a, c - a), a - mesh.center) > 0.0F);
    }
    for (const auto& [edge, count] : edges) {
      REQUIRE(count == 1);
      REQUIRE(edges.contains({edge.second, edge.first}));
    }
  }
}

TEST_CASE("the leak meshes are a sphere and a box of about 250,000 triangles, here and moved by 100") {
  CHECK(12 * bench::kLeakCells * bench::kLeakCells == Approx(250'000).epsilon(0.01));
  const std::vector<bench::LeakMesh> meshes = bench::leak_meshes(2);
  REQUIRE(meshes.size() == 4);
  const std::vector<std::string> names{"sphere", "sphere moved by 100", "box", "box moved by 100"};
  for (std::size_t i = 0; i < 4; i++) {
    CHECK(meshes[i].name == names[i]);
    CHECK(meshes[i].center == Vec3(i % 2 == 0 ? 0.0F : 100.0F));
    for (std::uint32_t v = 0; v < meshes[i].flat.positions.size() / 3; v++) {
      const Vec3 p = bench::vertex_of(meshes[i].flat, v) - meshes[i].center;
      const float extent = i < 2 ? glm::length(p) : std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
      REQUIRE(extent == Approx(1.0).margin(1e-4));
    }
  }
}

TEST_CASE("leak rays start inside, 64 from a point, and aim at vertices or edges") {
  const bench::LeakMesh mesh = bench::leak_meshes(3)[3];
  for (const bench::LeakTarget target : {bench::LeakTarget::edges, bench::LeakTarget::vertices}) {
    const std::vector<shared::QueryRay> rays = bench::leak_rays(mesh, target, 1024, 9);
    REQUIRE(rays.size() == 1024);
    std::size_t at_vertices = 0;
    for (std::size_t i = 0; i < rays.size(); i++) {
      const Vec3 origin = origin_of(rays[i]);
      REQUIRE(origin == origin_of(rays[i / 64 * 64]));
      REQUIRE(largest(glm::abs(origin - mesh.center)) <= 0.4001F);
      const DVec3 aim = DVec3(origin) + DVec3(direction_of(rays[i]));
      double to_vertex = 1e9, to_edge = 1e9;
      for (const shared::uint4& t : mesh.flat.triangles) {
        const std::array<std::uint32_t, 4> corners{t.x, t.y, t.z, t.x};
        for (std::size_t e = 0; e < 3; e++) {
          const DVec3 a = bench::vertex_of(mesh.flat, corners[e]), b = bench::vertex_of(mesh.flat, corners[e + 1]);
          const double along = glm::clamp(glm::dot(aim - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
          to_edge = std::min(to_edge, glm::distance(aim, a + along * (b - a)));
          to_vertex = std::min(to_vertex, glm::distance(aim, a));
        }
      }
      REQUIRE(to_edge < 1e-6);
      at_vertices += to_vertex < 1e-6 ? 1 : 0;
    }
    CHECK((target == bench::LeakTarget::vertices ? at_vertices == 1024 : at_vertices < 10));
    CHECK(bench::leak_rays(mesh, target, 1024, 9)[1000].direction.x == rays[1000].direction.x);
  }
}

TEST_CASE("nearly all leak rays go in cones that packets can trace together") {
  for (const bench::LeakMesh& mesh : bench::leak_meshes(144)) {
    const std::vector<shared::QueryRay> rays = bench::leak_rays(mesh, bench::LeakTarget::vertices, 64 * 500, 9);
    std::size_t cones = 0;
    for (std::size_t first = 0; first < rays.size(); first += 64) {
      Vec3 least(1e30F), most(-1e30F);
      for (std::size_t i = first; i < first + 64; i++) {
        least = glm::min(least, direction_of(rays[i]));
        most = glm::max(most, direction_of(rays[i]));
      }
      // As kernels/bvh/packet_query.cl wants it: along one axis all go the same way, and none much more sideways.
      for (int axis = 0; axis < 3; axis++) {
        const float reach = std::max({least[axis], -most[axis], 0.0F});
        const Vec3 across = glm::max(glm::abs(least), glm::abs(most));
        if (std::max(across[(axis + 1) % 3], across[(axis + 2) % 3]) > 2 * reach) continue;
        cones++;
        break;
      }
    }
    INFO(mesh.name << ": " << cones << " of 500");
    CHECK(cones > 400);
  }
}

TEST_CASE("leaks are rays that hit nothing, counted for each mesh, target and tracer") {
  bench::Tracers tracers;
  tracers.push_back(std::make_unique<test::FakeTracer>("tight", "single"));
  auto leaky = std::make_unique<test::FakeTracer>("leaky", "single");
  leaky->wrong = 5;
  tracers.push_back(std::move(leaky));
  std::vector<bench::LeakResult> results;
  bench::run_leaks(tracers, 2, 128, results);
  REQUIRE(results.size() == 4 * 2 * 2);
  for (const bench::LeakResult& result : results) {
    CHECK(result.rays == 128);
    CHECK(result.closest_hit_leaks == (result.tracer == "leaky/single" ? 5 : 0));
    CHECK(result.any_hit_leaks == (result.tracer == "leaky/single" ? 5 : 0));
  }
  CHECK(results[0].mesh == "sphere");
  CHECK(results[0].target == "edges");
  CHECK(results[2].target == "vertices");
}

}  // namespace hemiray

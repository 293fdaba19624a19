// Rays in packets, and sorted rays, against the same rays one by one.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/bvh/double_oracle.hpp"
#include "tests/bvh/query_bench.hpp"

namespace hemiray {
namespace {

using test::Hits;
using test::kMiss;
using test::make_ray;
using test::Places;
using test::Rays;

constexpr std::size_t kPacket = 64;  // rays from one point; what the profile's packets hold, or a multiple
// With the fast triangle test packets round otherwise than single rays: what both hit lies this near to each other, in
// units of max(1, t). A few ulps of coordinates of 2, for grazing rays over the least sine at which they meet a
// surface, 1e-3.
constexpr double kDistance = 4e-6;
constexpr double kGrazingDistance = 1e-3;
// Share of rays aimed at edges, give or take 3 ulps, that such a packet may see on the other side of it.
constexpr double kFastSlipsAtEdges = 0.04;

FlatScene mixed_scene() {
  FlatScene flat = test::soup(400, 60, 0.3F, 50);
  test::add_plane(flat, {0, -1.5F, 0}, {0, 1, 0});
  test::add_plane(flat, {0, 0, -1.8F}, glm::normalize(Vec3(0.2F, 0.1F, 1)));
  return flat;
}

// Packets' worth of rays: `direction` says where the next one goes, given its origin.
template <typename Origin, typename Direction>
Rays packets_of(std::size_t count, const Origin& next_origin, const Direction& direction) {
  Rays rays;
  while (rays.size() < count) {
    const Vec3 origin = next_origin();
    for (std::size_t i = 0; i < kPacket; i++) rays.push_back(make_ray(origin, direction(origin)));
  }
  return rays;
}

// Cones of about 20 degrees.
Rays random_cones(std::size_t count, std::uint32_t seed) {
  Places places(seed);
  Vec3 axis;
  const auto origin = [&] {
    const Vec3 from = places.in_cube(2.0F);
    axis = glm::normalize(places.in_cube(0.7F) - from);
    return from;
  };
  return packets_of(count, origin, [&](Vec3) { return axis + places.in_cube(0.3F); });
}

Vec3 on_edge(const FlatScene& flat, std::uint32_t triangle, Places& places) {
  const shared::uint4 t = flat.triangles[triangle];
  const Vec3 a = test::vertex(flat, t.x), b = test::vertex(flat, t.y);
  return places.below(3) == 0 ? a : a + places.in(0.0F, 1.0F) * (b - a);
}

// At edges and vertices of triangles that lie about the same way. From outside at the middle of the scene, give or take
// 3 ulps; or from within `inside` of the middle of a closed mesh to anywhere, and nowhere but at edges and vertices.
Rays cones_at_edges(const FlatScene& flat, std::size_t count, std::uint32_t seed, Vec3 middle = Vec3(0.0F),
                    float inside = 0.0F) {
  Places places(seed);
  Vec3 axis;
  const auto origin = [&] {
    const Vec3 from = places.in_cube(inside > 0 ? inside : 2.0F);
    axis = inside > 0 ? places.direction() : glm::normalize(-from);
    return middle + from;
  };
  return packets_of(count, origin, [&](Vec3 from) {
    for (;;) {
      const auto triangle = places.below(static_cast<std::uint32_t>(flat.triangles.size()));
      const Vec3 target = on_edge(flat, triangle, places);
      const Vec3 direction = (inside > 0 ? target : test::moved_by_ulps(target, places)) - from;
      if (glm::dot(glm::normalize(direction), axis) > 0.9F) return direction;
    }
  });
}

// Along the surface of a triangle, a thousandth of its size above or below.
Rays grazing_cones(const FlatScene& flat, std::size_t count, std::uint32_t seed) {
  Places places(seed);
  Vec3 a, b, c, normal;
  const auto origin = [&] {
    const shared::uint4 t = flat.triangles[places.below(static_cast<std::uint32_t>(flat.triangles.size()))];
    a = test::vertex(flat, t.x), b = test::vertex(flat, t.y), c = test::vertex(flat, t.z);
    normal = glm::normalize(glm::cross(b - a, c - a));
    return a - 3.0F * (0.5F * (b + c) - a) + 1e-3F * normal;
  };
  return packets_of(count, origin, [&](Vec3 from) {
    const float u = places.in(0.0F, 1.0F), v = places.in(0.0F, 1.0F - u);
    return a + u * (b - a) + v * (c - a) + places.in(-1e-3F, 1e-3F) * normal - from;
  });
}

struct Difference {
  std::size_t slips = 0;  // hit by one, missed by the other
  std::size_t other = 0;  // another primitive
  double distance = 0.0;  // most of the same primitive, over max(1, t)
};

Difference difference(const Hits& packets, const Hits& single) {
  REQUIRE(packets.size() == single.size());
  Difference d;
  for (std::size_t i = 0; i < single.size(); i++) {
    const bool hit = packets[i].primitive != kMiss, expected = single[i].primitive != kMiss;
    if (hit != expected) d.slips++;
    if (!hit || !expected) continue;
    if (packets[i].primitive != single[i].primitive) {
      d.other++;
      continue;
    }
    const double t = single[i].t;
    d.distance = std::max(d.distance, std::abs(static_cast<double>(packets[i].t) - t) / std::max(1.0, t));
  }
  return d;
}

enum class Aim { anywhere, at_edges, along_surfaces };

// To the bit with the watertight test, within bounds with the fast one.
void check_packets(const FlatScene& flat, const Rays& rays, Aim aim) {
  test::TreeWorkshop workshop;
  bool strict = true;  // for the first tree
  for (const test::TreeKind& kind : test::tree_kinds()) {
    if (kind.options.explicit_vectors == 0) continue;  // no packets there
    test::QueryBench bench(workshop, flat, kind.options, strict);
    RayQueries packets(workshop.context, bench.tree.scene, bench.tree.accel, strict, RayGrouping::packets);
    strict = false;
    const Hits hits = packets.intersect(rays), single = bench.queries.intersect(rays);
    INFO(kind.name);
    CHECK(test::count_found(single) > rays.size() / 5);
    CHECK(test::count_disagreeing(hits, packets.occluded(rays)) == 0);
    if (kind.options.triangle_test == TriangleTest::watertight) {
      CHECK(test::count_different(rays, hits, single) == 0);
      continue;
    }
    const Difference d = difference(hits, single);
    INFO(d.slips << " slips, " << d.other << " other primitives of " << rays.size() << " rays, distance "
                 << d.distance);
    CHECK(d.distance <= (aim == Aim::along_surfaces ? kGrazingDistance : kDistance));
    const double share = aim == Aim::at_edges ? kFastSlipsAtEdges : 0.0;
    CHECK(static_cast<double>(d.slips + d.other) <= share * static_cast<double>(rays.size()));
  }
}

}  // namespace

TEST_CASE("packets find what single rays find") {
  const FlatScene flat = mixed_scene();
  check_packets(flat, random_cones(20032, 51), Aim::anywhere);
}

TEST_CASE("packets aimed at edges and vertices find what single rays find") {
  const FlatScene flat = mixed_scene();
  check_packets(flat, cones_at_edges(flat, 20032, 52), Aim::at_edges);
}

TEST_CASE("packets along surfaces find what single rays find") {
  const FlatScene flat = mixed_scene();
  check_packets(flat, grazing_cones(flat, 20032, 53), Aim::along_surfaces);
}

TEST_CASE("packets find what single rays find within bounded intervals") {
  const FlatScene flat = mixed_scene();
  Rays rays = random_cones(20032, 54);
  Places places(55);
  for (std::size_t i = 0; i < rays.size(); i++) {
    rays[i].origin.w = i % kPacket == 0 ? places.in(0.0F, 1.0F) : rays[i - 1].origin.w;
    rays[i].direction.w = i % 7 == 0 ? test::kForever : rays[i].origin.w + places.in(0.0F, 2.5F);
  }
  check_packets(flat, rays, Aim::anywhere);
}

TEST_CASE("packets say what the double precision oracle says wherever that is sure") {
  const FlatScene flat = mixed_scene();
  test::TreeWorkshop workshop;
  Rays rays = cones_at_edges(flat, 10048, 56);
  const Rays more = random_cones(10048, 57);
  rays.insert(rays.end(), more.begin(), more.end());
  for (const std::size_t k : {0U, 1U}) {  // both triangle tests
    const test::TreeKind& kind = test::tree_kinds()[k];
    const test::BuiltTree tree(workshop, flat, kind.options);
    RayQueries packets(workshop.context, tree.scene, tree.accel, false, RayGrouping::packets);
    const Hits hits = packets.intersect(rays);
    const std::vector<std::uint32_t> occluded = packets.occluded(rays);
    std::size_t sure = 0;
    for (std::size_t i = 0; i < rays.size(); i++) {
      const test::OracleVerdict verdict = test::judge_hit(flat, rays[i], hits[i], occluded[i] != 0);
      INFO(kind.name << ", ray " << i << ": " << verdict.objection);
      if (!verdict.objection.empty()) REQUIRE(verdict.objection.empty());
      sure += verdict.sure ? 1 : 0;
    }
    CHECK(sure > rays.size() / 2);
  }
}

TEST_CASE("equal distances in a packet go to the smaller primitive") {
  test::TreeWorkshop workshop;
  FlatScene flat = test::soup(300, 0, 0.3F, 64);
  flat.triangles.insert(flat.triangles.end(), flat.triangles.begin(), flat.triangles.end());
  flat.triangle_objects.resize(flat.triangles.size(), 0);
  const Rays rays = random_cones(10048, 65);
  for (const test::TreeKind& kind : test::tree_kinds()) {
    const test::BuiltTree tree(workshop, flat, kind.options);
    RayQueries packets(workshop.context, tree.scene, tree.accel, false, RayGrouping::packets);
    const Hits hits = packets.intersect(rays);
    INFO(kind.name);
    CHECK(test::count_found(hits) > rays.size() / 4);
    CHECK(std::count_if(hits.begin(), hits.end(),
                        [](const auto& hit) { return hit.primitive != kMiss && hit.primitive >= 300; }) == 0);
  }
}

TEST_CASE("packets of rays all around a point, and of several points, find what single rays find") {
  const FlatScene flat = mixed_scene();
  Rays all_around = random_cones(1024, 58);
  Places places(59);
  for (shared::QueryRay& ray : all_around) {
    const Vec3 d = places.direction();
    ray.direction = {d.x, d.y, d.z, test::kForever};
  }
  Rays ragged = random_cones(1024, 60);
  ragged.resize(1024 - 21);               // the last packet is not full
  for (std::size_t i = 0; i < 10; i++) {  // nor may one ray of ten start elsewhere
    ragged[i * kPacket + places.below(60)].origin.x += 1e-3F;
  }
  check_packets(flat, all_around, Aim::anywhere);
  check_packets(flat, ragged, Aim::anywhere);
}

TEST_CASE("no packet leaks out of a closed mesh through edges and vertices") {
  test::TreeWorkshop workshop;
  for (const bool round : {true, false}) {
    for (const float moved : {0.0F, 100.0F}) {
      const FlatScene mesh = test::closed_mesh(24, round, Vec3(moved));
      const Rays rays = cones_at_edges(mesh, 50048, 63, Vec3(moved), 0.4F);
      for (const test::TreeKind& kind : test::tree_kinds()) {
        if (kind.options.triangle_test != TriangleTest::watertight || kind.options.explicit_vectors == 0) continue;
        const test::BuiltTree tree(workshop, mesh, kind.options);
        RayQueries packets(workshop.context, tree.scene, tree.accel, false, RayGrouping::packets);
        const std::vector<std::uint32_t> occluded = packets.occluded(rays);
        INFO((round ? "ball" : "box") << " moved by " << moved << ", " << kind.name);
        CHECK(rays.size() - test::count_found(packets.intersect(rays)) == 0);
        CHECK(std::count(occluded.begin(), occluded.end(), 0U) == 0);
      }
    }
  }
}

// A component of +0 or -0, and the origin in the plane of one of the box's faces: rays run in the plane of the end of
// nodes' boxes, towards edges of that face.
TEST_CASE("packets along the planes of a box find what single rays find, any hit as the closest one") {
  const FlatScene mesh = test::closed_mesh(6, false, Vec3(0.0F));
  float half = 0.0F;
  for (const float p : mesh.positions) half = std::max(half, p);
  Places places(64);
  int axis = 0;
  float side = half, zero = 0.0F;
  const auto origin = [&] {
    axis = static_cast<int>(places.below(3));
    side = places.below(2) == 0 ? half : -half;
    zero = places.below(2) == 0 ? 0.0F : -0.0F;
    Vec3 from = glm::normalize(places.in_cube(1.0F)) * (4.0F * half);
    from[axis] = side;
    return from;
  };
  const Rays rays = packets_of(20032, origin, [&](Vec3 from) {
    Vec3 direction = places.in_cube(1.5F * half) - from;
    direction[axis] = zero;
    return direction;
  });
  test::TreeWorkshop workshop;
  for (const test::TreeKind& kind : test::tree_kinds()) {
    if (kind.options.triangle_test != TriangleTest::watertight || kind.options.explicit_vectors == 0) continue;
    test::QueryBench bench(workshop, mesh, kind.options, false);
    RayQueries packets(workshop.context, bench.tree.scene, bench.tree.accel, false, RayGrouping::packets);
    const Hits hits = packets.intersect(rays), single = bench.queries.intersect(rays);
    INFO(kind.name);
    CHECK(test::count_found(single) > rays.size() / 5);
    CHECK(test::count_disagreeing(hits, packets.occluded(rays)) == 0);
    std::size_t other = 0;  // u and v on an edge are zeros of either sign
    for (std::size_t i = 0; i < rays.size(); i++) {
      other += hits[i].primitive != single[i].primitive || hits[i].t != single[i].t || hits[i].u != single[i].u ||
               hits[i].v != single[i].v;
    }
    CHECK(other == 0);
  }
}

TEST_CASE("sorted rays find to the bit what they find in their own order") {
  const FlatScene flat = mixed_scene();
  test::TreeWorkshop workshop;
  std::vector<test::TreeKind> kinds = test::tree_kinds();
  for (const AccelKind kind : {AccelKind::octree, AccelKind::kdtree, AccelKind::kdtree_median}) {
    AccelOptions options;
    options.kind = kind;
    kinds.push_back({"a tree of cells", options});
  }
  Rays rays = test::random_rays(20001, 61);
  const Rays aimed = test::aimed_rays(flat, 5000, 62);
  rays.insert(rays.end(), aimed.begin(), aimed.end());
  rays.push_back(make_ray({1e20F, 0, 0}, {-1, 0, 0}));  // far outside the cells that origins are sorted by
  for (const test::TreeKind& kind : kinds) {
    INFO(kind.name);
    test::QueryBench bench(workshop, flat, kind.options);
    RayQueries sorted(workshop.context, bench.tree.scene, bench.tree.accel, true, RayGrouping::sorted);
    const Hits hits = bench.queries.intersect(rays);
    CHECK(test::count_found(hits) > rays.size() / 4);
    CHECK(test::count_different(rays, sorted.intersect(rays), hits) == 0);
    CHECK(sorted.occluded(rays) == bench.queries.occluded(rays));
    const Rays one = {rays[0]};
    CHECK(test::count_different(one, sorted.intersect(one), {hits[0]}) == 0);
    CHECK(sorted.intersect({}).empty());
  }
}

}  // namespace hemiray

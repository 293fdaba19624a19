// Instances: what shared trees answer is what copies in the world answer, nothing leaks, and many copies take the
// memory of one.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>
#include <vector>

#include "host/base/error.hpp"
#include "host/bvh/accel_memory.hpp"
#include "host/bvh/nearest_queries.hpp"
#include "tests/bvh/instanced_scenes.hpp"

namespace hemiray {
namespace {

using test::add_mesh;
using test::add_object;
using test::InstancedTree;
using test::kMiss;
using test::make_ray;
using test::mesh_of;
using test::Places;
using test::random_turn;
using test::Rays;

constexpr double kHalfUlp = 0x1p-24;
// What a ray's way into an object, the hit there and the copy's own rounding may move a hit, in half ulps of the
// coordinates at hand times |L| |L^-1|: a dozen roundings.
constexpr double kRoundings = 12.0;
// Share of random rays that pass an edge within rounding: the other side of it, or nothing, is an answer too. A few
// times what was seen.
constexpr double kAtEdges = 2e-4;

// Balls and soups, some turned, stretched or mirrored, some alone in the world; a sphere and a plane.
Scene mixed_scene(std::uint32_t copies, DVec3 place, std::uint32_t seed) {
  Scene scene;
  const std::uint32_t ball = add_mesh(scene, mesh_of(test::closed_mesh(5, true, Vec3(0.0F))));
  const std::uint32_t soup = add_mesh(scene, mesh_of(test::soup(60, 0, 0.6F, seed)));
  Places places(seed + 1);
  for (std::uint32_t i = 0; i < copies; i++) {
    const DVec3 scale = 0.2 * DVec3(places.in(0.5F, 2.0F), places.in(0.5F, 2.0F), places.in(0.5F, 2.0F));
    const DVec3 mirror(i % 3 == 1 ? -1.0 : 1.0, 1.0, 1.0);
    add_object(scene, i % 2 == 0 ? ball : soup,
               random_turn(places, place + DVec3(places.in_cube(1.0F)), scale * mirror));
  }
  Sphere sphere;
  sphere.center = place;
  sphere.radius = 0.3;
  scene.spheres.push_back(sphere);
  Plane plane;
  plane.point = place - DVec3(0.0, 1.5, 0.0);
  scene.planes.push_back(plane);
  return scene;
}

Rays moved(Rays rays, Vec3 by) {
  for (shared::QueryRay& ray : rays) {
    ray.origin.x += by.x;
    ray.origin.y += by.y;
    ray.origin.z += by.z;
  }
  return rays;
}

struct Comparison {
  std::size_t found = 0;   // by both
  std::size_t others = 0;  // one missed, or another primitive
  double worst = 0.0;      // distance of a hit from its triangle, and of its barycentric point from it, over the bound
};

// Hits of instances against those of copies, with the distance to the copies' triangles as the measure.
Comparison compare(const Rays& rays, const FlatScene& instanced, const test::Hits& hits, const FlatScene& copied,
                   const test::Hits& expected, double growth) {
  Comparison result;
  std::unordered_map<std::uint32_t, test::PrimitiveName> names, names_of_copies;
  const auto named = [](auto& known, const FlatScene& flat, std::uint32_t id) {
    const auto [found, is_new] = known.try_emplace(id);
    if (is_new) found->second = test::name_of(flat, id);
    return found->second;
  };
  for (std::size_t i = 0; i < rays.size(); i++) {
    const std::uint32_t id = hits[i].primitive, copy = expected[i].primitive;
    if (id == kMiss && copy == kMiss) continue;
    if (id == kMiss || copy == kMiss || named(names, instanced, id) != named(names_of_copies, copied, copy)) {
      result.others++;
      continue;
    }
    result.found++;
    if (copy >= copied.triangles.size()) continue;
    const shared::uint4 t = copied.triangles[copy];
    const DVec3 a = test::vertex(copied, t.x), b = test::vertex(copied, t.y), c = test::vertex(copied, t.z);
    const DVec3 o(rays[i].origin.x, rays[i].origin.y, rays[i].origin.z);
    const DVec3 d(rays[i].direction.x, rays[i].direction.y, rays[i].direction.z);
    const DVec3 p = o + static_cast<double>(hits[i].t) * d, n = glm::normalize(glm::cross(b - a, c - a));
    const double u = hits[i].u, v = hits[i].v;
    const double slant = std::abs(glm::dot(n, d)) / glm::length(d);
    const double size = std::max({glm::length(a), glm::length(b), glm::length(c), glm::length(o), glm::length(p)});
    const double bound = kRoundings * kHalfUlp * growth * size;
    result.worst = std::max(result.worst, std::abs(glm::dot(p - a, n)) / bound);
    result.worst = std::max(result.worst, glm::length(a + u * (b - a) + v * (c - a) - p) * slant / (2.0 * bound));
  }
  return result;
}

void check_as_copies(test::TreeWorkshop& workshop, const Scene& scene, const Rays& rays, double at_edges,
                     const std::vector<test::TreeKind>& kinds) {
  const FlatScene instanced = flatten_scene(scene, Instancing::always), copied = flatten_scene(scene);
  REQUIRE(instanced.instances.size() == scene.objects.size());
  constexpr double kGrowth = 8.0;  // scales from 1/2 to 2
  for (const test::TreeKind& kind : kinds) {
    INFO(kind.name);
    const InstancedTree tree(workshop, instanced, kind.options), tree_of_copies(workshop, copied, kind.options);
    RayQueries queries(workshop.context, tree.scene, tree.accel, true);
    RayQueries queries_of_copies(workshop.context, tree_of_copies.scene, tree_of_copies.accel, true);
    const test::Hits hits = queries.intersect(rays), expected = queries_of_copies.intersect(rays);
    const Comparison result = compare(rays, instanced, hits, copied, expected, kGrowth);
    CHECK(static_cast<double>(result.others) <= at_edges * static_cast<double>(rays.size()));
    CHECK(result.worst <= 1.0);
    CHECK(result.found > rays.size() / 4);
    CHECK(test::count_disagreeing(hits, queries.occluded(rays)) == 0);
  }
}

std::vector<test::TreeKind> watertight_kinds() {
  std::vector<test::TreeKind> kinds = test::tree_kinds();
  std::erase_if(kinds, [](const test::TreeKind& k) { return k.options.triangle_test != TriangleTest::watertight; });
  return kinds;
}

}  // namespace

TEST_CASE("instances answer rays as copies do, in every tree") {
  test::TreeWorkshop workshop;
  const Scene scene = mixed_scene(40, DVec3(0.0), 1);
  check_as_copies(workshop, scene, test::random_rays(20000, 2), kAtEdges, test::tree_kinds());
  check_as_copies(workshop, scene, test::random_rays(100000, 3), kAtEdges, {test::tree_kinds().front()});
}

TEST_CASE("instances answer rays as copies do: one, two, a thousand, and far from the origin") {
  test::TreeWorkshop workshop;
  const std::vector<test::TreeKind> first = {test::tree_kinds().front()};
  for (const std::uint32_t copies : {1U, 2U, 1000U}) {
    check_as_copies(workshop, mixed_scene(copies, DVec3(0.0), 4), test::random_rays(20000, 5), kAtEdges, first);
  }
  // There a float's own steps are a thousandth of the balls' size: so many rays pass an edge within rounding.
  const Vec3 far(1e4F, -2e4F, 1.5e4F);
  check_as_copies(workshop, mixed_scene(30, DVec3(far), 6), moved(test::random_rays(20000, 7), far), 0.1, first);
}

TEST_CASE("instances answer rays as copies do: aimed at edges and vertices") {
  test::TreeWorkshop workshop;
  Scene scene;
  const std::uint32_t ball = add_mesh(scene, mesh_of(test::closed_mesh(5, true, Vec3(0.0F))));
  Places places(8);
  for (int i = 0; i < 12; i++) {
    const DVec3 scale(i % 3 == 1 ? -0.3 : 0.3, places.in(0.2F, 0.5F), 0.4);
    add_object(scene, ball, random_turn(places, DVec3(places.in_cube(1.0F)), scale));
  }
  const FlatScene copied = flatten_scene(scene);
  const Rays rays = test::aimed_rays(copied, 60000, 9);
  const FlatScene instanced = flatten_scene(scene, Instancing::always);
  const InstancedTree tree(workshop, instanced), tree_of_copies(workshop, copied);
  RayQueries queries(workshop.context, tree.scene, tree.accel, true);
  RayQueries queries_of_copies(workshop.context, tree_of_copies.scene, tree_of_copies.accel, true);
  const test::Hits hits = queries.intersect(rays), expected = queries_of_copies.intersect(rays);
  CHECK(compare(rays, instanced, hits, copied, expected, 8.0).worst <= 1.0);
  // Whichever of the triangles at an edge or vertex it is, and but for silhouettes, the distance is the same.
  std::size_t differ = 0;
  for (std::size_t i = 0; i < rays.size(); i++) {
    const bool both_miss = hits[i].primitive == kMiss && expected[i].primitive == kMiss;
    differ += both_miss || std::abs(hits[i].t - expected[i].t) <= 1e-4F * expected[i].t ? 0 : 1;
  }
  INFO(differ << " differ");
  CHECK(static_cast<double>(differ) < 0.1 * static_cast<double>(rays.size()));
}

TEST_CASE("no ray leaves a closed mesh that is an instance, turned, stretched and far away") {
  test::TreeWorkshop workshop;
  const FlatScene mesh = test::closed_mesh(24, true, Vec3(0.0F)), box = test::closed_mesh(24, false, Vec3(0.0F));
  Places places(10);
  for (const FlatScene* shape : {&mesh, &box}) {
    for (const double far : {0.0, 100.0, 1e4}) {
      for (const double mirror : {1.0, -1.0}) {
        Scene scene;
        const DMat4 to_world = random_turn(places, DVec3(far, -far, far), DVec3(2.0 * mirror, 1.0, 0.5));
        add_object(scene, add_mesh(scene, mesh_of(*shape)), to_world);
        Rays rays = test::rays_from_inside(*shape, 20000, 11);
        for (shared::QueryRay& ray : rays) {
          const DVec3 o(ray.origin.x, ray.origin.y, ray.origin.z);
          const DVec3 d(ray.direction.x, ray.direction.y, ray.direction.z);
          ray = make_ray(Vec3(to_world * glm::dvec4(o, 1.0)), Vec3(glm::dmat3(to_world) * d));
        }
        const InstancedTree tree(workshop, flatten_scene(scene, Instancing::always));
        for (const bool strict : {true, false}) {
          RayQueries queries(workshop.context, tree.scene, tree.accel, strict);
          const test::Hits hits = queries.intersect(rays);
          const std::vector<std::uint32_t> occluded = queries.occluded(rays);
          INFO("moved by " << far << (strict ? ", strict" : ""));
          CHECK(rays.size() - test::count_found(hits) == 0);
          CHECK(std::count(occluded.begin(), occluded.end(), 0U) == 0);
        }
      }
    }
  }
}

TEST_CASE("packets meet instances as single rays do") {
  test::TreeWorkshop workshop;
  const Scene scene = mixed_scene(60, DVec3(0.0), 12);
  const FlatScene flat = flatten_scene(scene, Instancing::always);
  Rays rays;
  Places places(13);
  for (int eye = 0; eye < 20; eye++) {
    const Vec3 origin = 3.0F * places.direction();
    for (int i = 0; i < 512; i++) {
      const Vec3 target(static_cast<float>(i % 32) / 16.0F - 1.0F, static_cast<float>(i / 32) / 8.0F - 1.0F, 0.0F);
      rays.push_back(make_ray(origin, target - origin, 0.0F, i % 5 == 0 ? 1.0F : test::kForever));
    }
  }
  for (const test::TreeKind& kind : test::tree_kinds()) {
    if (kind.options.leaf_lanes == 1) continue;  // there are no packets
    INFO(kind.name);
    const InstancedTree tree(workshop, flat, kind.options);
    RayQueries single(workshop.context, tree.scene, tree.accel);
    RayQueries packets(workshop.context, tree.scene, tree.accel, false, RayGrouping::packets);
    const test::Hits expected = single.intersect(rays), hits = packets.intersect(rays);
    std::size_t differ = 0;
    for (std::size_t i = 0; i < rays.size(); i++) {
      const bool same = hits[i].primitive == expected[i].primitive &&
                        (hits[i].primitive == kMiss || std::abs(hits[i].t - expected[i].t) <= 1e-5F);
      differ += same ? 0 : 1;
    }
    CHECK(static_cast<double>(differ) <= 5e-4 * static_cast<double>(rays.size()));  // at edges
    CHECK(test::count_found(hits) > rays.size() / 4);
    const std::vector<std::uint32_t> any = packets.occluded(rays), any_expected = single.occluded(rays);
    std::size_t other = 0;
    for (std::size_t i = 0; i < rays.size(); i++) other += any[i] == any_expected[i] ? 0 : 1;
    CHECK(static_cast<double>(other) <= 5e-4 * static_cast<double>(rays.size()));
  }
}

TEST_CASE("instances in the same place: equal distances go to the first") {
  test::TreeWorkshop workshop;
  Scene scene;
  const std::uint32_t ball = add_mesh(scene, mesh_of(test::closed_mesh(4, true, Vec3(0.0F))));
  Places places(14);
  const DMat4 to_world = random_turn(places, DVec3(0.1, 0.2, 0.3), DVec3(0.7, -1.0, 1.2));
  for (int i = 0; i < 9; i++) add_object(scene, ball, to_world);
  const FlatScene flat = flatten_scene(scene, Instancing::always);
  const InstancedTree tree(workshop, flat);
  RayQueries queries(workshop.context, tree.scene, tree.accel, true);
  std::size_t found = 0;
  for (const shared::QueryHit& hit : queries.intersect(test::random_rays(5000, 15))) {
    if (hit.primitive == kMiss) continue;
    found++;
    REQUIRE(hit.primitive < flat.instances.front().triangle_count);
  }
  CHECK(found > 2000);
}

TEST_CASE("ten thousand copies take the memory of one tree, as predicted") {
  Scene scene;
  const std::uint32_t ball = add_mesh(scene, mesh_of(test::closed_mesh(40, true, Vec3(0.0F))));  // 19,200 triangles
  Places places(16);
  for (int i = 0; i < 10000; i++) {
    add_object(scene, ball, random_turn(places, DVec3(places.in_cube(30.0F)), DVec3(places.in(0.3F, 1.0F))));
  }
  const FlatScene flat = flatten_scene(scene, Instancing::automatic);
  REQUIRE(flat.instances.size() == 10000);
  REQUIRE(flat.triangles.size() == 19200);
  Context context(choose_device(""));
  const DeviceScene device_scene(context, flat, HR_FEATURE_TRIANGLES | HR_FEATURE_INSTANCES);
  const std::uint64_t before = context.allocated_bytes();
  Parallel parallel(context);
  AccelBuilder builder(context, parallel);
  const Accel accel(builder, device_scene);
  const auto kept = static_cast<double>(context.allocated_bytes() - before);
  const auto peak = static_cast<double>(context.peak_bytes() - before);
  const AccelMemory predicted = predict_accel_bytes(flat, {}, context.profile());
  INFO("kept " << kept << ", predicted " << predicted.tree << "; peak " << peak << ", predicted " << predicted.peak);
  CHECK(kept == Approx(static_cast<double>(predicted.tree)).epsilon(0.25));
  CHECK(peak == Approx(static_cast<double>(predicted.peak)).epsilon(0.25));
  // The mesh's tree, and 10,000 leaves of the tree over them.
  CHECK(predicted.tree < predict_accel_bytes(19200 + 10000, {}, context.profile()).tree * 3 / 2);
  CHECK(predict_accel_bytes(192000000, {}, context.profile()).tree > 1000 * predicted.tree);
  CHECK(accel.statistics().instances == 10000);
  CHECK(accel.statistics().primitives == 19200);
}

TEST_CASE("a refitted tree of moved shared meshes answers as a rebuilt one") {
  test::TreeWorkshop workshop;
  const FlatScene flat = flatten_scene(mixed_scene(40, DVec3(0.0), 17), Instancing::always);
  FlatScene moved_flat = flat;
  Places places(18);
  for (float& x : moved_flat.positions) x += places.in(-0.3F, 0.3F);
  const Rays rays = test::random_rays(20000, 19);
  for (const test::TreeKind& kind : watertight_kinds()) {
    INFO(kind.name);
    InstancedTree tree(workshop, flat, kind.options);
    const DeviceScene scene(workshop.context, moved_flat, test::kAllPrimitives | HR_FEATURE_INSTANCES);
    RayQueries queries(workshop.context, scene, tree.accel, true);
    const test::Hits before = queries.intersect(rays);
    tree.accel.refit(scene);
    const test::Hits hits = queries.intersect(rays);
    const InstancedTree rebuilt(workshop, moved_flat, kind.options);
    RayQueries expected(workshop.context, rebuilt.scene, rebuilt.accel, true);
    CHECK(test::count_different(rays, hits, expected.intersect(rays)) == 0);
    CHECK(test::count_disagreeing(hits, queries.occluded(rays)) == 0);
    CHECK(test::count_different(rays, hits, before) > rays.size() / 4);
  }
}

TEST_CASE("instances of meshes without a valid triangle, and of nothing, are met by no ray") {
  test::TreeWorkshop workshop;
  Scene scene;
  Mesh mesh = mesh_of(test::closed_mesh(3, true, Vec3(0.0F)));
  const std::uint32_t good = add_mesh(scene, mesh);
  for (Vec3& p : mesh.positions) p.x = std::nanf("");
  const std::uint32_t bad = add_mesh(scene, mesh);
  add_object(scene, bad, DMat4(1.0));
  const Rays rays = test::random_rays(5000, 20);
  const FlatScene nothing = flatten_scene(scene, Instancing::always);
  InstancedTree empty(workshop, nothing);
  RayQueries none(workshop.context, empty.scene, empty.accel);
  CHECK(test::count_found(none.intersect(rays)) == 0);
  CHECK(empty.accel.statistics().instances == 0);
  CHECK_NOTHROW(empty.accel.refit(empty.scene));
  add_object(scene, good, glm::scale(DMat4(1.0), DVec3(0.5)));
  const FlatScene flat = flatten_scene(scene, Instancing::always);
  const InstancedTree tree(workshop, flat);
  RayQueries queries(workshop.context, tree.scene, tree.accel);
  CHECK(tree.accel.statistics().instances == 1);
  std::size_t found = 0;
  for (const shared::QueryHit& hit : queries.intersect(rays)) {
    if (hit.primitive == kMiss) continue;
    found++;
    REQUIRE(test::name_of(flat, hit.primitive).first == 1);
  }
  CHECK(found > 500);
}

TEST_CASE("what cannot hold instances refuses them") {
  test::TreeWorkshop workshop;
  const FlatScene flat = flatten_scene(mixed_scene(3, DVec3(0.0), 21), Instancing::always);
  CHECK_THROWS_AS(DeviceScene(workshop.context, flat, test::kAllPrimitives), std::logic_error);
  const InstancedTree tree(workshop, flat);
  CHECK_THROWS_AS(NearestQueries(workshop.context, tree.scene, tree.accel), InputError);
  AccelOptions cells;
  cells.kind = AccelKind::kdtree;
  CHECK_THROWS_AS(InstancedTree(workshop, flat, cells), InputError);
}

}  // namespace hemiray

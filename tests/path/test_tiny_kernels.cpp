// Every kernel at least once on inputs of a few items: what tools/run_oclgrind.sh runs on a simulator that watches each
// memory access, and is about a thousand times slower than a device.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "host/bvh/leaving_rays.hpp"
#include "host/bvh/nearest_queries.hpp"
#include "host/bvh/ray_queries.hpp"
#include "host/bvh/visit_counts.hpp"
#include "host/path/render.hpp"
#include "tests/bvh/double_oracle.hpp"
#include "tests/bvh/instanced_scenes.hpp"
#include "tests/path/render_on_device.hpp"
#include "tests/reference/scene_builder.hpp"

namespace hemiray {
namespace {

using Rays = std::vector<shared::QueryRay>;

constexpr std::uint32_t kRays = 12;

Rays rays_through(std::uint32_t seed) {
  test::Places places(seed);
  Rays rays;
  for (std::uint32_t i = 0; i < kRays; i++) {
    const Vec3 from = 3.0F * places.direction(), to = places.in_cube(0.8F) - from;
    rays.push_back({{from.x, from.y, from.z, 0.0F}, {to.x, to.y, to.z, std::numeric_limits<float>::infinity()}});
  }
  return rays;
}

void check_rays(const FlatScene& flat, RayQueries& queries, const Rays& rays) {
  const std::vector<shared::QueryHit> hits = queries.intersect(rays);
  const std::vector<std::uint32_t> occluded = queries.occluded(rays);
  std::size_t sure = 0, found = 0;
  for (std::size_t i = 0; i < rays.size(); i++) {
    const test::OracleVerdict verdict = test::judge_hit(flat, rays[i], hits[i], occluded[i] != 0);
    INFO("ray " << i);
    CHECK(verdict.objection == std::string());
    sure += verdict.sure ? 1 : 0;
    found += hits[i].primitive != HR_NO_PRIMITIVE ? 1 : 0;
  }
  CHECK(sure >= rays.size() * 3 / 4);
  CHECK(found >= rays.size() / 4);
}

// Everything needed to ask a scene's tree.
struct TinyTree {
  TinyTree(const FlatScene& flat, const AccelOptions& options, std::uint32_t tree_chunk_kib = 0)
      : context(choose_device(""), profile(tree_chunk_kib)), scene(context, flat, test::kAllPrimitives) {
    accel.emplace(builder, scene, options);
  }
  static DeviceProfile profile(std::uint32_t tree_chunk_kib) {
    DeviceProfile profile = profile_for(choose_device(""));
    profile.packet_groups = 1;
    profile.tree_chunk_kib = tree_chunk_kib;
    return profile;
  }
  Context context;
  Parallel parallel{context};
  AccelBuilder builder{context, parallel};
  DeviceScene scene;
  std::optional<Accel> accel;
};

void check_tree(const FlatScene& flat, const AccelOptions& options, std::uint32_t tree_chunk_kib = 0) {
  INFO("width " << options.width << ", lanes " << options.leaf_lanes << ", vectors " << options.explicit_vectors);
  TinyTree tree(flat, options, tree_chunk_kib);
  if (tree_chunk_kib > 0) {
    REQUIRE(tree.accel->config().node_chunks.count > 1);
    REQUIRE(tree.accel->config().block_chunks.count > 1);
  }
  RayQueries queries(tree.context, tree.scene, *tree.accel);
  check_rays(flat, queries, rays_through(1));
  // A refit to the very places must change no answer.
  tree.accel->refit(tree.scene);
  check_rays(flat, queries, rays_through(2));
}

void check_grouping(const FlatScene& flat, const AccelOptions& options, RayGrouping grouping, const Rays& rays) {
  TinyTree tree(flat, options);
  RayQueries queries(tree.context, tree.scene, *tree.accel, false, grouping);
  check_rays(flat, queries, rays);
}

FlatScene soup_above_plane(std::uint32_t triangles, std::uint32_t spheres, float size) {
  FlatScene flat = test::soup(triangles, spheres, size, 3);
  test::add_plane(flat, {0, -1.5F, 0}, {0, 1, 0});
  return flat;
}
FlatScene smaller_soup() { return soup_above_plane(5, 1, 1.5F); }
FlatScene small_soup() { return soup_above_plane(14, 3, 0.8F); }

AccelOptions two_wide() {
  AccelOptions options;
  options.width = options.leaf_lanes = options.max_leaf = 2;
  options.explicit_vectors = 1;
  return options;
}

void check_cells(AccelKind kind) {
  AccelOptions options;
  options.kind = kind;
  check_grouping(smaller_soup(), options, RayGrouping::single, rays_through(5));
}

// Mirror, glass, texture, ambient light, a point light and a lamp: nearly all that a path can meet.
Scene small_room() {
  Scene scene = reference::empty_scene({0, 1, 3}, {0, 0.4, 0}, 50.0);
  scene.ambient = Vec3(0.1F);
  const auto checker = [](int x, int y) { return glm::u8vec3((x + y) % 2 == 0 ? 200 : 60); };
  Material floor = reference::diffuse(Vec3(0.7F));
  floor.kd_texture = reference::add_texture(scene, 4, ColorSpace::srgb, checker);
  floor.kr = Vec3(0.3F);
  reference::add_rectangle(scene, {-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, reference::add_material(scene, floor));
  reference::add_sphere(scene, {-0.5, 0.5, 0}, 0.5, reference::add_material(scene, reference::glass(1.5F)));
  reference::add_sphere(scene, {0.6, 0.4, -0.3}, 0.4, reference::add_material(scene, reference::mirror(0.8F)));
  reference::add_point_light(scene, {1, 3, 1}, Vec3(5.0F));
  reference::add_area_light(scene, {-0.5, 2.5, -0.5}, {1, 0, 0}, {0, 0, 1}, Vec3(4.0F));
  return scene;
}

}  // namespace

TEST_CASE("tiny: keys are scanned and sorted, by work-items and by work-groups") {
  const DeviceInfo device = choose_device("");
  for (const std::uint32_t groups : {0U, 3U}) {
    DeviceProfile profile = profile_for(device);
    profile.sort_groups = groups;
    profile.local_size = 4;  // tiles of 32 keys
    Context context(device, profile);
    Parallel parallel(context);
    INFO(groups << " work-groups");
    std::mt19937 random(1);
    std::vector<std::uint64_t> keys(137);
    for (std::size_t i = 0; i < keys.size(); i++) keys[i] = std::uint64_t{random() % 4096U} << 8U | i;
    Buffer<std::uint64_t> sorted(context, "keys", std::span<const std::uint64_t>(keys));
    Buffer<std::uint64_t> scratch(context, "scratch", keys.size());
    parallel.sort(sorted, scratch, static_cast<std::uint32_t>(keys.size()), 8, 12);
    std::vector<std::uint64_t> expected = keys;
    std::sort(expected.begin(), expected.end());
    CHECK(sorted.read(0, keys.size()) == expected);

    const std::vector<std::uint32_t> counts = {3, 0, 7, 1, 0, 2, 0};
    Buffer<std::uint32_t> sums(context, "sums", std::span<const std::uint32_t>(counts));
    parallel.exclusive_scan(sums, 6);
    CHECK(sums.read() == std::vector<std::uint32_t>{0, 3, 3, 10, 11, 11, 13});
  }
}

TEST_CASE("tiny: a tree whose nodes and blocks lie in chunks is built, traced and refitted") {
  AccelOptions options;
  options.width = options.max_leaf = 2;
  options.leaf_lanes = 1;  // two blocks a leaf
  check_tree(test::soup(40, 0, 0.6F, 4), options, 1);
}

TEST_CASE("tiny: trees of one, two and a few primitives answer rays") {
  for (const std::uint32_t triangles : {1U, 2U, 5U}) {
    FlatScene flat = test::empty_flat_scene();
    for (std::uint32_t i = 0; i < triangles; i++) {
      const float z = static_cast<float>(i) * 0.1F;
      test::add_triangle(flat, {-2, -2, z}, {2, -2, z}, {0, 3, z});
    }
    check_tree(flat, {});
  }
}

TEST_CASE("tiny: the quality tree with vectors, eight wide") {
  AccelOptions options;
  options.width = options.leaf_lanes = options.max_leaf = 8;
  options.explicit_vectors = 1;
  check_tree(small_soup(), options);
}

TEST_CASE("tiny: the fast tree without vectors, four wide, one primitive a leaf") {
  AccelOptions options;
  options.builder = TreeBuilder::fast;
  options.width = 4;
  options.leaf_lanes = options.max_leaf = 1;
  options.explicit_vectors = 0;
  check_tree(small_soup(), options);
}

TEST_CASE("tiny: the fast triangle test, two wide") {
  AccelOptions options = two_wide();
  options.triangle_test = TriangleTest::fast;
  check_tree(small_soup(), options);
}

TEST_CASE("tiny: packets of rays, whole and broken") {
  for (const TriangleTest triangle_test : {TriangleTest::watertight, TriangleTest::fast}) {
    AccelOptions options = two_wide();
    options.triangle_test = triangle_test;
    test::Places places(3);
    Rays rays;
    for (std::uint32_t i = 0; i < 20; i++) {  // 16 go together, then one of four starts elsewhere
      const Vec3 from(2.5F, 0.3F, i == 17 ? 0.5F : 0.1F), to = places.in_cube(0.6F) - from;
      rays.push_back({{from.x, from.y, from.z, 0.0F}, {to.x, to.y, to.z, std::numeric_limits<float>::infinity()}});
    }
    check_grouping(smaller_soup(), options, RayGrouping::packets, rays);
  }
}

TEST_CASE("tiny: sorted rays") { check_grouping(smaller_soup(), two_wide(), RayGrouping::sorted, rays_through(4)); }

TEST_CASE("tiny: an octree") { check_cells(AccelKind::octree); }
TEST_CASE("tiny: a kd-tree") { check_cells(AccelKind::kdtree); }
TEST_CASE("tiny: a median kd-tree") { check_cells(AccelKind::kdtree_median); }

TEST_CASE("tiny: instances of two meshes answer rays as their copies do") {
  Scene scene;
  test::Places places(5);
  const std::uint32_t meshes[] = {test::add_mesh(scene, test::mesh_of(test::soup(5, 0, 0.8F, 6))),
                                  test::add_mesh(scene, test::mesh_of(test::soup(9, 0, 0.8F, 7)))};
  for (int i = 0; i < 5; i++) {
    const DVec3 scale(i == 3 ? -0.5 : 0.5, 0.7, 0.6);
    test::add_object(scene, meshes[i % 2], test::random_turn(places, DVec3(places.in_cube(0.5F)), scale));
  }
  const FlatScene flat = flatten_scene(scene, Instancing::always), copies = flatten_scene(scene);
  Context context(choose_device(""));
  Parallel parallel(context);
  AccelBuilder builder(context, parallel, true);
  const DeviceScene device_scene(context, flat, HR_FEATURE_TRIANGLES | HR_FEATURE_INSTANCES);
  Accel accel(builder, device_scene);
  RayQueries queries(context, device_scene, accel);
  check_rays(copies, queries, rays_through(1));  // without other primitives the indices are the same
  accel.refit(device_scene);
  check_rays(copies, queries, rays_through(2));
}

TEST_CASE("tiny: nearest neighbours") {
  const FlatScene flat = test::soup(6, 2, 0.8F, 3);
  TinyTree tree(flat, two_wide());
  NearestQueries queries(tree.context, tree.scene, *tree.accel);
  test::Places places(7);
  std::vector<Vec3> points;
  for (int i = 0; i < 9; i++) points.push_back(places.in_cube(1.0F));
  PointTree cloud(tree.context, tree.builder, points, two_wide());
  for (int i = 0; i < 3; i++) {
    const Vec3 from = places.in_cube(1.5F);
    const std::vector<QueryPoint> query = {{from.x, from.y, from.z, std::numeric_limits<float>::infinity()}};
    const shared::float4 closest = queries.closest(query).points[0];
    CHECK(closest.w == Approx(glm::distance(from, Vec3(closest.x, closest.y, closest.z))));
    for (std::size_t v = 0; v < flat.positions.size(); v += 3) {
      const Vec3 vertex(flat.positions[v], flat.positions[v + 1], flat.positions[v + 2]);
      CHECK(closest.w <= 1.0001F * glm::distance(from, vertex));
    }
    std::vector<float> distances;
    for (const Vec3& point : points) distances.push_back(glm::distance(from, point));
    std::sort(distances.begin(), distances.end());
    const Neighbours found = cloud.nearest(query, 4);
    for (std::size_t k = 0; k < 4; k++) CHECK(found.distances[k] == Approx(distances[k]));
  }
}

TEST_CASE("tiny: both engines render a room") {
  ReferenceOptions options;
  options.width = options.height = 5;
  options.depth = 3;
  const Scene scene = small_room();
  const Image megakernel = render_on_device(scene, options, EngineKind::megakernel, true);
  for (const std::uint32_t tail_paths : {0U, 9U}) {
    const Image wavefront = render_on_device(scene, options, EngineKind::wavefront, true, tail_paths);
    for (const std::string layer : {"direct", "reflection", "refraction"}) {
      INFO(layer << ", a tail of " << tail_paths);
      double sum = 0.0;
      for (int y = 0; y < options.height; y++) {
        for (int x = 0; x < options.width; x++) {
          const double value = reference::value_at(wavefront, layer, x, y);
          CHECK(value == reference::value_at(megakernel, layer, x, y));
          sum += value;
        }
      }
      CHECK(sum > 0.0);
    }
  }
}

TEST_CASE("tiny: disks, cylinders, cones and quadrics are traced and rendered") {
  Scene scene = small_room();
  scene.spheres.clear();
  const auto add = [&scene](ShapeKind kind, DVec3 place) -> Shape& {
    Shape& shape = scene.shapes.emplace_back();
    shape.kind = kind;
    shape.to_world =
        DMat4(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, 0, -1, 0), glm::dvec4(0, 1, 0, 0), glm::dvec4(place, 1.0));
    shape.radius = shape.upper_radius = 0.4;
    shape.material = static_cast<std::uint32_t>(scene.shapes.size() % scene.materials.size());
    return shape;
  };
  add(ShapeKind::disk, {0, 0.6, -0.8});
  add(ShapeKind::cylinder, {-0.8, 0.5, 0});
  add(ShapeKind::cone, {0, 0.5, 0.2}).upper_radius = 0.1;
  Shape& bowl = add(ShapeKind::quadric, {0.8, 0.3, 0});
  bowl.coefficients = {1, 1, -0.5, 0, 0, 0, 0, 0, 0, -0.05};
  bowl.clip = Clip::box;
  bowl.clip_half = {0.5, 0.5, 0.4};
  ReferenceOptions options;
  options.width = options.height = 5;
  options.depth = 2;
  const Image megakernel = render_on_device(scene, options, EngineKind::megakernel, true);
  const Image wavefront = render_on_device(scene, options, EngineKind::wavefront, true, 0);
  double sum = 0.0;
  for (int i = 0; i < 25; i++) {
    const double value = reference::value_at(wavefront, "direct", i % 5, i / 5);
    CHECK(value == reference::value_at(megakernel, "direct", i % 5, i / 5));
    sum += value;
  }
  CHECK(sum > 0.0);

  scene.lights.clear();
  FlatScene flat = flatten_scene(scene);
  flat.triangles.clear();
  for (const AccelKind kind : {AccelKind::bvh, AccelKind::octree}) {
    AccelOptions options_of_tree = two_wide();
    options_of_tree.kind = kind;
    TinyTree tree(flat, options_of_tree);
    RayQueries single(tree.context, tree.scene, *tree.accel);
    const Rays rays = rays_through(9);
    std::size_t found = 0;
    for (const shared::QueryHit& hit : single.intersect(rays)) found += hit.primitive != HR_NO_PRIMITIVE ? 1 : 0;
    CHECK(found >= rays.size() / 4);
    if (kind != AccelKind::bvh) continue;
    RayQueries packets(tree.context, tree.scene, *tree.accel, false, RayGrouping::packets);
    Rays fan = rays;
    for (shared::QueryRay& ray : fan) ray.origin = rays.front().origin;
    const std::vector<shared::QueryHit> together = packets.intersect(fan), alone = single.intersect(fan);
    for (std::size_t i = 0; i < fan.size(); i++) CHECK(together[i].primitive == alone[i].primitive);
    tree.accel->refit(tree.scene);
    const std::vector<std::uint32_t> occluded = single.occluded(rays);
    CHECK(static_cast<std::size_t>(std::count(occluded.begin(), occluded.end(), 1U)) == found);
  }
}

TEST_CASE("tiny: rays that leave a surface do not meet it again") {
  TinyTree tree(test::soup(20, 4, 0.3F, 3), two_wide());
  const test::Rays rays = test::random_rays(6, 4);
  const std::vector<shared::float4> wanted(rays.size(), {0.0F, 0.6F, 0.8F, 1.0F});
  const LeavingRays leaving = leave_surfaces(tree.context, tree.scene, *tree.accel, rays, wanted);
  REQUIRE(leaving.next.size() == rays.size());
  CHECK(test::count_found(leaving.hits) > 0);
  for (std::size_t i = 0; i < rays.size(); i++) {
    const bool same = leaving.hits[i].primitive == leaving.next[i].primitive;
    CHECK((!same || leaving.hits[i].primitive == HR_NO_PRIMITIVE || leaving.hits[i].primitive >= 20));
  }
}

TEST_CASE("tiny: visits are counted") {
  TinyTree tree(test::soup(20, 4, 0.3F, 3), two_wide());
  const test::Rays rays = test::random_rays(6, 4);
  const Buffer<shared::QueryRay> buffer(tree.context, "rays", std::span<const shared::QueryRay>(rays));
  for (const bool any_hit : {false, true}) {
    CHECK(count_visits(tree.context, tree.scene, *tree.accel, buffer, 6, any_hit).nodes >= 1.0);
  }
}

TEST_CASE("tiny: packets and sorted rays render what single rays do") {
  RenderOptions options;
  options.width = options.height = 6;
  options.spp = 1;
  options.depth = 1;
  Scene scene = small_room();
  scene.lights.resize(1);  // the point
  options.accel = two_wide();
  DeviceProfile profile = TinyTree::profile(0);
  profile.tail_paths = 0;
  Context context(choose_device(""), profile);
  options.rays = RayGrouping::single;
  const Image single = render_scene(context, scene, options).image;
  struct Grouping {
    RayGrouping rays;
    std::string last_kernel;  // that only this one launches
  };
  for (const Grouping& grouping :
       {Grouping{RayGrouping::packets, "path_answer_shadow_packets"}, {RayGrouping::sorted, "path_order_queue"}}) {
    options.rays = grouping.rays;
    const RenderResult other = render_scene(context, scene, options);
    const std::vector<StageTime>& stages = other.statistics.stages;
    INFO(grouping.last_kernel);
    CHECK(std::any_of(stages.begin(), stages.end(),
                      [&grouping](const StageTime& stage) { return stage.name == grouping.last_kernel; }));
    std::size_t apart = 0;  // where a ray passes an edge within rounding
    for (int i = 0; i < 36; i++) {
      const double a = reference::value_at(single, "direct", i % 6, i / 6);
      apart += std::abs(reference::value_at(other.image, "direct", i % 6, i / 6) - a) > 1e-4 * (1 + a) ? 1 : 0;
    }
    CHECK(apart <= 1);
  }
}

TEST_CASE("tiny: implicit surfaces are rendered") {
  Scene scene = small_room();
  scene.spheres.clear();
  for (const bool ball : {false, true}) {
    Shape& shape = scene.shapes.emplace_back();
    shape.kind = ShapeKind::implicit;
    shape.to_world[3] = glm::dvec4(ball ? 0.6 : -0.5, 0.5, 0.0, 1.0);
    shape.material = ball ? 1 : 0;
    shape.expression = ball ? parse_expression("(x^2 + y^2 + z^2 - r^2)*(4 + x)", {{"r", 0.4}})
                            : parse_expression("(x^2+y^2+z^2+R^2-r^2)^2 - 4*R^2*(x^2+y^2)", {{"R", 0.3}, {"r", 0.12}});
    shape.clip = ball ? Clip::sphere : Clip::box;
    shape.clip_radius = 0.5;
    shape.clip_half = {0.5, 0.5, 0.2};
  }
  ReferenceOptions options;
  options.width = options.height = 4;
  options.depth = 2;
  const Image megakernel = render_on_device(scene, options, EngineKind::megakernel, true);
  const Image wavefront = render_on_device(scene, options, EngineKind::wavefront, true, 0);
  double sum = 0.0;
  for (int i = 0; i < 16; i++) {
    const double value = reference::value_at(wavefront, "direct", i % 4, i / 4);
    CHECK(value == reference::value_at(megakernel, "direct", i % 4, i / 4));
    sum += value;
  }
  CHECK(sum > 0.0);
}

}  // namespace hemiray

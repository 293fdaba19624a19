// Trees whose nodes and blocks lie in several buffers: the same bytes and the same answers as in one.
#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <vector>

#include "host/base/error.hpp"
#include "host/bvh/nearest_queries.hpp"
#include "host/path/render.hpp"
#include "tests/bvh/instanced_scenes.hpp"
#include "tests/bvh/query_bench.hpp"
#include "tests/bvh/tree_check.hpp"
#include "tests/reference/scene_builder.hpp"

namespace hemiray {
namespace {

using test::Hits;
using test::InstancedTree;
using test::Places;
using test::Rays;
using test::TreeWorkshop;

constexpr std::uint64_t kKib = 1024;

Context context_with(std::uint32_t tree_chunk_kib) {
  const DeviceInfo device = choose_device("");
  DeviceProfile profile = profile_for(device);
  profile.tree_chunk_kib = tree_chunk_kib;
  return {device, profile};
}

struct TreeShape {
  const char* name;
  AccelOptions options;
};

// Nodes and blocks of such trees take so much alike that both can lie in 2 to 8 chunks of the same size. In all but the
// first a leaf may have several blocks, which then cross the ends of chunks.
const std::vector<TreeShape>& shapes() {
  constexpr auto kQuality = TreeBuilder::quality;
  constexpr auto kTight = TriangleTest::watertight;
  static const std::vector<TreeShape> kShapes = {
      {"8 wide, 2 lanes, leaves of 2", {kQuality, kTight, 0, 8, 2, 2, 1}},
      {"8 wide, 1 lane, leaves of 4", {kQuality, kTight, 0, 8, 1, 4, 1}},
      {"4 wide, 2 lanes, leaves of 4, loops", {TreeBuilder::fast, kTight, 0, 4, 2, 4, 0}},
      {"2 wide, 2 lanes, leaves of 4", {kQuality, kTight, 0, 2, 2, 4, 1}},
  };
  return kShapes;
}

// So low that neither the nodes nor the blocks fit one buffer.
std::uint32_t limit_for(const Accel& accel) {
  return static_cast<std::uint32_t>(std::min(accel.nodes().bytes(), accel.blocks().bytes()) * 7 / 8 / kKib);
}

bool same_bytes(const TreeChunks& a, const TreeChunks& b) {
  const std::vector<float> x = a.read(), y = b.read();
  return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(float)) == 0;
}

// Leaves whose blocks begin in one chunk and end in the next.
std::size_t count_crossing(const Accel& accel) {
  const std::vector<float> nodes = accel.nodes().read();
  const std::size_t width = accel.config().width;
  const unsigned shift = accel.config().block_chunks.shift;
  std::size_t crossing = 0;
  for (std::size_t at = HR_NODE_CHILD_ROW * width; at < nodes.size(); at += accel.config().node_words()) {
    for (std::size_t i = 0; i < width; i++) {
      const auto leaf = ~std::bit_cast<std::uint32_t>(nodes[at + i]);
      const std::uint32_t first = leaf >> 4U, blocks = leaf & 15U;
      if (leaf < 0x80000000U && blocks > 0 && first >> shift != (first + blocks - 1) >> shift) crossing++;
    }
  }
  return crossing;
}

void check_same_tree(const Accel& chunked, const Accel& whole) {
  CHECK(whole.config().node_chunks.count == 1);
  CHECK(whole.config().block_chunks.count == 1);
  REQUIRE(chunked.config().node_chunks.count >= 2);
  REQUIRE(chunked.config().block_chunks.count >= 2);
  CHECK(same_bytes(chunked.nodes(), whole.nodes()));
  CHECK(same_bytes(chunked.blocks(), whole.blocks()));
}

// Of rays one by one, sorted, and in packets where the tree has them.
template <typename Tree>
void check_same_answers(TreeWorkshop& in_chunks, const Tree& chunked, TreeWorkshop& in_one, const Tree& whole,
                        const Rays& rays) {
  std::size_t found = 0;
  for (const RayGrouping grouping : {RayGrouping::single, RayGrouping::sorted, RayGrouping::packets}) {
    INFO("grouping " << static_cast<int>(grouping));
    RayQueries queries(in_chunks.context, chunked.scene, chunked.accel, true, grouping);
    RayQueries expected(in_one.context, whole.scene, whole.accel, true, grouping);
    const Hits hits = queries.intersect(rays);
    found = test::count_found(hits);
    CHECK(test::count_different(rays, hits, expected.intersect(rays)) == 0);
    CHECK(queries.occluded(rays) == expected.occluded(rays));
  }
  CHECK(found > rays.size() / 4);
}

// Two triangles far away: beside such bounds all leaves are small, and small ones get as many blocks as they may.
FlatScene with_far_bounds(FlatScene flat) {
  for (const float at : {-10.0F, 10.0F}) {
    test::add_triangle(flat, Vec3(at), Vec3(at) + Vec3(0.1F, 0, 0), Vec3(at) + Vec3(0, 0.1F, 0));
  }
  return flat;
}

// At every triangle from close by.
Rays rays_at_triangles(const FlatScene& flat) {
  Rays rays;
  for (const shared::uint4& t : flat.triangles) {
    const Vec3 a = test::vertex(flat, t.x), b = test::vertex(flat, t.y), c = test::vertex(flat, t.z);
    const Vec3 normal = glm::normalize(glm::cross(b - a, c - a));
    rays.push_back(test::make_ray((a + b + c) / 3.0F + 1e-3F * normal, -normal));
  }
  return rays;
}

// Packets' worth from each of a few points, and rays from everywhere.
Rays rays_for_all(std::uint32_t seed) {
  Rays rays = test::random_rays(4096, seed);
  Places places(seed + 1);
  for (int eye = 0; eye < 32; eye++) {
    const Vec3 origin = 3.0F * places.direction();
    for (int i = 0; i < 128; i++) rays.push_back(test::make_ray(origin, places.in_cube(0.7F) - origin));
  }
  return rays;
}

FlatScene moved(FlatScene flat, std::uint32_t seed) {
  Places places(seed);
  for (float& x : flat.positions) x += places.in(-0.05F, 0.05F);
  for (shared::Sphere& sphere : flat.spheres) sphere.center_radius.w *= places.in(0.5F, 2.0F);
  return flat;
}

bool same_points(const ClosestPoints& a, const ClosestPoints& b) {
  return a.primitives == b.primitives && a.points.size() == b.points.size() &&
         std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof a.points[0]) == 0;
}

std::vector<QueryPoint> points_to_search(std::uint32_t seed) {
  Places places(seed);
  std::vector<QueryPoint> queries;
  for (int i = 0; i < 2000; i++) {
    const Vec3 p = places.in_cube(1.2F);
    queries.push_back({p.x, p.y, p.z, test::kForever});
  }
  return queries;
}

}  // namespace

TEST_CASE("a tree in chunks is that in one piece: bytes, rays of all kinds, nearest points, refits") {
  const FlatScene flat = with_far_bounds(test::soup(6000, 600, 0.08F, 101));
  const Rays rays = rays_for_all(102), at_triangles = rays_at_triangles(flat);
  std::size_t crossing = 0;
  const std::vector<QueryPoint> points = points_to_search(103);
  for (const TreeShape& shape : shapes()) {
    INFO(shape.name);
    TreeWorkshop in_one;
    test::BuiltTree whole(in_one, flat, shape.options);
    TreeWorkshop in_chunks{context_with(limit_for(whole.accel))};
    test::BuiltTree chunked(in_chunks, flat, shape.options);
    check_same_tree(chunked.accel, whole.accel);
    test::TreeCheck(flat, chunked.accel, shape.options).run();
    crossing += count_crossing(chunked.accel);
    check_same_answers(in_chunks, chunked, in_one, whole, rays);
    check_same_answers(in_chunks, chunked, in_one, whole, at_triangles);
    NearestQueries nearest(in_chunks.context, chunked.scene, chunked.accel);
    NearestQueries expected(in_one.context, whole.scene, whole.accel);
    CHECK(same_points(nearest.closest(points), expected.closest(points)));
    const FlatScene other = moved(flat, 104);
    chunked.scene = DeviceScene(in_chunks.context, other, test::kAllPrimitives);
    whole.scene = DeviceScene(in_one.context, other, test::kAllPrimitives);
    chunked.accel.refit(chunked.scene);
    whole.accel.refit(whole.scene);
    check_same_tree(chunked.accel, whole.accel);
    check_same_answers(in_chunks, chunked, in_one, whole, rays_at_triangles(other));
  }
  CHECK(crossing > 0);
}

TEST_CASE("the usual tree's blocks alone lie in chunks, up to eight") {
  const FlatScene flat = test::soup(20000, 0, 0.05F, 105);
  const Rays rays = rays_for_all(106);
  AccelOptions options;
  options.width = options.leaf_lanes = options.max_leaf = 8;
  options.explicit_vectors = 1;
  TreeWorkshop in_one;
  const test::BuiltTree whole(in_one, flat, options);
  std::size_t most = 0;
  for (const std::uint64_t parts : {2U, 4U}) {
    TreeWorkshop in_chunks{context_with(static_cast<std::uint32_t>(whole.accel.blocks().bytes() / parts / kKib))};
    const test::BuiltTree chunked(in_chunks, flat, options);
    CHECK(chunked.accel.config().node_chunks.count == 1);
    REQUIRE(chunked.accel.config().block_chunks.count >= parts);
    most = std::max<std::size_t>(most, chunked.accel.config().block_chunks.count);
    CHECK(same_bytes(chunked.accel.blocks(), whole.accel.blocks()));
    check_same_answers(in_chunks, chunked, in_one, whole, rays);
  }
  CHECK(most >= 5);
}

TEST_CASE("the trees of instances in chunks are those in one piece, refitted ones too") {
  Scene scene;
  const std::uint32_t ball = test::add_mesh(scene, test::mesh_of(test::closed_mesh(16, true, Vec3(0.0F))));
  const std::uint32_t soup = test::add_mesh(scene, test::mesh_of(with_far_bounds(test::soup(2000, 0, 0.3F, 107))));
  Places places(108);
  for (std::uint32_t i = 0; i < 60; i++) {
    test::add_object(scene, i % 2 == 0 ? ball : soup,
                     test::random_turn(places, DVec3(places.in_cube(1.0F)), DVec3(places.in(0.1F, 0.3F))));
  }
  const FlatScene flat = flatten_scene(scene, Instancing::always);
  const Rays rays = rays_for_all(109);
  for (const TreeShape& shape : {shapes().front(), shapes().back()}) {
    INFO(shape.name);
    TreeWorkshop in_one;
    InstancedTree whole(in_one, flat, shape.options);
    TreeWorkshop in_chunks{context_with(limit_for(whole.accel))};
    InstancedTree chunked(in_chunks, flat, shape.options);
    check_same_tree(chunked.accel, whole.accel);
    check_same_answers(in_chunks, chunked, in_one, whole, rays);
    const FlatScene other = moved(flat, 110);
    const std::uint32_t features = test::kAllPrimitives | HR_FEATURE_INSTANCES;
    chunked.scene = DeviceScene(in_chunks.context, other, features);
    whole.scene = DeviceScene(in_one.context, other, features);
    chunked.accel.refit(chunked.scene);
    whole.accel.refit(whole.scene);
    check_same_tree(chunked.accel, whole.accel);
    check_same_answers(in_chunks, chunked, in_one, whole, rays);
  }
}

TEST_CASE("the nearest neighbours are the same from a tree of points in chunks") {
  Places places(111);
  std::vector<Vec3> points;
  for (int i = 0; i < 5000; i++) points.push_back(places.in_cube(1.0F));
  const std::vector<QueryPoint> queries = points_to_search(112);
  constexpr std::uint32_t kLimit = 64;  // [KiB]
  TreeWorkshop in_one, in_chunks{context_with(kLimit)};
  AccelOptions options;
  options.width = 2;
  options.leaf_lanes = options.max_leaf = 4;
  PointTree whole(in_one.context, in_one.builder, points, options);
  const std::uint64_t bytes = std::uint64_t{whole.statistics().nodes} * 2 * 32;
  REQUIRE(bytes > kLimit * kKib);
  PointTree chunked(in_chunks.context, in_chunks.builder, points, options);
  const Neighbours expected = whole.nearest(queries, 7), found = chunked.nearest(queries, 7);
  CHECK(found.indices == expected.indices);
  CHECK(found.distances == expected.distances);
}

TEST_CASE("pictures from a tree in chunks are the same bits, by both engines") {
  using namespace reference;
  Scene scene = empty_scene({0, 2.5, 6}, {0, 0.6, 0}, 45.0);
  scene.ambient = Vec3(0.1F);
  const std::uint32_t matte = add_material(scene, diffuse(Vec3(0.7F))), silver = add_material(scene, mirror(0.8F));
  add_smooth_ball(scene, {-1, 1, 0}, 0.9, 48, matte);
  add_smooth_ball(scene, {1, 1, 0}, 0.9, 48, silver);
  RenderOptions options;
  options.width = options.height = 64;
  options.spp = 1;
  options.depth = 3;
  options.strict = true;
  options.accel.width = options.accel.leaf_lanes = options.accel.max_leaf = 2;
  for (const EngineKind engine : {EngineKind::wavefront, EngineKind::megakernel}) {
    options.engine = engine;
    Context in_one(choose_device(""));
    const RenderResult whole = render_scene(in_one, scene, options);
    Context in_chunks = context_with(static_cast<std::uint32_t>(whole.statistics.accel.nodes * 64 * 3 / 4 / kKib));
    const RenderResult chunked = render_scene(in_chunks, scene, options);
    REQUIRE(chunked.image.layers.size() == whole.image.layers.size());
    for (std::size_t i = 0; i < whole.image.layers.size(); i++) {
      const std::vector<float>&data = chunked.image.layers[i].data, &expected = whole.image.layers[i].data;
      INFO("layer '" << whole.image.layers[i].name << "'");
      REQUIRE(data.size() == expected.size());
      CHECK(std::memcmp(data.data(), expected.data(), data.size() * sizeof(float)) == 0);
    }
  }
}

TEST_CASE("in one piece the kernels have the parameters of plain arrays, in chunks one more for each") {
  CHECK(AccelConfig{}.defines().find("CHUNK") == std::string::npos);
  AccelConfig chunked;
  chunked.node_chunks = {3, 10};
  chunked.block_chunks = {2, 12};
  const auto tree_parameters = [](const AccelConfig& config) {
    Context context(choose_device(""));
    Program program(context, "query", {"bvh/query.cl"}, {HR_FEATURE_TRIANGLES, true, config.defines()});
    std::vector<std::string> names;
    for (const std::string& name : program.kernel("query_intersect").argument_names) {
      if (name.rfind("accel_", 0) == 0) names.push_back(name);
    }
    return names;
  };
  CHECK(tree_parameters({}) == std::vector<std::string>{"accel_nodes", "accel_blocks"});
  CHECK(tree_parameters(chunked) ==
        std::vector<std::string>{"accel_nodes", "accel_blocks", "accel_nodes_1", "accel_nodes_2", "accel_blocks_1"});
}

TEST_CASE("chunks are the fewest powers of two that fit the largest buffer, or an error says what does not") {
  const ChunkElement block{80, 7};  // 320 bytes
  const auto layout = [&](std::uint64_t elements, std::uint64_t largest) {
    return chunk_layout("accel_blocks", elements, block, largest);
  };
  CHECK(layout(0, 320).count == 1);
  CHECK(layout(100, 32000).count == 1);
  const ChunkLayout over = layout(101, 32000);  // 93 and the 7 that follow
  CHECK(over.shift == 6);
  CHECK(over.count == 2);
  const ChunkLayout tight = layout(100, 70 * 320);  // 64 and 7 do not fit
  CHECK(tight.shift == 5);
  CHECK(tight.count == 4);
  const ChunkLayout most = layout(512, 32000);
  CHECK(most.shift == 6);
  CHECK(most.count == 8);
  CHECK_THROWS_AS(layout(513, 32000), DeviceError);
  CHECK_THROWS_WITH(layout(513, 32000), Catch::Contains("accel_blocks") && Catch::Contains("8 buffers") &&
                                            Catch::Contains("tree_chunk_kib"));
  CHECK_THROWS_AS(layout(8, 7 * 320), DeviceError);  // no room for what is repeated
  Context context = context_with(7);
  CHECK(largest_tree_buffer(context) == 7 * kKib);
  CHECK(largest_tree_buffer(context_with(0)) == context.device().max_allocation_bytes);
  TreeWorkshop workshop{context_with(1)};
  CHECK_THROWS_AS(test::BuiltTree(workshop, test::soup(5000, 0, 0.1F, 113)), DeviceError);
  CHECK_NOTHROW(test::BuiltTree(workshop, test::soup(2, 0, 0.1F, 114)));
}

}  // namespace hemiray

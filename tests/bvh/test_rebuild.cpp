// What building again must give: the same bytes, the same hits under other device profiles, after refit as after a
// rebuild; and the memory that a build takes.
#include <catch2/catch.hpp>

#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "host/base/error.hpp"
#include "host/bvh/accel_memory.hpp"
#include "tests/bvh/query_bench.hpp"
#include "tests/bvh/tree_check.hpp"
#include "tests/support/profile_file.hpp"

namespace hemiray {
namespace {

using test::Places;
using test::ProfileFile;
using test::QueryBench;
using test::random_rays;
using test::Rays;
using test::soup;

bool same_bytes(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

struct TreeBytes {
  std::vector<float> nodes, blocks;
  bool operator==(const TreeBytes& other) const {
    return same_bytes(nodes, other.nodes) && same_bytes(blocks, other.blocks);
  }
};

TreeBytes bytes_of(const Accel& accel) { return {accel.nodes().read(), accel.blocks().read()}; }

// The scene with every vertex elsewhere, and every sphere.
FlatScene moved(const FlatScene& flat, float by, std::uint32_t seed) {
  FlatScene result = flat;
  Places places(seed);
  for (float& x : result.positions) x += places.in(-by, by);
  for (shared::Sphere& sphere : result.spheres) {
    sphere.center_radius.x += places.in(-by, by);
    sphere.center_radius.w *= places.in(0.5F, 2.0F);
  }
  return result;
}

}  // namespace

TEST_CASE("ten builds of one scene are the same bytes") {
  const FlatScene flat = soup(20000, 3000, 0.05F, 11);
  for (const bool keep_scratch : {false, true}) {  // memory that is used again holds what the last build left
    Context context{choose_device("")};
    Parallel parallel{context};
    AccelBuilder builder(context, parallel, keep_scratch);
    const DeviceScene scene(context, flat, test::kAllPrimitives);
    const DeviceScene other(context, soup(30000, 0, 0.02F, 12), test::kAllPrimitives);
    for (const std::size_t k : {0U, 1U}) {
      const AccelOptions& options = test::tree_kinds()[k].options;
      INFO(test::tree_kinds()[k].name);
      std::optional<TreeBytes> first;
      for (int build = 0; build < 10; build++) {
        const TreeBytes now = bytes_of(Accel(builder, scene, options));
        if (!first) first = now;
        CHECK(now == *first);
        if (keep_scratch) (void)Accel(builder, other, options);
      }
    }
  }
}

TEST_CASE("any number of chunks and of items gives the same hits, and the same radix tree") {
  const FlatScene flat = soup(20000, 2000, 0.05F, 13);
  const Rays rays = random_rays(20000, 14);
  std::optional<test::Hits> hits;
  std::optional<TreeBytes> radix;
  for (const std::string fields :
       {R"("cluster_chunks": 1)", R"("cluster_chunks": 3)", R"("cluster_chunks": 16, "chunks": 7)",
        R"("cluster_limit": 2, "cluster_keep": 1, "collapse_regions": 2)",
        R"("explicit_vectors": 0, "rays_per_item": 7, "chunks": 1, "cluster_limit": 16, "cluster_keep": 8)",
        R"("chunks": 64, "chunk_local_size": 8, "cluster_chunks": 64, "local_size": 32, "collapse_regions": 1000)"}) {
    INFO(fields);
    const ProfileFile profile(ProfileFile::for_all(fields));
    test::TreeWorkshop workshop;
    AccelOptions options;
    options.width = 8;
    options.leaf_lanes = options.max_leaf = 4;
    QueryBench bench(workshop, flat, options);
    test::TreeCheck(flat, bench.tree.accel, options).run();
    const test::Hits found = bench.queries.intersect(rays);
    if (!hits) hits = found;
    CHECK(test::count_different(rays, found, *hits) == 0);
    CHECK(test::count_disagreeing(found, bench.queries.occluded(rays)) == 0);
    if (fields.find("collapse_regions") != std::string::npos) continue;  // these decide where nodes lie
    options.builder = TreeBuilder::fast;
    const test::BuiltTree tree(workshop, flat, options);
    if (!radix) radix = bytes_of(tree.accel);
    CHECK(bytes_of(tree.accel) == *radix);
  }
  REQUIRE(test::count_found(*hits) > rays.size() / 2);
}

TEST_CASE("loops and vectors cluster alike") {
  const FlatScene flat = soup(20000, 2000, 0.05F, 22);
  std::optional<TreeBytes> vectors;
  for (const std::string fields : {R"("explicit_vectors": 1)", R"("explicit_vectors": 0)"}) {
    const ProfileFile profile(ProfileFile::for_all(fields));
    test::TreeWorkshop workshop;
    const test::BuiltTree tree(workshop, flat, test::tree_kinds().front().options);
    if (!vectors) vectors = bytes_of(tree.accel);
    CHECK(bytes_of(tree.accel) == *vectors);
  }
}

TEST_CASE("a refitted tree is true to the moved scene and answers as a rebuilt one") {
  test::TreeWorkshop workshop;
  const FlatScene flat = soup(3000, 300, 0.1F, 15);
  const FlatScene scenes[] = {moved(flat, 0.01F, 16), moved(flat, 1.0F, 17), flat};
  const Rays rays = random_rays(20000, 18);
  for (const test::TreeKind& kind : test::tree_kinds()) {
    INFO(kind.name);
    test::BuiltTree tree(workshop, flat, kind.options);
    const TreeBytes built = bytes_of(tree.accel);
    for (const FlatScene& scene : scenes) {
      const DeviceScene device_scene(workshop.context, scene, test::kAllPrimitives | triangle_features(scene));
      tree.accel.refit(device_scene);
      test::TreeCheck(scene, tree.accel, kind.options).run(true);
      if (kind.options.triangle_test == TriangleTest::fast) continue;  // its slabs may lose a ray at a box's rim
      RayQueries queries(workshop.context, device_scene, tree.accel, true);
      const test::Hits hits = queries.intersect(rays);
      QueryBench rebuilt(workshop, scene, kind.options);
      CHECK(test::count_different(rays, hits, rebuilt.queries.intersect(rays)) == 0);
      CHECK(test::count_disagreeing(hits, queries.occluded(rays)) == 0);
    }
    CHECK(bytes_of(tree.accel) == built);  // moved there and back
  }
}

TEST_CASE("a primitive that a refit finds not finite is met by no ray, trees of nothing can be refitted") {
  test::TreeWorkshop workshop;
  const FlatScene flat = soup(500, 50, 0.2F, 19);
  FlatScene broken = flat;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 0; i < broken.triangles.size(); i += 3)
    broken.positions[3 * broken.triangles[i].y + i % 3] = nan;
  for (std::size_t i = 0; i < broken.spheres.size(); i += 2) broken.spheres[i].center_radius.w = nan;
  const DeviceScene scene(workshop.context, broken, test::kAllPrimitives);
  const Rays rays = random_rays(20000, 20);
  for (const test::TreeKind& kind : test::tree_kinds()) {
    INFO(kind.name);
    test::BuiltTree tree(workshop, flat, kind.options);
    tree.accel.refit(scene);
    RayQueries queries(workshop.context, scene, tree.accel, true);
    QueryBench rebuilt(workshop, broken, kind.options);
    const test::Hits hits = queries.intersect(rays), expected = rebuilt.queries.intersect(rays);
    CHECK(test::count_different(rays, hits, expected) == 0);
    CHECK(test::count_found(hits) > rays.size() / 4);
  }
  test::BuiltTree nothing(workshop, test::empty_flat_scene());
  CHECK_NOTHROW(nothing.accel.refit(scene));
  CHECK(nothing.accel.statistics().primitives == 0);
}

TEST_CASE("a build takes the memory that was predicted, and gives its scratch back") {
  test::TreeWorkshop workshop;
  Context& context = workshop.context;
  const FlatScene mesh = test::closed_mesh(130, true, Vec3(0.0F)), triangles = soup(200000, 0, 0.01F, 21);
  for (const FlatScene* flat : {&mesh, &triangles}) {
    const DeviceScene scene(context, *flat, test::kAllPrimitives);
    Context fresh{choose_device("")};  // a peak of its own
    Parallel parallel{fresh};
    AccelBuilder builder{fresh, parallel};
    const DeviceScene fresh_scene(fresh, *flat, test::kAllPrimitives);
    const std::uint64_t before = fresh.allocated_bytes();
    const Accel accel(builder, fresh_scene);
    const AccelMemory predicted = predict_accel_bytes(flat->triangles.size(), {}, fresh.profile());
    const auto kept = static_cast<double>(fresh.allocated_bytes() - before);
    const auto peak = static_cast<double>(fresh.peak_bytes() - before);
    INFO(flat->triangles.size() << " triangles: kept " << kept << ", predicted " << predicted.tree << "; peak " << peak
                                << ", predicted " << predicted.peak);
    CHECK(kept == Approx(static_cast<double>(predicted.tree)).epsilon(0.25));
    CHECK(peak == Approx(static_cast<double>(predicted.peak)).epsilon(0.25));
  }
}

TEST_CASE("options that cannot be are refused with what can") {
  const DeviceProfile profile;
  const auto with = [](unsigned AccelOptions::*member, unsigned value) {
    AccelOptions options;
    options.*member = value;
    return options;
  };
  for (const unsigned width : {1U, 3U, 6U, 16U}) {
    CHECK_THROWS_AS(complete_options(with(&AccelOptions::width, width), profile), InputError);
    CHECK_THROWS_WITH(complete_options(with(&AccelOptions::width, width), profile),
                      Catch::StartsWith("tree width: " + std::to_string(width)) && Catch::Contains("from 2 to 8"));
  }
  for (const unsigned lanes : {3U, 5U, 16U}) {
    CHECK_THROWS_WITH(complete_options(with(&AccelOptions::leaf_lanes, lanes), profile),
                      Catch::StartsWith("leaf lanes: ") && Catch::Contains("from 1 to 8"));
  }
  const AccelOptions defaults = complete_options({}, profile);
  CHECK(defaults.width == profile.bvh_width);
  CHECK(defaults.leaf_lanes == profile.leaf_lanes);
  CHECK(defaults.max_leaf == profile.max_leaf);
  CHECK(defaults.explicit_vectors == 1);
  AccelOptions large = with(&AccelOptions::max_leaf, 1000);
  large.leaf_lanes = 2;
  CHECK(complete_options(large, profile).max_leaf == 30);  // what 15 blocks hold
  CHECK(stack_size_for(1) == 128);
  CHECK(stack_size_for(128) == 128);
  CHECK(stack_size_for(129) == 256);
}

}  // namespace hemiray

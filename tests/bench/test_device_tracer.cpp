// Our own tracer behind the benchmark's interface, against brute force.
#include "host/bench/device_tracer.hpp"
#include "host/bench/procedural_scenes.hpp"
#include "tests/bench/check_tracer.hpp"

namespace hemiray {

using namespace bench;

TEST_CASE("device tracers answer as brute force does, with every tree, triangle test and way of asking") {
  Context context(choose_device(""));
  const auto workshop = std::make_shared<DeviceWorkshop>(context);
  for (const TreeBuilder tree : {TreeBuilder::fast, TreeBuilder::quality}) {
    for (const TriangleTest triangles : {TriangleTest::watertight, TriangleTest::fast}) {
      for (const TraceMode mode : {TraceMode::single, TraceMode::packet, TraceMode::double_precision}) {
        if (mode == TraceMode::double_precision && !context.device().has_fp64) continue;
        const auto tracer = make_device_tracer(workshop, {tree, triangles, mode, AccelKind::bvh});
        const auto sharer = make_device_tracer(workshop, {tree, triangles, TraceMode::single, AccelKind::bvh});
        test::check_tracer(*tracer, *sharer);
      }
    }
  }
}

TEST_CASE("tracers of trees of cells answer as brute force does") {
  Context context(choose_device(""));
  const auto workshop = std::make_shared<DeviceWorkshop>(context);
  for (const auto& [kind, name] : {std::pair{AccelKind::octree, "device/octree"},
                                   {AccelKind::kdtree, "device/kdtree"},
                                   {AccelKind::kdtree_median, "device/kdtree-median"}}) {
    DeviceTracerSettings settings;
    settings.kind = kind;
    const auto tracer = make_device_tracer(workshop, settings), sharer = make_device_tracer(workshop, settings);
    CHECK(tracer->build_name() == name);
    test::check_tracer(*tracer, *sharer);
    const std::optional<TreeFacts> facts = tracer->facts();
    REQUIRE(facts);
    CHECK(facts->references >= 1.0);
    CHECK(facts->nodes > 0);
    CHECK(facts->depth >= 2);
    CHECK(facts->block_fill > 0.1);
    CHECK_FALSE(make_device_tracer(workshop, {})->share_build(*tracer));
  }
}

TEST_CASE("device tracers are named by tree, triangle test and way of asking, only the same trees are shared") {
  Context context(choose_device(""));
  const auto workshop = std::make_shared<DeviceWorkshop>(context);
  const auto make = [&](TreeBuilder tree, TriangleTest triangles) {
    return make_device_tracer(workshop, {tree, triangles, TraceMode::single, AccelKind::bvh});
  };
  const auto quality = make(TreeBuilder::quality, TriangleTest::watertight);
  const auto fast = make(TreeBuilder::fast, TriangleTest::fast);
  CHECK(quality->name() == "device/quality/watertight/single");
  CHECK(quality->build_name() == "device/quality");
  CHECK_FALSE(quality->in_packets());
  CHECK(fast->name() == "device/fast/fast/single");
  CHECK_FALSE(quality->facts());
  quality->build(test::triangle_soup(200, 1));
  CHECK_FALSE(fast->share_build(*quality));
  CHECK_FALSE(make(TreeBuilder::quality, TriangleTest::fast)->share_build(*quality));
  const auto sharer = make(TreeBuilder::quality, TriangleTest::watertight);
  CHECK(sharer->share_build(*quality));
  CHECK_FALSE(sharer->build_memory());
  CHECK_THROWS_AS(fast->intersect(), std::logic_error);
  CHECK_THROWS_AS(fast->load_rays({}), std::logic_error);
  CHECK_FALSE(quality->build_stages().empty());
  const std::optional<TreeFacts> facts = quality->facts();
  REQUIRE(facts);
  CHECK(facts->nodes > 0);
  CHECK(facts->sah_cost > 1.0);
  CHECK(facts->depth >= 2);
  CHECK(facts->block_fill > 0.2);
  CHECK(facts->block_fill <= 1.0);
}

TEST_CASE("a tracer's build takes the memory that was predicted, the first one and later ones") {
  const FlatScene flat = bench::procedural_scene("interior", 30'000).flat;
  Context context(choose_device(""));
  const auto workshop = std::make_shared<DeviceWorkshop>(context);
  const auto first = make_device_tracer(workshop, {}), second = make_device_tracer(workshop, {});
  CHECK_FALSE(first->build_memory());
  first->build(flat);
  const std::optional<BuildMemory> once = first->build_memory();
  REQUIRE(once);
  CHECK(static_cast<double>(once->peak) == Approx(static_cast<double>(once->predicted)).epsilon(0.2));
  CHECK(once->block_buffers == 1);
  second->build(flat);  // beside the first one's tree, in working memory that is there already
  first->build(flat);
  for (const auto* tracer : {&first, &second}) {
    const std::optional<BuildMemory> again = (*tracer)->build_memory();
    REQUIRE(again);
    CHECK(static_cast<double>(again->peak) == Approx(static_cast<double>(once->peak)).epsilon(0.05));
    CHECK(static_cast<double>(again->peak) == Approx(static_cast<double>(again->predicted)).epsilon(0.2));
  }
}

}  // namespace hemiray

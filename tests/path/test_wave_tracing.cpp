// How the wavefront traces a wave: the order of its slots, packets and sorted rays against single ones, and the walk of
// the last few paths against the megakernel.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "host/base/error.hpp"
#include "host/path/render.hpp"
#include "host/path/wave_tracing.hpp"
#include "tests/path/render_on_device.hpp"
#include "tests/reference/image_agreement.hpp"
#include "tests/reference/scene_builder.hpp"
#include "tests/support/profile_file.hpp"

namespace hemiray {
namespace {

using namespace reference;

// Rays of a packet meet the same triangles as single ones, with t, u and v rounded apart by a few ulps; where one
// passes an edge or a silhouette that close, a pixel differs outright.
constexpr double kPacketOutlierShare = 0.002;
constexpr double kPacketRelMse = 1e-7;
constexpr std::uint32_t kManyPaths = 16384;  // more than any picture here has

// Triangles, spheres and a plane; lights that are points. Mirrors keep incoherent rays coming.
Scene lit_scene() {
  Scene scene = empty_scene({0.5, 2.5, 6}, {0, 0.8, 0}, 45.0);
  scene.ambient = Vec3(0.05F);
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, add_material(scene, diffuse(Vec3(0.6F))));
  add_smooth_ball(scene, {-1.2, 1, 0}, 0.9, 12, add_material(scene, diffuse(Vec3(0.7F, 0.4F, 0.3F))));
  add_sphere(scene, {1.1, 0.8, 0.4}, 0.8, add_material(scene, mirror(0.7F)));
  add_box(scene, {-0.3, 0, 0.9}, {0.4, 0.6, 1.6}, add_material(scene, diffuse(Vec3(0.3F, 0.5F, 0.7F))));
  add_point_light(scene, {2, 5, 4}, Vec3(60.0F));
  Light& spot = add_point_light(scene, {-3, 4, 3}, Vec3(60.0F));
  spot.kind = LightKind::spot;
  spot.direction = glm::normalize(DVec3(0.5, -0.7, -0.5));
  return scene;
}

// Two panes of glass and mirrors around: a ray goes on for many bounces.
Scene glass_scene() {
  Scene scene = empty_scene({0, 0.2, 1.8}, {0, 0, 0}, 60.0);
  add_box(scene, {-2, -2, -2}, {2, 2, 2}, add_material(scene, mirror(0.9F)));
  for (const double x : {-0.6, 0.0, 0.6}) add_sphere(scene, {x, 0, 0}, 0.28, add_material(scene, glass(1.5F)));
  add_point_light(scene, {0, 1.5, 0.3}, Vec3(3.0F));
  scene.ambient = Vec3(0.1F);
  return scene;
}

RenderResult render(const Scene& scene, const std::optional<RayGrouping>& rays, bool strict = false,
                    EngineKind engine = EngineKind::wavefront, int depth = 3, int size = 96,
                    std::uint32_t tail_paths = 0) {
  RenderOptions options;
  options.engine = engine;
  options.width = size;
  options.height = size - 7;
  options.spp = 1;
  options.depth = depth;
  options.strict = strict;
  options.rays = rays;
  Context context(choose_device(""), profile_with_tail(tail_paths));
  return render_scene(context, scene, options);
}

std::map<std::string, StageTime> stages_of(const RenderResult& result) {
  std::map<std::string, StageTime> stages;
  for (const StageTime& stage : result.statistics.stages) stages.emplace(stage.name, stage);
  return stages;
}

void check_same_bits(const Image& a, const Image& b) {
  for (const Layer& layer : a.layers) {
    INFO(layer.name);
    CHECK(layer.data == b.find(layer.name)->data);
  }
}

}  // namespace

TEST_CASE("slots by tile are a permutation in which 64 neighbours lie in 8 x 8 pixels") {
  struct Wave {
    std::uint32_t first, count, width;
  };
  for (const Wave wave : {Wave{0, 640, 80}, Wave{37, 1000, 61}, Wave{5, 3, 7}, Wave{0, 1, 1}, Wave{63, 130, 1}}) {
    INFO(wave.first << " " << wave.count << " " << wave.width);
    std::vector<std::uint32_t> slots = slots_by_tile(wave.first, wave.count, wave.width);
    std::sort(slots.begin(), slots.end());
    std::vector<std::uint32_t> all(wave.count);
    std::iota(all.begin(), all.end(), 0U);
    CHECK(slots == all);
  }
  const std::vector<std::uint32_t> slots = slots_by_tile(0, 640, 80);
  for (std::size_t i = 0; i < 64; i++) {
    CHECK(slots[i] % 80 < 8);
    CHECK(slots[i] / 80 < 8);
  }
}

TEST_CASE("packets give the picture of single rays") {
  const test::ProfileFile profile(test::ProfileFile::for_all(test::kVectorLayout));
  const Scene scene = lit_scene();
  const RenderResult single = render(scene, RayGrouping::single);
  const RenderResult packets = render(scene, RayGrouping::packets);
  std::map<std::string, StageTime> stages = stages_of(packets);
  CHECK(stages.count("path_intersect_closest_packets") == 1);
  CHECK(stages.count("path_answer_shadow_packets") == 1);
  CHECK(stages_of(single).count("path_intersect_closest_packets") == 0);
  CHECK(packets.statistics.rays.closest == single.statistics.rays.closest);
  CHECK(packets.statistics.rays.shadow == Approx(static_cast<double>(single.statistics.rays.shadow)).epsilon(1e-3));
  for (const LayerAgreement& layer : compare_layers(packets.image, single.image)) {
    INFO(layer.layer);
    CHECK(layer.outlier_share <= kPacketOutlierShare);
    CHECK(layer.rel_mse <= kPacketRelMse);
  }
}

TEST_CASE("shadows of a light far away are not traced from it") {
  const test::ProfileFile profile(test::ProfileFile::for_all(test::kVectorLayout));
  // Seen from 1e6 m, what is within 2 m of a surface would not be looked at.
  Scene scene = lit_scene();
  scene.lights.resize(1);
  scene.lights[0].position = {3e5, 8e5, 5e5};
  scene.lights[0].intensity = Vec3(6e12F);
  const RenderResult single = render(scene, RayGrouping::single);
  const RenderResult packets = render(scene, RayGrouping::packets);
  for (const LayerAgreement& layer : compare_layers(packets.image, single.image)) {
    INFO(layer.layer);
    CHECK(layer.outlier_share <= kPacketOutlierShare);
  }
}

TEST_CASE("sorted rays give the bits of single ones") {
  const RenderResult single = render(lit_scene(), RayGrouping::single, true);
  const RenderResult sorted = render(lit_scene(), RayGrouping::sorted, true);
  CHECK(stages_of(sorted).at("path_order_queue").launches >= 1);
  check_same_bits(single.image, sorted.image);
}

TEST_CASE("packets are refused where they cannot be had") {
  CHECK_THROWS_AS(render(lit_scene(), RayGrouping::packets, true), InputError);
}

TEST_CASE("the last paths of a wave walk to their end in one go, with the same bits") {
  const Scene scene = glass_scene();
  const RenderResult megakernel = render(scene, {}, true, EngineKind::megakernel, 14, 64);
  for (const std::uint32_t tail_paths : {3U, 300U, 2000U, kManyPaths}) {
    INFO("a tail of " << tail_paths << " paths");
    const RenderResult wavefront = render(scene, {}, true, EngineKind::wavefront, 14, 64, tail_paths);
    const StageTime tail = stages_of(wavefront).at("path_finish");
    CHECK(tail.launches == 1);
    CHECK(tail.items > 0);
    CHECK(tail.items <= tail_paths);
    CHECK(wavefront.statistics.rays.closest == megakernel.statistics.rays.closest);
    CHECK(wavefront.statistics.rays.shadow == megakernel.statistics.rays.shadow);
    check_same_bits(wavefront.image, megakernel.image);
  }
}

TEST_CASE("rays that go in packets or are sorted do so before the tail") {
  const test::ProfileFile profile(test::ProfileFile::for_all(test::kVectorLayout));
  const Scene scene = lit_scene();  // two lights: a surface sends two rounds of shadow rays
  std::map<std::string, StageTime> packets =
      stages_of(render(scene, RayGrouping::packets, false, EngineKind::wavefront, 3, 96, kManyPaths));
  CHECK(packets.at("path_intersect_closest_packets").launches == 1);
  CHECK(packets.at("path_answer_shadow_packets").launches == 2);
  CHECK(packets.at("path_finish").launches == 1);
  std::map<std::string, StageTime> sorted =
      stages_of(render(scene, RayGrouping::sorted, true, EngineKind::wavefront, 3, 96, kManyPaths));
  CHECK(sorted.count("path_finish") == 0);
  CHECK(sorted.at("path_order_queue").launches >= 1);
}

}  // namespace hemiray

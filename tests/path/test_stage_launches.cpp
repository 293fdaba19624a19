// Which stages are launched, how often and over how many rays: never over an empty queue, never what the scene does not
// call for, and alike in both engines.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "host/path/render.hpp"
#include "tests/path/render_on_device.hpp"
#include "tests/reference/scene_builder.hpp"

namespace hemiray {
namespace {

using namespace reference;

constexpr int kSize = 24;
constexpr int kPasses = 2;
constexpr std::uint64_t kSamples = std::uint64_t{kSize} * kSize * kPasses;

// A floor and a ball; what the ball is made of decides which rays there are.
Scene ball_scene(const Material& ball, bool lit) {
  Scene scene = empty_scene({0, 2, 6}, {0, 0.8, 0}, 50.0);
  scene.background = Vec3(0.5F);
  scene.ambient = Vec3(0.1F);
  add_rectangle(scene, {-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, add_material(scene, diffuse(Vec3(0.7F))));
  add_sphere(scene, {0, 1, 0}, 1.0, add_material(scene, ball));
  if (lit) add_point_light(scene, {2, 5, 4}, Vec3(50.0F));
  return scene;
}

RenderStatistics statistics_of(const Scene& scene, EngineKind engine, int depth = 4, std::uint32_t tail_paths = 0) {
  RenderOptions options;
  options.engine = engine;
  options.width = options.height = kSize;
  options.spp = kPasses;
  options.depth = depth;
  options.strict = true;
  Context context(choose_device(""), profile_with_tail(tail_paths));
  return render_scene(context, scene, options).statistics;
}

std::map<std::string, StageTime> stages_of(const RenderStatistics& statistics) {
  std::map<std::string, StageTime> stages;
  for (const StageTime& stage : statistics.stages) {
    INFO(stage.name);
    CHECK(stage.launches > 0);
    CHECK(stage.items >= stage.launches);  // no launch is over nothing
    CHECK(stages.emplace(stage.name, stage).second);
  }
  return stages;
}

// The last paths of a wave walk to their end: what they trace is not launched as stages, and counted all the same.
void check_tail(const Scene& scene, int depth, std::uint32_t tail_paths, const RayCounts& all) {
  INFO("a tail of " << tail_paths << " paths");
  const RenderStatistics statistics = statistics_of(scene, EngineKind::wavefront, depth, tail_paths);
  std::map<std::string, StageTime> stages = stages_of(statistics);
  CHECK(statistics.rays.closest == all.closest);
  CHECK(statistics.rays.shadow == all.shadow);
  CHECK(stages["path_generate"].items == kSamples);
  CHECK(stages["film_accumulate"].items == kSamples);
  CHECK(stages["path_finish"].launches == kPasses);
  CHECK(stages["path_finish"].items <= tail_paths * std::uint64_t{kPasses});
  if (tail_paths < kSize * kSize) return;
  CHECK(stages["path_finish"].items == kSamples);  // all, once the camera's rays are traced
  CHECK(stages["path_intersect_closest"].items == kSamples);
  for (const char* other : {"path_shade_miss", "path_shade_surface", "path_intersect_shadow", "path_scatter"}) {
    CHECK(stages.count(other) == 0);
  }
}

// What must hold of any render by the wavefront engine.
std::map<std::string, StageTime> check_wavefront(const Scene& scene, int depth = 4) {
  const RenderStatistics statistics = statistics_of(scene, EngineKind::wavefront, depth);
  std::map<std::string, StageTime> stages = stages_of(statistics);
  CHECK(stages["path_generate"].items == kSamples);
  CHECK(stages["path_generate"].launches == kPasses);
  CHECK(stages["film_accumulate"].items == kSamples);
  CHECK(stages["path_intersect_closest"].items == statistics.rays.closest);
  CHECK((stages.count("path_intersect_shadow") != 0 ? stages["path_intersect_shadow"].items : 0) ==
        statistics.rays.shadow);
  CHECK(stages["path_shade_miss"].items + stages["path_shade_surface"].items == statistics.rays.closest);
  const RenderStatistics twin = statistics_of(scene, EngineKind::megakernel, depth);
  CHECK(twin.rays.closest == statistics.rays.closest);
  CHECK(twin.rays.shadow == statistics.rays.shadow);
  std::map<std::string, StageTime> twin_stages = stages_of(twin);
  CHECK(twin_stages["path_megakernel"].items == kSamples);
  CHECK(twin_stages["path_megakernel"].launches == kPasses);
  CHECK(twin_stages.count("path_generate") == 0);
  CHECK(stages.count("path_megakernel") == 0);
  CHECK(stages.count("path_finish") == 0);
  check_tail(scene, depth, kSize * kSize, twin.rays);
  return stages;
}

}  // namespace

TEST_CASE("an unlit diffuse scene launches neither shadow nor secondary rays") {
  std::map<std::string, StageTime> stages = check_wavefront(ball_scene(diffuse(Vec3(0.5F)), false));
  CHECK(stages.count("path_intersect_shadow") == 0);
  CHECK(stages.count("path_scatter") == 0);
  CHECK(stages.count("path_next_branch") == 0);
  CHECK(stages["path_intersect_closest"].items == kSamples);
  CHECK(stages["path_intersect_closest"].launches == kPasses);
}

TEST_CASE("a lit diffuse scene launches shadow rays and no secondary ones") {
  std::map<std::string, StageTime> stages = check_wavefront(ball_scene(diffuse(Vec3(0.5F)), true));
  CHECK(stages["path_intersect_shadow"].items > 0);
  CHECK(stages["path_intersect_shadow"].items <= stages["path_shade_surface"].items);  // one light, one sample
  CHECK(stages.count("path_scatter") == 0);
  CHECK(stages.count("path_next_branch") == 0);
}

TEST_CASE("a mirror scatters without branches") {
  std::map<std::string, StageTime> stages = check_wavefront(ball_scene(mirror(0.8F), true));
  CHECK(stages["path_scatter"].items > 0);
  CHECK(stages["path_intersect_closest"].items == kSamples + stages["path_scatter"].items);  // each goes on
  CHECK(stages.count("path_next_branch") == 0);
}

TEST_CASE("glass branches, and every branch is taken up again") {
  const Scene scene = ball_scene(glass(1.5F), true);
  std::map<std::string, StageTime> stages = check_wavefront(scene);
  CHECK(stages["path_next_branch"].items > 0);
  // Each scattering goes on along one ray, and sets one aside where it both reflects and refracts.
  CHECK(stages["path_intersect_closest"].items ==
        kSamples + stages["path_scatter"].items + stages["path_next_branch"].items);
  const RayCounts all = statistics_of(scene, EngineKind::megakernel).rays;
  for (const std::uint32_t tail_paths : {50U, 200U}) check_tail(scene, 4, tail_paths, all);
}

TEST_CASE("at depth zero a glass scene launches what a diffuse one does") {
  std::map<std::string, StageTime> stages = check_wavefront(ball_scene(glass(1.5F), true), 0);
  CHECK(stages.count("path_scatter") == 0);
  CHECK(stages.count("path_next_branch") == 0);
  CHECK(stages["path_intersect_closest"].items == kSamples);
}

TEST_CASE("where nothing is met no surface stage is launched, and where all is met no miss stage") {
  Scene empty = ball_scene(diffuse(Vec3(0.5F)), true);
  empty.camera.to_world = look_at({0, 10, 0}, {0, 20, -5});
  const std::map<std::string, StageTime> sky = stages_of(statistics_of(empty, EngineKind::wavefront));
  CHECK(sky.count("path_shade_surface") == 0);
  CHECK(sky.count("path_intersect_shadow") == 0);
  CHECK(sky.at("path_shade_miss").items == kSamples);
  Scene inside = empty_scene({0, 0, 0}, {0, 0, -1});
  add_box(inside, {-1, -1, -1}, {1, 1, 1}, add_material(inside, diffuse(Vec3(0.5F))));
  add_point_light(inside, {0.1, 0.1, 0.1}, Vec3(1.0F));
  const std::map<std::string, StageTime> room = stages_of(statistics_of(inside, EngineKind::wavefront));
  CHECK(room.count("path_shade_miss") == 0);
  CHECK(room.at("path_intersect_shadow").items == kSamples);
}

TEST_CASE("a light behind every surface sends no shadow ray") {
  Scene scene = empty_scene({0, 3, 0.1}, {0, 0, 0}, 30.0);
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, add_material(scene, diffuse(Vec3(0.5F))));
  add_point_light(scene, {0, -1, 0}, Vec3(1.0F));
  const RenderStatistics statistics = statistics_of(scene, EngineKind::wavefront);
  CHECK(statistics.rays.closest == kSamples);
  CHECK(statistics.rays.shadow == 0);
  CHECK(stages_of(statistics).count("path_intersect_shadow") == 0);
}

TEST_CASE("device memory is predicted before it is taken") {
  Material glass = diffuse(Vec3(0.0F));
  glass.kr = glass.kt = Vec3(1.0F);
  for (const EngineKind engine : {EngineKind::wavefront, EngineKind::megakernel}) {
    for (const Material& ball : {diffuse(Vec3(0.5F)), glass}) {
      for (const std::uint32_t tail_paths : {0U, std::uint32_t{kSize} * kSize}) {
        const RenderStatistics statistics = statistics_of(ball_scene(ball, true), engine, 4, tail_paths);
        const auto peak = static_cast<double>(statistics.peak_device_bytes);
        INFO(statistics.predicted_device_bytes << " predicted, " << peak << " taken, a tail of " << tail_paths);
        CHECK(std::abs(static_cast<double>(statistics.predicted_device_bytes) - peak) < 0.05 * peak);
      }
    }
  }
}

}  // namespace hemiray

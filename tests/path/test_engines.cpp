// The two engines against each other: the same bits in strict builds, a stated bound in fast ones; and what must not,
// or must, change an image: wave size, repetition, seed.
#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "host/path/camera_params.hpp"
#include "host/path/render.hpp"
#include "host/scene/features.hpp"
#include "host/scene/flat_scene.hpp"
#include "host/scene/load.hpp"
#include "tests/path/render_on_device.hpp"
#include "tests/reference/comparison_scenes.hpp"
#include "tests/reference/image_agreement.hpp"

namespace hemiray {
namespace {

using reference::ComparisonScene;

// Fast builds differ by contraction alone: a few ulps a value, hence outright only where a ray passes an edge that
// close.
constexpr double kFastOutlierShare = 0.01;
constexpr double kFastRelMse = 1e-7;
constexpr std::uint32_t kTailPaths = 400;  // of 1189

ReferenceOptions two_samples(ReferenceOptions options) {
  options.spp = 2;
  options.width = 41;  // no multiple of a work-group, nor of anything
  options.height = 29;
  return options;
}

ComparisonScene scene_named(const std::string& name) {
  for (ComparisonScene& item : reference::comparison_scenes()) {
    if (item.name == name) return {item.name, std::move(item.scene), two_samples(item.options)};
  }
  throw std::runtime_error("no scene '" + name + "'");
}

ComparisonScene shipped_scene(const std::string& file) {
  ReferenceOptions options;
  options.depth = 5;
  return {file, load_scene(std::string(HR_SOURCE_DIR) + "/scenes/" + file), two_samples(options)};
}

// Bits that differ between two images, as a message; empty if none does.
std::string first_difference(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height || a.layers.size() != b.layers.size()) return "other size or layers";
  for (std::size_t l = 0; l < a.layers.size(); l++) {
    const Layer& left = a.layers[l];
    const Layer& right = b.layers[l];
    if (left.name != right.name || left.data.size() != right.data.size()) return "other layer " + right.name;
    for (std::size_t i = 0; i < left.data.size(); i++) {
      if (std::bit_cast<std::uint32_t>(left.data[i]) != std::bit_cast<std::uint32_t>(right.data[i])) {
        const std::size_t pixel = i / left.channels.size();
        const auto width = static_cast<std::size_t>(a.width);
        return "layer '" + left.name + "', pixel " + std::to_string(pixel % width) + ", " +
               std::to_string(pixel / width) + ": " + std::to_string(left.data[i]) + " and " +
               std::to_string(right.data[i]);
      }
    }
  }
  return "";
}

bool has_light(const Image& image) {
  for (const float v : image.layers.front().data) {
    if (v > 0.0F && v < 1.0F) return true;
  }
  return false;
}

void check_same_bits(const ComparisonScene& item) {
  const Image wavefront = render_on_device(item.scene, item.options, EngineKind::wavefront, true);
  const Image megakernel = render_on_device(item.scene, item.options, EngineKind::megakernel, true);
  INFO("scene '" << item.name << "', seed " << item.options.seed);
  CHECK(first_difference(wavefront, megakernel) == "");
  // Some rounds of stages, then the walk to the end.
  const Image walked = render_on_device(item.scene, item.options, EngineKind::wavefront, true, kTailPaths);
  CHECK(first_difference(walked, megakernel) == "");
  CHECK(has_light(wavefront));
}

void check_fast_agreement(const ComparisonScene& item) {
  const Image wavefront = render_on_device(item.scene, item.options, EngineKind::wavefront, false);
  const Image megakernel = render_on_device(item.scene, item.options, EngineKind::megakernel, false);
  for (const reference::LayerAgreement& layer : reference::compare_layers(megakernel, wavefront)) {
    INFO("scene '" << item.name << "', layer '" << layer.layer << "'");
    CHECK(layer.outlier_share <= kFastOutlierShare);
    CHECK(layer.rel_mse <= kFastRelMse);
  }
}

// As render_scene() does it, but in waves of `slots` pixels.
Image render_in_waves(const ComparisonScene& item, EngineKind kind, std::uint32_t slots) {
  const ReferenceOptions& options = item.options;
  Context context(choose_device(""));
  const FlatScene flat = flatten_scene(item.scene);
  const std::uint32_t features = features_of(item.scene, flat, options.depth);
  const DeviceScene scene(context, flat, features);
  Parallel parallel(context);
  AccelBuilder builder(context, parallel);
  const Accel accel(builder, scene);
  Film film(context, features, options.width, options.height);
  const auto engine = make_engine(kind, context, parallel, accel.program_options(features, true), slots, options.depth);
  shared::RenderParams params{};
  set_camera(params, item.scene.camera, options.width, options.height);
  params.background = {item.scene.background.x, item.scene.background.y, item.scene.background.z, 0.0F};
  params.ambient = {item.scene.ambient.x, item.scene.ambient.y, item.scene.ambient.z, 0.0F};
  params.samples = static_cast<std::uint32_t>(options.spp);
  params.seed_key = options.seed * 0x9E3779B9U;
  params.max_depth = static_cast<std::uint32_t>(options.depth);
  params.triangle_count = scene.triangle_count();
  params.sphere_count = scene.sphere_count();
  params.shape_count = scene.shape_count();
  params.plane_count = scene.plane_count();
  params.light_count = scene.light_count();
  params.emitter_count = scene.emitter_count();
  params.instance_count = scene.instance_count();
  const std::uint32_t pixels = params.width * params.height;
  for (params.sample = 0; params.sample < params.samples; params.sample++) {
    for (std::uint32_t first = 0; first < pixels; first += slots) {
      const std::uint32_t count = std::min(slots, pixels - first);
      params.first_pixel = first;
      engine->trace(params, count, arguments(scene.shading_arguments(), accel.tree_arguments(), film.aov_arguments()));
      film.accumulate(engine->program().kernel("film_accumulate"), engine->sums(), first, count);
    }
  }
  return film.develop(options.spp);
}

}  // namespace

TEST_CASE("strict engines give the same bits: mirrors, glass and branches") {
  check_same_bits(scene_named("whitted spheres"));
  check_same_bits(scene_named("glass and mirrors"));
}
TEST_CASE("strict engines give the same bits: area lights and emissive rectangles") {
  check_same_bits(scene_named("cornell box, emissive rectangle"));
  check_same_bits(scene_named("light arrays"));
}
TEST_CASE("strict engines give the same bits: emitters and phong shading") {
  check_same_bits(scene_named("emitters"));
  check_same_bits(scene_named("light arrays, phong"));
}
TEST_CASE("strict engines give the same bits: textures, normal maps and an orthographic view") {
  check_same_bits(scene_named("textured meshes"));
  check_same_bits(scene_named("map view"));
}
TEST_CASE("strict engines give the same bits: disks, cylinders, cones and quadrics") {
  check_same_bits(scene_named("analytic shapes"));
  check_same_bits(shipped_scene("analytic_shapes.json"));
}
TEST_CASE("strict engines give the same bits: shipped scenes") {
  check_same_bits(shipped_scene("glass_and_mirror.json"));
  check_same_bits(shipped_scene("light_arrays.json"));
  check_same_bits(shipped_scene("phong_source.json"));
}

TEST_CASE("fast engines agree within their bound") {
  check_fast_agreement(scene_named("whitted spheres"));
  check_fast_agreement(scene_named("cornell box, emissive rectangle"));
  check_fast_agreement(scene_named("textured meshes"));
}

TEST_CASE("waves of any size give the same bits") {
  const ComparisonScene item = scene_named("whitted spheres");
  const Image whole = render_on_device(item.scene, item.options, EngineKind::wavefront, true);
  for (const std::uint32_t slots : {1189U, 1000U, 64U, 7U * 41U}) {  // 1189 pixels: one wave, and three cuts
    INFO(slots << " slots");
    CHECK(first_difference(whole, render_in_waves(item, EngineKind::wavefront, slots)) == "");
    CHECK(first_difference(whole, render_in_waves(item, EngineKind::megakernel, slots)) == "");
  }
}

TEST_CASE("the same render twice gives the same bits, fast builds too") {
  const ComparisonScene item = scene_named("light arrays");
  for (const EngineKind kind : {EngineKind::wavefront, EngineKind::megakernel}) {
    const Image first = render_on_device(item.scene, item.options, kind);
    CHECK(first_difference(first, render_on_device(item.scene, item.options, kind)) == "");
  }
}

TEST_CASE("another seed gives another image of the same geometry") {
  ComparisonScene still = scene_named("whitted spheres");  // nothing random but the places in the pixels
  const Image places = render_on_device(still.scene, still.options);
  still.options.seed++;
  CHECK(places.find("depth")->data != render_on_device(still.scene, still.options).find("depth")->data);
  const ComparisonScene item = scene_named("light arrays");
  ReferenceOptions other = item.options;
  other.seed = item.options.seed + 1;
  const Image first = render_on_device(item.scene, item.options);
  const Image second = render_on_device(item.scene, other);
  CHECK(first_difference(first, second) != "");
  ReferenceOptions single = item.options;  // one sample: pixel centres, so only the jittered lights differ
  single.spp = 1;
  ReferenceOptions single_other = single;
  single_other.seed++;
  const Image a = render_on_device(item.scene, single), b = render_on_device(item.scene, single_other);
  CHECK(first_difference(a, b) != "");
  for (const char* layer : {"depth", "normal", "albedo", "id"}) CHECK(a.find(layer)->data == b.find(layer)->data);
}

}  // namespace hemiray

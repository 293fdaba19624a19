// The Cornell box's radiosity against the path-traced truth: how the walls' colours come to other surfaces.
#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "host/scene/load.hpp"
#include "tests/radiosity/displayed_scene.hpp"
#include "tests/reference/diffuse_reference.hpp"
#include "tests/reference/scene_builder.hpp"

namespace hemiray {
namespace {

using reference::value_at;

// The mesh's error has next to no colour: it is in how light is spread, not in what walls reflect.
constexpr double kRedness = 0.03;
constexpr double kConfidence = 3.3;  // standard errors: all of 27 means lie within, but for one try in forty

// A square of a white surface, seen from so near that nothing is between.
struct Region {
  std::string name;
  DVec3 centre, normal;
  double side_m;
  int bleeding;  // 1: red beyond the lamp's, -1: green, 0: not asked
};

const std::array<Region, 9> kRegions = {{
    {"tall block towards the red wall", {0.4475, 0.165, 0.3265}, {0.159, 0, -0.049}, 0.12, 1},
    {"tall block towards the green wall", {0.2895, 0.165, 0.376}, {-0.16, 0, 0.049}, 0.12, -1},
    {"short block towards the red wall", {0.265, 0.0825, 0.193}, {0.158, 0, 0.05}, 0.12, 1},
    {"short block towards the green wall", {0.106, 0.0825, 0.145}, {-0.16, 0, -0.048}, 0.12, -1},
    {"floor at the red wall", {0.5, 0, 0.15}, {0, 1, 0}, 0.08, 1},
    {"floor at the green wall", {0.045, 0, 0.45}, {0, 1, 0}, 0.08, -1},
    {"ceiling at the red wall", {0.5, 0.5488, 0.28}, {0, -1, 0}, 0.08, 1},
    {"ceiling at the green wall", {0.045, 0.5488, 0.28}, {0, -1, 0}, 0.08, -1},
    {"back wall", {0.15, 0.4, 0.5592}, {0, 0, -1}, 0.1, 0},
}};

Scene looking_at(Scene scene, const Region& region) {
  const DVec3 normal = glm::normalize(region.normal);
  const DVec3 up = std::abs(normal.y) < 0.5 ? DVec3(0, 1, 0) : DVec3(0, 0, 1);
  scene.camera.kind = CameraKind::orthographic;
  scene.camera.height_m = region.side_m;
  scene.camera.to_world = reference::look_at(region.centre + 1e-3 * normal, region.centre, up);
  return scene;
}

DVec3 mean_of(const Image& image, const std::string& layer, int power) {
  DVec3 sum(0.0);
  for (int y = 0; y < image.height; y++) {
    for (int x = 0; x < image.width; x++) {
      for (int c = 0; c < 3; c++) sum[c] += std::pow(value_at(image, layer, x, y, static_cast<std::size_t>(c)), power);
    }
  }
  return sum / static_cast<double>(image.pixel_count());
}

// Red over green, without what the lamp's own colour does to it.
double redness(const DVec3& radiance, const Scene& scene) {
  const Vec3& lamp = scene.lights.at(0).intensity;
  return radiance.x / radiance.y * static_cast<double>(lamp.y) / static_cast<double>(lamp.x);
}

}  // namespace

TEST_CASE("in the Cornell box colours bleed as a path tracer says, within the mesh error that is reported") {
  const Scene scene = load_scene(HR_SOURCE_DIR "/scenes/cornell_box.json");
  Context context(choose_device(""));
  RadiosityOptions options;
  options.mesh.patches = 1000;
  const Radiosity radiosity = compute_radiosity(context, flatten_scene(scene), options);
  const FlatScene patches = lit_patches(radiosity.mesh, radiosity.irradiance);
  const double mesh_error = radiosity.continuous.rms_high / std::numbers::pi;  // as radiance
  for (const Region& region : kRegions) {
    const Scene seen = looking_at(scene, region);
    const ReferenceOptions near{8, 8, 128, 0, 3};
    const Image truth = render_diffuse_reference(seen, near);
    const DVec3 expected = mean_of(truth, "", 1);
    const DVec3 error = glm::sqrt(mean_of(truth, "error", 2) / static_cast<double>(truth.pixel_count()));
    const DVec3 shown = mean_of(test::show_patches(context, seen, patches, {16, 16, 1, 0, 0}), "", 1);
    for (int c = 0; c < 3; c++) {
      INFO(region.name << ", channel " << c << ": shown " << shown[c] << ", path-traced " << expected[c] << " +- "
                       << kConfidence * error[c] << ", mesh error " << mesh_error);
      CHECK(std::abs(shown[c] - expected[c]) < mesh_error + kConfidence * error[c]);
    }
    const double red_shown = redness(shown, scene), red_expected = redness(expected, scene);
    // Paths bring red and green together, so their quotient is no less certain than if they were apart.
    const double spread = red_expected * kConfidence * std::hypot(error.x / expected.x, error.y / expected.y);
    INFO(region.name << ": redness " << red_shown << " shown, " << red_expected << " +- " << spread << " path-traced");
    CHECK(std::abs(red_shown / red_expected - 1.0) < kRedness + spread);
    if (region.bleeding > 0) CHECK(red_expected - spread > 1.0);
    if (region.bleeding < 0) CHECK(red_expected + spread < 1.0);
  }
}

}  // namespace hemiray

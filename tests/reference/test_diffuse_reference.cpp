// The diffuse path tracer against closed forms: interreflection without end, and a lamp.
#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

#include "tests/reference/closed_forms.hpp"
#include "tests/reference/diffuse_reference.hpp"
#include "tests/reference/scene_builder.hpp"

namespace hemiray::reference {

namespace {

// Standard errors: one in 300,000 means of a normal distribution is farther off.
constexpr double kMostErrors = 4.7;

/// Mean of a channel over the picture, and its standard error.
std::pair<double, double> mean_of(const Image& image, std::size_t c) {
  double sum = 0.0, variance = 0.0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      sum += value_at(image, "", x, y, c);
      variance += std::pow(value_at(image, "error", x, y, c), 2);
    }
  }
  const auto count = static_cast<double>(image.pixel_count());
  return {sum / count, std::sqrt(variance) / count};
}

void check_mean(const Image& image, std::size_t c, double expected) {
  const auto [mean, error] = mean_of(image, c);
  CAPTURE(c, mean, error, expected);
  CHECK(error < 0.01 * expected);  // else the next line says little
  CHECK(std::abs(mean - expected) < kMostErrors * error);
}

}  // namespace

TEST_CASE("in a sphere around a point light, light gathers as rho / (1 - rho)") {
  Scene scene = empty_scene({0.5, 0.2, -0.3}, {1, 0, 0});
  const DVec3 rho(0.9, 0.5, 0.1);
  add_sphere(scene, {0, 0, 0}, 2.0, add_material(scene, diffuse(Vec3(rho))));
  add_point_light(scene, {0, 0, 0}, Vec3(3.0F));
  const Image image = render_diffuse_reference(scene, {8, 8, 512, 0, 11});
  for (int c = 0; c < 3; ++c) {
    const double expected = 3.0 / 4.0 * rho[c] / (1.0 - rho[c]) / std::numbers::pi;
    check_mean(image, static_cast<std::size_t>(c), expected);
  }
}

TEST_CASE("a lamp lights the floor under its corner by the closed form, however its array is set") {
  Scene scene = empty_scene({0, 0.5, 0}, {0, 0, 0});
  scene.camera.to_world = look_at({0, 0.5, 0}, {0, 0, 0}, {0, 0, -1});
  scene.camera.kind = CameraKind::orthographic;
  scene.camera.height_m = 1e-4;
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, add_material(scene, diffuse(Vec3(0.5F))));
  Light& lamp = add_area_light(scene, {0, 1, 0}, {2, 0, 0}, {0, 0, 1}, Vec3(7.0F));
  lamp.samples_u = 1;
  lamp.samples_v = 1;
  lamp.jitter = false;
  const Image image = render_diffuse_reference(scene, {4, 4, 1024, 0, 5});
  check_mean(image, 0, 0.5 / std::numbers::pi * corner_irradiance_parallel(7.0, 2.0, 1.0, 1.0));
}

}  // namespace hemiray::reference

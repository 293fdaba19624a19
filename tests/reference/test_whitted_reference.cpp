// The oracle's rays against closed forms: silhouettes, mirrors, refraction, depth, energy; no device is used.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "host/base/error.hpp"
#include "tests/reference/closed_forms.hpp"
#include "tests/reference/scene_builder.hpp"
#include "tests/reference/whitted_reference.hpp"

namespace hemiray::reference {

namespace {

// The images are float: a value of order one carries 6e-8, sums of layers a few times that.
constexpr double kFloatImage = 1e-6;

/// Direction of the centre of pixel (x, y) in camera space, written down from the definition of the field of view.
DVec3 pixel_direction(int x, int y, int width, int height, double fov_y_deg) {
  const double focal = height / 2.0 / std::tan(fov_y_deg * std::numbers::pi / 360.0);
  return glm::normalize(DVec3(x + 0.5 - width / 2.0, height / 2.0 - y - 0.5, -focal));
}

/// An orthographic camera at height 50 that looks straight down on a square of `height_m`; +x right, -z up.
Scene map_scene(double height_m) {
  Scene scene = empty_scene({0, 50, 0}, {0, 0, 0});
  scene.camera.to_world = look_at({0, 50, 0}, {0, 0, 0}, {0, 0, -1});
  scene.camera.kind = CameraKind::orthographic;
  scene.camera.height_m = height_m;
  return scene;
}

/// A floor at height y whose ambient colour tells the place: R = (x + s) / 2s, G = (z + s) / 2s for half size s.
void add_position_coded_floor(Scene& scene, double y, double s) {
  const std::uint32_t material = add_material(scene, diffuse(Vec3(1.0F)));
  add_rectangle(scene, {-s, y, s}, {2 * s, 0, 0}, {0, 0, -2 * s}, material);
  scene.meshes.back().colors = {{0, 1, 0}, {1, 1, 0}, {1, 0, 0}, {0, 0, 0}};
  scene.ambient = Vec3(1.0F);
}

}  // namespace

TEST_CASE("a sphere covers exactly the pixels of its silhouette cone") {
  constexpr int kWidth = 96;
  constexpr int kHeight = 64;
  const DVec3 eye(1, 2, 9);
  Scene scene = empty_scene(eye, {0.5, 1.0, 0.0}, 50.0);
  const std::uint32_t white = add_material(scene, diffuse(Vec3(1.0F)));
  add_sphere(scene, {1.5, 0.5, 1.0}, 1.7, white);
  const Image image = render_reference(scene, {kWidth, kHeight, 1, 0, 0});
  const DVec3 center = glm::inverse(scene.camera.to_world) * glm::dvec4(1.5, 0.5, 1.0, 1.0);
  int covered = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool inside = inside_sphere_silhouette(pixel_direction(x, y, kWidth, kHeight, 50.0), center, 1.7);
      INFO("pixel " << x << ", " << y);
      REQUIRE(value_at(image, "id", x, y) == (inside ? 1.0 : 0.0));
      REQUIRE(value_at(image, "", x, y, 3) == (inside ? 1.0 : 0.0));
      covered += inside ? 1 : 0;
    }
  }
  REQUIRE(covered > 300);
}

TEST_CASE("an axial sphere covers a disc of the radius of the closed form") {
  Scene scene = empty_scene({0, 0, 5}, {0, 0, 0}, 40.0);
  add_sphere(scene, {0, 0, 0}, 1.0, add_material(scene, diffuse(Vec3(1.0F))));
  const Image image = render_reference(scene, {128, 128, 1, 0, 0});
  int covered = 0;
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 128; ++x) covered += value_at(image, "id", x, y) > 0.0 ? 1 : 0;
  }
  const double radius = silhouette_radius_pixels(5.0, 1.0, 40.0, 128);
  // Pixel centres in a disc: Gauss's circle problem leaves an error well below the circumference.
  REQUIRE(std::abs(covered - std::numbers::pi * radius * radius) < radius);
}

TEST_CASE("depth, normal and id of a sphere seen head on") {
  Scene scene = empty_scene({0, 0, 5}, {0, 0, 0}, 40.0);
  add_rectangle(scene, {-9, -9, -3}, {18, 0, 0}, {0, 18, 0}, add_material(scene, diffuse({0.2F, 0.4F, 0.6F})));
  add_sphere(scene, {0, 0, 0}, 1.0, add_material(scene, diffuse(Vec3(1.0F))));
  const Image image = render_reference(scene, {33, 33, 1, 0, 0});
  REQUIRE(value_at(image, "depth", 16, 16) == Approx(4.0).epsilon(kFloatImage));
  REQUIRE(value_at(image, "normal", 16, 16, 2) == Approx(1.0).epsilon(kFloatImage));
  REQUIRE(value_at(image, "id", 16, 16) == 2.0);
  REQUIRE(value_at(image, "id", 0, 0) == 1.0);
  REQUIRE(value_at(image, "albedo", 0, 0, 2) == Approx(0.6).epsilon(kFloatImage));
  REQUIRE(value_at(image, "depth", 0, 0) == Approx(-8.0 / pixel_direction(0, 0, 33, 33, 40.0).z).epsilon(kFloatImage));
}

TEST_CASE("refraction bends by the law of Snell into and out of water") {
  constexpr double kIndex = 1.33;
  constexpr double kDepth = 2.0;
  for (const bool entering : {true, false}) {
    Scene scene = empty_scene({0, 3, 0}, {2.5, 0, 0}, 30.0);
    Material water = glass(static_cast<float>(kIndex));
    water.fresnel = false;
    water.kr = Vec3(0.0F);
    // Seen from its back the surface leads from the denser side out.
    add_plane(scene, {0, 0, 0}, {0, entering ? 1.0 : -1.0, 0}, add_material(scene, water));
    add_position_coded_floor(scene, -kDepth, 40.0);
    const Image image = render_reference(scene, {16, 16, 1, 4, 0});
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 16; ++x) {
        const DVec3 d = glm::dmat3(scene.camera.to_world) * pixel_direction(x, y, 16, 16, 30.0);
        const double sideways = std::hypot(d.x, d.z);
        const double angle_in = std::atan2(sideways, -d.y);
        const double index = static_cast<double>(static_cast<float>(kIndex));
        const double angle_out = entering ? snell_angle(angle_in, 1.0, index) : snell_angle(angle_in, index, 1.0);
        INFO("pixel " << x << ", " << y << (entering ? " entering" : " leaving"));
        if (std::isnan(angle_out)) {
          REQUIRE(value_at(image, "", x, y) == 0.0);
          continue;
        }
        const double reach = 3.0 * std::tan(angle_in) + kDepth * std::tan(angle_out);
        if (reach * std::max(std::abs(d.x), std::abs(d.z)) / sideways > 39.0) continue;
        REQUIRE(value_at(image, "refraction", x, y, 0) == Approx((reach * d.x / sideways + 40.0) / 80.0).margin(2e-6));
        REQUIRE(value_at(image, "refraction", x, y, 1) == Approx((reach * d.z / sideways + 40.0) / 80.0).margin(2e-6));
      }
    }
  }
}

TEST_CASE("a mirror shows what the mirrored camera would see") {
  const DVec3 eye(1, 2, 6);
  Scene scene = empty_scene(eye, {0, 1, 0}, 40.0);
  const DVec3 normal = glm::normalize(DVec3(0.3, -0.1, 1.0));
  add_plane(scene, {0, 0, -1}, normal, add_material(scene, mirror(1.0F)));
  add_position_coded_floor(scene, -3.0, 60.0);
  const Image image = render_reference(scene, {24, 24, 1, 1, 0});
  const DVec3 mirrored_eye = mirrored_point(eye, {0, 0, -1}, normal);
  int checked = 0;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) {
      if (value_at(image, "id", x, y) != 2.0) continue;  // the floor itself is in front here
      const DVec3 d = glm::dmat3(scene.camera.to_world) * pixel_direction(x, y, 24, 24, 40.0);
      const DVec3 mirrored = mirrored_point(eye + d, {0, 0, -1}, normal) - mirrored_eye;
      const double t = (-3.0 - mirrored_eye.y) / mirrored.y;
      const DVec3 seen = mirrored_eye + t * mirrored;
      if (t <= 0.0 || std::max(std::abs(seen.x), std::abs(seen.z)) > 59.0) continue;
      ++checked;
      INFO("pixel " << x << ", " << y);
      REQUIRE(value_at(image, "reflection", x, y, 0) == Approx((seen.x + 60.0) / 120.0).margin(2e-6));
      REQUIRE(value_at(image, "reflection", x, y, 1) == Approx((seen.z + 60.0) / 120.0).margin(2e-6));
    }
  }
  REQUIRE(checked > 100);
}

TEST_CASE("reflection and refraction at glass have the shares of Fresnel") {
  for (const bool entering : {true, false}) {
    Scene scene = empty_scene({0, 1, 0}, {1, 0, 0}, 80.0);
    scene.background = Vec3(1.0F);
    add_plane(scene, {0, 0, 0}, {0, entering ? 1.0 : -1.0, 0}, add_material(scene, glass(1.5F)));
    const Image image = render_reference(scene, {24, 24, 1, 1, 0});
    int total = 0;
    for (int y = 0; y < 24; ++y) {
      for (int x = 0; x < 24; ++x) {
        if (value_at(image, "id", x, y) == 0.0) continue;
        const DVec3 d = glm::dmat3(scene.camera.to_world) * pixel_direction(x, y, 24, 24, 80.0);
        const double share = fresnel_from_angles(std::acos(-d.y), entering ? 1.0 : 1.5, entering ? 1.5 : 1.0);
        total += share == 1.0 ? 1 : 0;
        INFO("pixel " << x << ", " << y << " share " << share);
        REQUIRE(value_at(image, "reflection", x, y) == Approx(share).margin(kFloatImage));
        REQUIRE(value_at(image, "refraction", x, y) == Approx(1.0 - share).margin(kFloatImage));
        REQUIRE(value_at(image, "direct", x, y) == 0.0);
      }
    }
    REQUIRE((total > 0) == !entering);
  }
}

TEST_CASE("a glass ball in a white room loses only what the depth limit cuts") {
  // Every inner hit of one path meets the sphere at the same angle: after D bounces (1 - R) R^(D-1) is still inside.
  Scene scene = empty_scene({0, 0, 5}, {0, 0, 0}, 20.0);
  scene.background = Vec3(1.0F);
  add_sphere(scene, {0, 0, 0}, 1.0, add_material(scene, glass(1.5F)));
  for (const int depth : {1, 2, 5}) {
    const Image image = render_reference(scene, {16, 16, 1, depth, 0});
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 16; ++x) {
        const DVec3 d = pixel_direction(x, y, 16, 16, 20.0);
        const double miss_distance = 5.0 * std::sqrt(1.0 - d.z * d.z);
        const bool hit = miss_distance < 1.0;
        const double share = hit ? fresnel_from_angles(std::asin(miss_distance), 1.0, 1.5) : 0.0;
        INFO("pixel " << x << ", " << y << " depth " << depth);
        REQUIRE(value_at(image, "", x, y) ==
                Approx(hit ? 1.0 - (1.0 - share) * std::pow(share, depth - 1) : 1.0).margin(kFloatImage));
      }
    }
  }
}

TEST_CASE("two facing mirrors add a geometric series up to the depth") {
  Scene scene = empty_scene({0, 0, 0}, {0, 0, -1}, 20.0);
  Material shining = mirror(0.5F);
  shining.emission = Vec3(1.0F, 2.0F, 4.0F);
  const std::uint32_t material = add_material(scene, shining);
  add_plane(scene, {0, 0, -1}, {0, 0, 1}, material);
  add_plane(scene, {0, 0, 1}, {0, 0, -1}, material);
  for (const int depth : {0, 1, 3, 10}) {
    const Image image = render_reference(scene, {4, 4, 1, depth, 0});
    const double expected = (1.0 - std::pow(0.5, depth + 1)) / 0.5;
    REQUIRE(value_at(image, "", 1, 2, 0) == Approx(expected).epsilon(kFloatImage));
    REQUIRE(value_at(image, "", 1, 2, 2) == Approx(4.0 * expected).epsilon(kFloatImage));
    REQUIRE(value_at(image, "direct", 1, 2) == Approx(1.0).epsilon(kFloatImage));
    if (depth == 0) REQUIRE(value_at(image, "reflection", 1, 2) == 0.0);
  }
}

TEST_CASE("without Fresnel kr and kt are constant and total reflection stops only the transmitted ray") {
  Scene scene = empty_scene({0, 1, 0}, {3, 0, 0}, 10.0);
  scene.background = Vec3(1.0F);
  Material material = glass(1.5F);
  material.fresnel = false;
  material.kr = Vec3(0.25F);
  material.kt = Vec3(0.5F);
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, add_material(scene, material));
  Image image = render_reference(scene, {4, 4, 1, 1, 0});
  REQUIRE(value_at(image, "reflection", 2, 2) == Approx(0.25).epsilon(kFloatImage));
  REQUIRE(value_at(image, "refraction", 2, 2) == Approx(0.5).epsilon(kFloatImage));
  scene.planes[0].normal = {0, -1, 0};  // now seen from inside, at 72 degrees
  image = render_reference(scene, {4, 4, 1, 1, 0});
  REQUIRE(value_at(image, "reflection", 2, 2) == Approx(0.25).epsilon(kFloatImage));
  REQUIRE(value_at(image, "refraction", 2, 2) == 0.0);
}

TEST_CASE("a convex emitter box is seen from outside only") {
  Scene scene = empty_scene({0, 0, 5}, {0, 0, 0}, 30.0);
  scene.background = Vec3(0.125F);
  const std::uint32_t lamp = add_material(scene, emissive(Vec3(3.0F)));
  const std::size_t box = add_box(scene, {-1, -1, -1}, {1, 1, 1}, lamp);
  Image image = render_reference(scene, {8, 8, 1, 2, 0});
  REQUIRE(value_at(image, "", 4, 4) == 3.0);
  // A mirroring transform must not turn the surface inside out.
  scene.objects[box].to_world[0][0] = -1.0;
  image = render_reference(scene, {8, 8, 1, 2, 0});
  REQUIRE(value_at(image, "", 4, 4) == 3.0);
  scene.camera.to_world = look_at({0, 0, 0}, {0, 0, -1});
  image = render_reference(scene, {8, 8, 1, 2, 0});
  REQUIRE(value_at(image, "", 4, 4) == 0.0);
}

TEST_CASE("an orthographic camera draws a map to scale") {
  Scene scene = map_scene(8.0);
  add_position_coded_floor(scene, 0.0, 4.0);
  const Image image = render_reference(scene, {16, 16, 1, 0, 0});
  for (int i = 0; i < 16; ++i) {
    REQUIRE(value_at(image, "", i, 3, 0) == Approx((i + 0.5) / 16.0).margin(kFloatImage));
    REQUIRE(value_at(image, "", 3, i, 1) == Approx((i + 0.5) / 16.0).margin(kFloatImage));
    REQUIRE(value_at(image, "depth", i, i) == Approx(50.0).epsilon(kFloatImage));
  }
}

TEST_CASE("a normal map cannot turn a mirrored ray into the mirror") {
  Scene scene = empty_scene({-6, 8, 0}, {0, 0, 0}, 2.0);
  scene.background = Vec3(1.0F);
  Material tilted = mirror(1.0F);
  // 60 degrees towards +u, which runs along +x: mirrored there, the view ray would go down through the floor.
  tilted.normal_texture =
      add_texture(scene, 1, ColorSpace::linear, [](int, int) { return glm::u8vec3(238, 128, 191); });
  add_rectangle(scene, {-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, add_material(scene, tilted));
  add_plane(scene, {0, -1, 0}, {0, 1, 0}, add_material(scene, emissive(Vec3(4.0F))));
  const Image image = render_reference(scene, {4, 4, 1, 1, 0});
  REQUIRE(value_at(image, "id", 2, 2) == 1.0);
  REQUIRE(value_at(image, "normal", 2, 2, 0) == Approx(0.866).margin(0.01));
  REQUIRE(value_at(image, "reflection", 2, 2) == 1.0);
}

TEST_CASE("options out of range are refused") {
  const Scene scene = empty_scene({0, 0, 5}, {0, 0, 0});
  REQUIRE_THROWS_AS(render_reference(scene, {0, 4, 1, 1, 0}), InputError);
  REQUIRE_THROWS_AS(render_reference(scene, {4, 4, 0, 1, 0}), InputError);
  REQUIRE_THROWS_AS(render_reference(scene, {4, 4, 1, -1, 0}), InputError);
}

}  // namespace hemiray::reference

// The renderer against closed forms: silhouettes, inverse square, Snell, Fresnel, mirrored positions, area lights.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "host/path/render.hpp"
#include "tests/path/render_on_device.hpp"
#include "tests/reference/closed_forms.hpp"
#include "tests/reference/scene_builder.hpp"

namespace hemiray {

namespace {

using namespace reference;

constexpr double kPi = std::numbers::pi;

// A radiance computed from some ten float operations on rounded inputs: 2e-7 each at worst.
constexpr double kFloatRadiance = 5e-6;

// A hit position on a floor of 80 m, as a colour in [0,1]: float positions of tens of metres and their directions are
// good to some 1e-6 of the distance; grazing rays stretch that.
constexpr double kFloatPlace = 2e-5;

// Fresnel's formula cancels near the critical angle, where its slope is unbounded.
constexpr double kFloatFresnel = 2e-4;

DVec3 pixel_direction(int x, int y, int width, int height, double fov_y_deg) {
  const double focal = height / 2.0 / std::tan(fov_y_deg * kPi / 360.0);
  return glm::normalize(DVec3(x + 0.5 - width / 2.0, height / 2.0 - y - 0.5, -focal));
}

/// A floor at height y whose ambient colour tells the place: R = (x + 40) / 80, G = (z + 40) / 80.
void add_position_coded_floor(Scene& scene, double y) {
  const std::uint32_t material = add_material(scene, diffuse(Vec3(1.0F)));
  add_rectangle(scene, {-40, y, 40}, {80, 0, 0}, {0, 0, -80}, material);
  scene.meshes.back().colors = {{0, 1, 0}, {1, 1, 0}, {1, 0, 0}, {0, 0, 0}};
  scene.ambient = Vec3(1.0F);
}

/// An orthographic view down on a white floor of 4 m x 4 m.
Scene floor_scene() {
  Scene scene = empty_scene({0, 0.5, 0}, {0, 0, 0});
  scene.camera.to_world = look_at({0, 0.5, 0}, {0, 0, 0}, {0, 0, -1});
  scene.camera.kind = CameraKind::orthographic;
  scene.camera.height_m = 4.0;
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, add_material(scene, diffuse(Vec3(1.0F))));
  return scene;
}

DVec3 floor_point(int x, int y) { return {4.0 * (x + 0.5) / 16 - 2.0, 0.0, 4.0 * (y + 0.5) / 16 - 2.0}; }

template <class Expected>
void require_floor_irradiance(const Scene& scene, double tolerance, const Expected& expected) {
  const Image image = render_on_device(scene, {16, 16, 1, 0, 0});
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      INFO("pixel " << x << ", " << y);
      REQUIRE(kPi * value_at(image, "", x, y) == Approx(expected(floor_point(x, y))).epsilon(tolerance));
    }
  }
}

}  // namespace

TEST_CASE("device: the silhouette of a sphere is its cone") {
  Scene scene = empty_scene({1, 2, 9}, {0.5, 1.0, 0.0}, 50.0);
  const DVec3 center_world(1.5, 0.5, 1.0);
  add_sphere(scene, center_world, 1.7, add_material(scene, diffuse(Vec3(1.0F))));
  const DVec3 center = glm::inverse(scene.camera.to_world) * glm::dvec4(center_world, 1.0);
  const Image image = render_on_device(scene, {96, 64, 1, 0, 0});
  int covered = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      const DVec3 d = pixel_direction(x, y, 96, 64, 50.0);
      // Within a few float ulps of the edge either answer is right.
      const bool surely_inside = inside_sphere_silhouette(d, center, 1.7 * (1.0 - 1e-5));
      const bool surely_outside = !inside_sphere_silhouette(d, center, 1.7 * (1.0 + 1e-5));
      INFO("pixel " << x << ", " << y);
      if (surely_inside) REQUIRE(value_at(image, "id", x, y) == 1.0);
      if (surely_outside) REQUIRE(value_at(image, "id", x, y) == 0.0);
      covered += surely_inside ? 1 : 0;
    }
  }
  REQUIRE(covered > 300);
}

TEST_CASE("device: irradiance of a point light falls with the square of the distance") {
  Scene scene = floor_scene();
  const DVec3 light(0.5, 3.0, -0.25);
  add_point_light(scene, light, Vec3(20.0F));
  require_floor_irradiance(scene, kFloatRadiance, [&](const DVec3& p) {
    const double distance = glm::distance(light, p);
    return point_irradiance(20.0, distance, light.y / distance);
  });
}

TEST_CASE("device: a fine regular array gives the irradiance of the rectangle") {
  Scene scene = floor_scene();
  Light& light = add_area_light(scene, {-0.5, 2, -0.6}, {1.2, 0, 0}, {0, 0, 1.0}, Vec3(10.0F));
  light.samples_u = light.samples_v = 16;
  light.jitter = false;
  const std::vector<DVec3> corners{{-0.5, 2, -0.6}, {0.7, 2, -0.6}, {0.7, 2, 0.4}, {-0.5, 2, 0.4}};
  // The midpoint rule with cells of 7 cm seen from 2 m: (0.07 / 2)^2 times a constant below one.
  require_floor_irradiance(scene, 1e-3, [&](const DVec3& p) {
    return polygon_irradiance(10.0, corners, p, {0, 1, 0});
  });
}

TEST_CASE("device: every array size conserves the power of the light") {
  for (const auto& [n, m] : {std::pair{1, 1}, {2, 2}, {4, 3}, {5, 5}}) {
    for (const bool jitter : {false, true}) {
      Scene scene = floor_scene();
      scene.camera.height_m = 0.2;
      Light& light = add_area_light(scene, {-0.1, 10.0, -0.1}, {0.2, 0, 0}, {0, 0, 0.2}, Vec3(100.0F));
      light.samples_u = n;
      light.samples_v = m;
      light.jitter = jitter;
      INFO(n << " x " << m << (jitter ? " jittered" : " regular"));
      // Far away the array is one point source of radiance times area; the rest is (size / distance)^2.
      REQUIRE(kPi * value_at(render_on_device(scene, {16, 16, 1, 0, 0}), "", 8, 8) == Approx(0.04).epsilon(0.001));
    }
  }
}

TEST_CASE("device: a mirror shows what the mirrored camera would see") {
  const DVec3 eye(1, 2, 6);
  Scene scene = empty_scene(eye, {0, 1, 0}, 40.0);
  const DVec3 normal = glm::normalize(DVec3(0.3, -0.1, 1.0));
  add_plane(scene, {0, 0, -1}, normal, add_material(scene, mirror(1.0F)));
  add_position_coded_floor(scene, -3.0);
  const Image image = render_on_device(scene, {24, 24, 1, 1, 0});
  const DVec3 mirrored_eye = mirrored_point(eye, {0, 0, -1}, normal);
  int checked = 0;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) {
      if (value_at(image, "id", x, y) != 2.0) continue;  // the floor itself is in front here
      const DVec3 d = glm::dmat3(scene.camera.to_world) * pixel_direction(x, y, 24, 24, 40.0);
      const DVec3 mirrored = mirrored_point(eye + d, {0, 0, -1}, normal) - mirrored_eye;
      const double t = (-3.0 - mirrored_eye.y) / mirrored.y;
      const DVec3 seen = mirrored_eye + t * mirrored;
      if (t <= 0.0 || std::max(std::abs(seen.x), std::abs(seen.z)) > 39.0) continue;
      ++checked;
      INFO("pixel " << x << ", " << y);
      REQUIRE(value_at(image, "reflection", x, y, 0) == Approx((seen.x + 40.0) / 80.0).margin(kFloatPlace));
      REQUIRE(value_at(image, "reflection", x, y, 1) == Approx((seen.z + 40.0) / 80.0).margin(kFloatPlace));
    }
  }
  REQUIRE(checked > 100);
}

TEST_CASE("device: refraction bends by the law of Snell and stops beyond the critical angle") {
  for (const bool entering : {true, false}) {
    Scene scene = empty_scene({0, 3, 0}, {2.5, 0, 0}, 30.0);
    Material water = glass(1.33F);
    water.fresnel = false;
    water.kr = Vec3(0.0F);
    add_plane(scene, {0, 0, 0}, {0, entering ? 1.0 : -1.0, 0}, add_material(scene, water));
    add_position_coded_floor(scene, -2.0);
    const Image image = render_on_device(scene, {16, 16, 1, 4, 0});
    int bent = 0;
    int stopped = 0;
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 16; ++x) {
        const DVec3 d = glm::dmat3(scene.camera.to_world) * pixel_direction(x, y, 16, 16, 30.0);
        const double sideways = std::hypot(d.x, d.z);
        const double angle_in = std::atan2(sideways, -d.y);
        const double angle_out = entering ? snell_angle(angle_in, 1.0, 1.33) : snell_angle(angle_in, 1.33, 1.0);
        INFO("pixel " << x << ", " << y << (entering ? " entering" : " leaving"));
        if (std::isnan(angle_out)) {
          REQUIRE(value_at(image, "refraction", x, y) == 0.0);
          ++stopped;
          continue;
        }
        const double reach = 3.0 * std::tan(angle_in) + 2.0 * std::tan(angle_out);
        // Close to the critical angle the slope of the law is unbounded.
        if (angle_out > 1.4 || reach > 39.0) continue;
        ++bent;
        REQUIRE(value_at(image, "refraction", x, y, 0) ==
                Approx((reach * d.x / sideways + 40.0) / 80.0).margin(kFloatPlace));
        REQUIRE(value_at(image, "refraction", x, y, 1) ==
                Approx((reach * d.z / sideways + 40.0) / 80.0).margin(kFloatPlace));
      }
    }
    REQUIRE(bent > 50);
    REQUIRE((stopped > 0) == !entering);
  }
}

TEST_CASE("device: reflection and refraction at glass have the shares of Fresnel") {
  for (const bool entering : {true, false}) {
    Scene scene = empty_scene({0, 1, 0}, {1, 0, 0}, 80.0);
    scene.background = Vec3(1.0F);
    add_plane(scene, {0, 0, 0}, {0, entering ? 1.0 : -1.0, 0}, add_material(scene, glass(1.5F)));
    const Image image = render_on_device(scene, {24, 24, 1, 1, 0});
    for (int y = 0; y < 24; ++y) {
      for (int x = 0; x < 24; ++x) {
        const DVec3 d = glm::dmat3(scene.camera.to_world) * pixel_direction(x, y, 24, 24, 80.0);
        if (d.y > -1e-4) continue;  // at or above the horizon
        const double share = fresnel_from_angles(std::acos(-d.y), entering ? 1.0 : 1.5, entering ? 1.5 : 1.0);
        INFO("pixel " << x << ", " << y << (entering ? " entering" : " leaving"));
        REQUIRE(value_at(image, "reflection", x, y) == Approx(share).margin(kFloatFresnel));
        REQUIRE(value_at(image, "refraction", x, y) == Approx(1.0 - share).margin(kFloatFresnel));
        REQUIRE(value_at(image, "", x, y) == Approx(1.0).epsilon(kFloatRadiance));
      }
    }
  }
}

TEST_CASE("no light from outside reaches the inside of a closed sphere") {
  Scene scene = empty_scene({0, 0, 0.5}, {0, 0, -1}, 90.0);
  add_sphere(scene, {0, 0, 0}, 1.0, add_material(scene, diffuse(Vec3(1.0F))));
  add_point_light(scene, {3, 4, -5}, Vec3(1000.0F));
  for (const EngineKind engine : {EngineKind::wavefront, EngineKind::megakernel}) {
    const Image dark = render_on_device(scene, {16, 16, 1, 0, 0}, engine);
    Scene lit = scene;
    lit.lights.front().position = {0, 0, 0};
    const Image bright = render_on_device(lit, {16, 16, 1, 0, 0}, engine);
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 16; ++x) {
        CHECK(value_at(dark, "", x, y) == 0.0);
        // From the middle the wall is 1 m away and faced squarely.
        CHECK(kPi * value_at(bright, "", x, y) == Approx(1000.0).epsilon(1e-4));
      }
    }
  }
}

namespace {

/// Of the pixels that the smooth surface turns to the light: the share that is black, and the largest relative
/// difference of the others from Lambert's cosine law.
struct Terminator {
  double black = 0.0, difference = 0.0;
};

Terminator terminator_of_ball(bool smooth) {
  Scene scene = empty_scene({0, 0, 3}, {0, 0, 0}, 40.0);
  add_smooth_ball(scene, {0, 0, 0}, 1.0, 8, add_material(scene, diffuse(Vec3(1.0F))));
  Light light;
  light.kind = LightKind::directional;
  light.direction = glm::normalize(DVec3(-1, 0, 0.3));  // its horizon goes through triangles
  scene.lights.push_back(light);
  RenderOptions options;
  options.width = options.height = 96;
  options.spp = 1;
  options.smooth_terminator = smooth;
  Context context(choose_device(""));
  const Image image = render_scene(context, scene, options).image;
  Terminator result;
  int turned = 0, black = 0;
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 96; ++x) {
      const DVec3 normal(value_at(image, "normal", x, y, 0), value_at(image, "normal", x, y, 1),
                         value_at(image, "normal", x, y, 2));
      const double cosine = glm::dot(normal, -light.direction);
      if (value_at(image, "id", x, y) == 0.0 || cosine < 0.05) continue;
      turned++;
      const double radiance = kPi * value_at(image, "", x, y);
      if (radiance == 0.0) {
        black++;
      } else {
        result.difference = std::max(result.difference, std::abs(radiance / cosine - 1.0));
      }
    }
  }
  REQUIRE(turned > 1000);
  result.black = static_cast<double>(black) / turned;
  return result;
}

}  // namespace

TEST_CASE("a coarse ball with smooth normals is lit up to its smooth horizon, not to its triangles'") {
  const Terminator smooth = terminator_of_ball(true), hard = terminator_of_ball(false);
  INFO("black: " << smooth.black << " with, " << hard.black << " without the lift of shadow rays");
  CHECK(smooth.black == 0.0);
  CHECK(smooth.difference < kFloatRadiance);
  CHECK(hard.black > 0.02);
}

}  // namespace hemiray

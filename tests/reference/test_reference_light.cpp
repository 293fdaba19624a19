// The oracle's lights and shading against closed forms: inverse square, area light integrals, furnaces, emitters.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tests/reference/closed_forms.hpp"
#include "tests/reference/reference_random.hpp"
#include "tests/reference/scene_builder.hpp"
#include "tests/reference/whitted_reference.hpp"

namespace hemiray::reference {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFloatImage = 1e-6;  // float pixels of order one
constexpr int kSize = 16;

/// An orthographic camera from below the lights onto a white floor at y = 0 of 4 m x 4 m; pixel (x, y) sees
/// floor_point.
Scene floor_scene() {
  Scene scene = empty_scene({0, 0.5, 0}, {0, 0, 0});
  scene.camera.to_world = look_at({0, 0.5, 0}, {0, 0, 0}, {0, 0, -1});
  scene.camera.kind = CameraKind::orthographic;
  scene.camera.height_m = 4.0;
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, add_material(scene, diffuse(Vec3(1.0F))));
  return scene;
}

DVec3 floor_point(int x, int y) { return {4.0 * (x + 0.5) / kSize - 2.0, 0.0, 4.0 * (y + 0.5) / kSize - 2.0}; }

Image render_floor(const Scene& scene, int spp = 1) { return render_reference(scene, {kSize, kSize, spp, 0, 7}); }

/// Largest relative deviation of the floor's irradiance (pi times the beauty of a white floor) from `expected(point)`.
template <class Expected>
double largest_deviation(const Image& image, const Expected& expected) {
  double largest = 0.0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double wanted = expected(floor_point(x, y));
      largest = std::max(largest, std::abs(kPi * value_at(image, "", x, y) - wanted) / wanted);
    }
  }
  return largest;
}

/// Mean over the floor of irradiance divided by `expected(point)`, and the standard error of that mean.
template <class Expected>
std::pair<double, double> mean_ratio(const Image& image, const Expected& expected) {
  double sum = 0.0;
  double sum_squares = 0.0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double ratio = kPi * value_at(image, "", x, y) / expected(floor_point(x, y));
      sum += ratio;
      sum_squares += ratio * ratio;
    }
  }
  constexpr double kCount = kSize * kSize;
  const double mean = sum / kCount;
  return {mean, std::sqrt((sum_squares / kCount - mean * mean) / kCount)};
}

/// Five standard errors: one false alarm in two million.
bool agrees(const std::pair<double, double>& mean_and_error) {
  return mean_and_error.second < 0.02 && std::abs(mean_and_error.first - 1.0) < 5.0 * mean_and_error.second;
}

}  // namespace

TEST_CASE("a point light falls off with the square of the distance and the cosine") {
  Scene scene = floor_scene();
  add_point_light(scene, {0.5, 3.0, -0.25}, Vec3(20.0F));
  const DVec3 light(0.5, 3.0, -0.25);
  REQUIRE(largest_deviation(render_floor(scene), [&](const DVec3& p) {
            const double distance = glm::distance(light, p);
            return point_irradiance(20.0, distance, light.y / distance);
          }) < kFloatImage);
}

TEST_CASE("a directional light is constant and a spot follows its cone") {
  Scene scene = floor_scene();
  const DVec3 direction = glm::normalize(DVec3(1, -2, 0.5));
  Light& sun = add_point_light(scene, {0, 0, 0}, Vec3(5.0F));
  sun.kind = LightKind::directional;
  sun.direction = direction;
  REQUIRE(largest_deviation(render_floor(scene), [&](const DVec3&) { return 5.0 * -direction.y; }) < kFloatImage);

  Light& spot = scene.lights[0];
  spot.kind = LightKind::spot;
  spot.position = {0, 2, 0};
  spot.direction = {0, -1, 0};
  spot.inner_angle_deg = 15.0;
  spot.outer_angle_deg = 40.0;
  const Image image = render_floor(scene);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const DVec3 p = floor_point(x, y);
      const double distance = glm::length(DVec3(p.x, 2.0, p.z));
      const double cosine = 2.0 / distance;
      const double inner = std::cos(15.0 * kPi / 180.0);
      const double outer = std::cos(40.0 * kPi / 180.0);
      const double share = std::min(1.0, std::max(0.0, (cosine - outer) / (inner - outer)));
      REQUIRE(kPi * value_at(image, "", x, y) ==
              Approx(5.0 * share * share * cosine / (distance * distance)).margin(kFloatImage));
    }
  }
}

TEST_CASE("regular arrays of any size conserve the power of the light") {
  // Far away every n x m array of a 0.2 m light is one point source: the rest is (size / distance)^2.
  for (const auto& [n, m] : {std::pair{1, 1}, {2, 2}, {4, 3}, {5, 5}, {1, 7}}) {
    Scene scene = floor_scene();
    scene.camera.height_m = 0.2;
    Light& light = add_area_light(scene, {-0.1, 10.0, -0.1}, {0.2, 0, 0}, {0, 0, 0.2}, Vec3(100.0F));
    light.samples_u = n;
    light.samples_v = m;
    light.jitter = false;
    const Image image = render_floor(scene);
    INFO(n << " x " << m);
    REQUIRE(kPi * value_at(image, "", 8, 8) == Approx(100.0 * 0.04 / 100.0).epsilon(0.001));
    // Phong's arrays share one intensity: without falloff and with all cosines near one the sum is the intensity.
    scene.shading = Shading::phong;
    REQUIRE(value_at(render_floor(scene), "", 8, 8) == Approx(100.0).epsilon(0.001));
  }
}

TEST_CASE("arrays approach the irradiance of the rectangle with the square of the cell size") {
  const std::vector<DVec3> corners{{-0.5, 2, -0.6}, {0.7, 2, -0.6}, {0.7, 2, 0.4}, {-0.5, 2, 0.4}};
  const auto expected = [&](const DVec3& p) { return polygon_irradiance(10.0, corners, p, {0, 1, 0}); };
  std::vector<double> deviations;
  for (const int n : {4, 8, 16}) {
    Scene scene = floor_scene();
    Light& light = add_area_light(scene, {-0.5, 2, -0.6}, {1.2, 0, 0}, {0, 0, 1.0}, Vec3(10.0F));
    light.samples_u = light.samples_v = n;
    light.jitter = false;
    deviations.push_back(largest_deviation(render_floor(scene), expected));
  }
  REQUIRE(deviations[0] < 0.02);
  REQUIRE(deviations[1] < deviations[0] / 3.5);
  REQUIRE(deviations[2] < deviations[1] / 3.5);
}

TEST_CASE("jittered area lights and emissive rectangles have the right mean") {
  const std::vector<DVec3> corners{{-0.5, 2, -0.6}, {0.7, 2, -0.6}, {0.7, 2, 0.4}, {-0.5, 2, 0.4}};
  const auto expected = [&](const DVec3& p) { return polygon_irradiance(10.0, corners, p, {0, 1, 0}); };
  Scene scene = floor_scene();
  add_area_light(scene, {-0.5, 2, -0.6}, {1.2, 0, 0}, {0, 0, 1.0}, Vec3(10.0F));
  REQUIRE(agrees(mean_ratio(render_floor(scene), expected)));

  scene.lights.clear();
  const std::uint32_t lamp = add_material(scene, emissive(Vec3(10.0F)));
  const std::size_t object = add_rectangle(scene, {-0.5, 2, -0.6}, {1.2, 0, 0}, {0, 0, 1.0}, lamp);
  REQUIRE(agrees(mean_ratio(render_floor(scene), expected)));
  // Mirrored in x, it still shines downwards.
  scene.objects[object].to_world[0][0] = -1.0;
  REQUIRE(agrees(mean_ratio(render_floor(scene), [&](const DVec3& p) { return expected({-p.x, p.y, p.z}); })));
  // Turned over, it shines away from the floor.
  scene.objects.clear();
  add_rectangle(scene, {-0.5, 2, -0.6}, {0, 0, 1.0}, {1.2, 0, 0}, lamp);
  REQUIRE(value_at(render_floor(scene), "", 8, 8) == 0.0);
}

TEST_CASE("meshes and spheres that emit light the floor by their solid angle") {
  Scene scene = floor_scene();
  const std::uint32_t lamp = add_material(scene, emissive(Vec3(9.0F, 10.0F, 11.0F)));
  scene.emitter_samples = 64;
  add_sphere(scene, {0.3, 2.5, 0.2}, 0.5, lamp);
  REQUIRE(agrees(mean_ratio(render_floor(scene), [](const DVec3& p) {
    const DVec3 to_center = DVec3(0.3, 2.5, 0.2) - p;
    const double distance = glm::length(to_center);
    return sphere_irradiance(9.0, 0.5, distance, to_center.y / distance);
  })));

  scene.spheres.clear();
  const std::size_t object = add_rectangle(scene, {-0.5, 2, -0.6}, {1.2, 0, 0}, {0, 0, 1.0}, lamp);
  scene.meshes[scene.objects[object].mesh].rectangle = false;
  add_rectangle(scene, {-1.5, 2, -1.0}, {0.4, 0, 0}, {0, 0, 0.8}, lamp);
  scene.meshes.back().rectangle = false;
  const std::vector<DVec3> large{{-0.5, 2, -0.6}, {0.7, 2, -0.6}, {0.7, 2, 0.4}, {-0.5, 2, 0.4}};
  const std::vector<DVec3> small{{-1.5, 2, -1.0}, {-1.1, 2, -1.0}, {-1.1, 2, -0.2}, {-1.5, 2, -0.2}};
  REQUIRE(agrees(mean_ratio(render_floor(scene), [&](const DVec3& p) {
    return polygon_irradiance(9.0, large, p, {0, 1, 0}) + polygon_irradiance(9.0, small, p, {0, 1, 0});
  })));
}

TEST_CASE("the furnace: ambient light alone gives ka times ambient everywhere") {
  Scene scene = empty_scene({0, 0, 5}, {0, 0, 0});
  scene.ambient = Vec3(0.5F, 1.0F, 2.0F);
  scene.background = Vec3(0.5F, 1.0F, 2.0F);
  Material white = diffuse(Vec3(1.0F));
  const std::uint32_t material = add_material(scene, white);
  add_sphere(scene, {0, 0, 0}, 1.0, material);
  add_box(scene, {1, -1, -1}, {2, 1, 1}, material);
  Image image = render_reference(scene, {kSize, kSize, 4, 3, 1});
  for (int c = 0; c < 3; ++c) {
    for (int i = 0; i < kSize * kSize; ++i) {
      REQUIRE(value_at(image, "", i % kSize, i / kSize, static_cast<std::size_t>(c)) ==
              Approx(scene.ambient[c]).epsilon(kFloatImage));
    }
  }
  scene.materials[material].ka = Vec3(0.25F);
  image = render_reference(scene, {kSize, kSize, 1, 3, 1});
  REQUIRE(value_at(image, "", 8, 8, 2) == Approx(0.5).epsilon(kFloatImage));
}

TEST_CASE("anything blocks a shadow ray, glass and the back of a lamp too") {
  for (const int blocker : {0, 1, 2}) {
    Scene scene = floor_scene();
    add_point_light(scene, {0, 3, 0}, Vec3(10.0F));
    const std::uint32_t clear = add_material(scene, glass(1.0F));
    if (blocker == 0) add_rectangle(scene, {0, 1, -9}, {9, 0, 0}, {0, 0, 18}, clear);
    if (blocker == 1) add_sphere(scene, {1.4, 1.2, 0}, 0.6, clear);
    if (blocker == 2) {  // dark: its radiance is zero, yet it is there
      add_area_light(scene, {0, 1, -9}, {9, 0, 0}, {0, 0, 18}, Vec3(0.0F));
    }
    const Image image = render_floor(scene);
    INFO("blocker " << blocker);
    REQUIRE(value_at(image, "", 15, 8) == 0.0);
    REQUIRE(value_at(image, "", 4, 8) > 0.1);
  }
}

TEST_CASE("an invisible area light lights but neither shows nor blocks") {
  Scene scene = floor_scene();
  scene.camera.to_world = look_at({0, 5, 0}, {0, 0, 0}, {0, 0, -1});
  add_point_light(scene, {0, 4, 0}, Vec3(10.0F));
  add_area_light(scene, {-3, 3, -3}, {0, 0, 6}, {6, 0, 0}, Vec3(1.0F)).visible = false;  // shines upwards
  REQUIRE(value_at(render_floor(scene), "", 8, 8) == Approx(10.0 / 16.0 / kPi).epsilon(0.03));
  scene.lights.back().visible = true;
  const Image image = render_floor(scene);
  REQUIRE(value_at(image, "", 8, 8) == 1.0);  // the camera sees its shining side
  REQUIRE(value_at(image, "id", 8, 8) == 2.0);
}

TEST_CASE("Blinn-Phong highlights follow both formulas") {
  Scene scene = floor_scene();
  Material glossy = diffuse(Vec3(0.25F));
  glossy.ks = Vec3(0.5F);
  glossy.shininess = 20.0F;
  scene.materials[0] = glossy;
  add_point_light(scene, {0, 2, 0}, Vec3(10.0F));
  const auto lobe = [](const DVec3& p) {
    const DVec3 l = glm::normalize(DVec3(0, 2, 0) - p);
    return std::pow(glm::normalize(l + DVec3(0, 1, 0)).y, 20.0);
  };
  REQUIRE(largest_deviation(render_floor(scene), [&](const DVec3& p) {
            const double distance = glm::length(DVec3(p.x, 2, p.z));
            return (0.25 + 0.5 * 28.0 / 8.0 * lobe(p)) * 10.0 * 2.0 / std::pow(distance, 3.0);
          }) < kFloatImage);
  scene.shading = Shading::phong;
  REQUIRE(largest_deviation(render_floor(scene), [&](const DVec3& p) {
            const double distance = glm::length(DVec3(p.x, 2, p.z));
            return kPi * 10.0 * (0.25 * 2.0 / distance + 0.5 * lobe(p));
          }) < kFloatImage);
}

TEST_CASE("metallic-roughness turns into Phong parameters") {
  Scene scene = floor_scene();
  Material metal = diffuse({0.8F, 0.4F, 0.2F});
  metal.metallic_roughness = true;
  metal.metallic = 0.25F;
  metal.roughness = 0.5F;
  scene.materials[0] = metal;
  Light& sun = add_point_light(scene, {0, 0, 0}, Vec3(1.0F));
  sun.kind = LightKind::directional;
  const Image image = render_floor(scene);
  // roughness 1/2: exponent 2 * 16 - 2 = 30; light and view along the normal, so that the lobe is at its peak.
  for (const auto& [c, base] : {std::pair<std::size_t, double>{0, 0.8}, {1, 0.4}, {2, 0.2}}) {
    const double expected = base * 0.75 / kPi + (0.04 * 0.75 + base * 0.25) * 38.0 / (8.0 * kPi);
    REQUIRE(value_at(image, "", 3, 3, c) == Approx(expected).epsilon(kFloatImage));
    REQUIRE(value_at(image, "albedo", 3, 3, c) == Approx(base * 0.75).epsilon(kFloatImage));
  }
}

TEST_CASE("the seed moves jittered samples and nothing else") {
  Scene scene = floor_scene();
  add_area_light(scene, {-0.5, 2, -0.6}, {1.2, 0, 0}, {0, 0, 1.0}, Vec3(10.0F));
  const Image a = render_reference(scene, {4, 4, 1, 1, 1});
  const Image b = render_reference(scene, {4, 4, 1, 1, 1});
  const Image c = render_reference(scene, {4, 4, 1, 1, 2});
  REQUIRE(a.layers[0].data == b.layers[0].data);
  REQUIRE(a.layers[0].data != c.layers[0].data);
  scene.lights[0].jitter = false;
  const Image d = render_reference(scene, {4, 4, 1, 1, 1});
  const Image e = render_reference(scene, {4, 4, 1, 1, 2});
  REQUIRE(d.layers[0].data == e.layers[0].data);
}

TEST_CASE("Phong shading takes nothing from behind the surface or from the back of an emitter") {
  Scene scene = floor_scene();
  scene.shading = Shading::phong;
  scene.materials[0].ks = Vec3(1.0F);
  scene.materials[0].shininess = 2.0F;
  add_point_light(scene, {0.3, -0.5, 0.1}, Vec3(10.0F));
  REQUIRE(value_at(render_floor(scene), "", 8, 8) == 0.0);
  scene.lights.clear();
  const std::uint32_t lamp = add_material(scene, emissive(Vec3(2.0F)));
  add_rectangle(scene, {-0.5, 2, -0.5}, {0, 0, 1}, {1, 0, 0}, lamp);  // faces up
  scene.meshes.back().rectangle = false;
  REQUIRE(value_at(render_floor(scene), "", 8, 8) == 0.0);
  scene.objects[0].to_world[0][0] = -1.0;  // mirrored in x it still faces up
  REQUIRE(value_at(render_floor(scene), "", 8, 8) == 0.0);
  scene.objects[0].to_world[1][1] = -1.0;  // mirrored in y too it faces down, at y = 2 again
  scene.objects[0].to_world[3][1] = 4.0;
  REQUIRE(value_at(render_floor(scene), "", 8, 8) > 2.0);
}

TEST_CASE("light samples are keyed by the order in which rays are traced and by the number of samples before") {
  // Half mirror, half glass at y = 0: the reflected ray (ordinal 1) meets a ceiling at y = 3, the transmitted one
  // (ordinal 2) a floor at y = -3; each is lit by a 1 x 1 jittered light of its own, 1 m away.
  Scene scene = floor_scene();
  Material half = glass(1.0F);
  half.fresnel = false;
  half.kr = half.kt = Vec3(0.5F);
  scene.materials[0] = half;
  const std::uint32_t white = add_material(scene, diffuse(Vec3(1.0F)));
  add_plane(scene, {0, 3, 0}, {0, -1, 0}, white);
  add_plane(scene, {0, -3, 0}, {0, 1, 0}, white);
  add_area_light(scene, {-1, 2, -1}, {0, 0, 2}, {2, 0, 0}, Vec3(1.0F));
  add_area_light(scene, {-1, -2, -1}, {2, 0, 0}, {0, 0, 2}, Vec3(1.0F));
  for (Light& light : scene.lights) {
    light.samples_u = light.samples_v = 1;
    light.visible = false;
  }
  scene.lights[0].samples_u = 2;
  const Image image = render_reference(scene, {kSize, kSize, 1, 1, 7});
  // Radiance of a white patch from a sample at horizontal offset (dx, dz) and 1 m height: A / (n pi d^4).
  const auto patch = [](const DVec3& p, double x, double z, double area) {
    const double squared = 1.0 + (x - p.x) * (x - p.x) + (z - p.z) * (z - p.z);
    return area / kPi / (squared * squared);
  };
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const auto pixel = static_cast<std::uint32_t>(y * kSize + x);
      const DVec3 p = floor_point(x, y);
      const DVec3 first = random3({pixel, 0, 1, 7}, 1);
      const DVec3 second = random3({pixel, 0, 1, 7}, 2);
      const DVec3 below = random3({pixel, 0, 2, 7}, 3);
      INFO("pixel " << x << ", " << y);
      // The light above runs u along z in two cells.
      REQUIRE(value_at(image, "reflection", x, y) == Approx(0.5 * (patch(p, 2.0 * first.y - 1.0, first.x - 1.0, 2.0) +
                                                                   patch(p, 2.0 * second.y - 1.0, second.x, 2.0)))
                                                         .epsilon(kFloatImage));
      REQUIRE(value_at(image, "refraction", x, y) ==
              Approx(0.5 * patch(p, 2.0 * below.x - 1.0, 2.0 * below.y - 1.0, 4.0)).epsilon(kFloatImage));
    }
  }
}

}  // namespace hemiray::reference

// The oracle's parts by themselves: random numbers, intersections, the box tree, textures, closed forms.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <set>

#include "tests/reference/closed_forms.hpp"
#include "tests/reference/image_agreement.hpp"
#include "tests/reference/reference_intersect.hpp"
#include "tests/reference/reference_random.hpp"
#include "tests/reference/reference_surface.hpp"
#include "tests/reference/reference_texture.hpp"
#include "tests/reference/scene_builder.hpp"

namespace hemiray::reference {

namespace {

constexpr double kExact = 1e-12;  // double arithmetic of a few operations

/// A direction uniform on the sphere.
DVec3 random_direction(std::uint32_t i, std::uint32_t dimension) {
  const DVec3 r = random3({i, 0, 0, 99}, dimension);
  const double z = 1.0 - 2.0 * r.x;
  const double radial = std::sqrt(1.0 - z * z);
  return {radial * std::cos(2.0 * std::numbers::pi * r.y), radial * std::sin(2.0 * std::numbers::pi * r.y), z};
}

}  // namespace

TEST_CASE("pcg4d: one value worked out in integers of unlimited size") {
  REQUIRE(pcg4d({1, 2, 3, 4}) == std::array<std::uint32_t, 4>{908250390U, 4044648920U, 3775961919U, 45698095U});
}

TEST_CASE("random numbers are uniform, distinct by every key word") {
  DVec3 sum(0.0);
  DVec3 squares(0.0);
  constexpr std::uint32_t kCount = 4096;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const DVec3 r = random3({i, 3, 1, 5}, 2);
    for (int c = 0; c < 3; ++c) REQUIRE((r[c] >= 0.0 && r[c] < 1.0));
    sum += r;
    squares += r * r;
  }
  for (int c = 0; c < 3; ++c) {
    REQUIRE(std::abs(sum[c] / kCount - 0.5) < 5.0 * std::sqrt(1.0 / 12.0 / kCount));
    REQUIRE(std::abs(squares[c] / kCount - 1.0 / 3.0) < 5.0 * std::sqrt(4.0 / 45.0 / kCount));
  }
  const DVec3 base = random3({1, 1, 1, 1}, 1);
  REQUIRE(random3({2, 1, 1, 1}, 1) != base);
  REQUIRE(random3({1, 2, 1, 1}, 1) != base);
  REQUIRE(random3({1, 1, 2, 1}, 1) != base);
  REQUIRE(random3({1, 1, 1, 2}, 1) != base);
  REQUIRE(random3({1, 1, 1, 1}, 2) != base);
}

TEST_CASE("pixel samples put one point into every elementary interval") {
  REQUIRE(pixel_jitter({7, 0, 0, 3}, 1) == glm::dvec2(0.5));
  for (const auto& [columns, rows] : {std::pair{16, 1}, {8, 2}, {4, 4}, {2, 8}, {1, 16}}) {
    std::set<std::pair<int, int>> cells;
    for (std::uint32_t s = 0; s < 16; ++s) {
      const glm::dvec2 p = pixel_jitter({7, s, 0, 3}, 16);
      cells.emplace(static_cast<int>(p.x * columns), static_cast<int>(p.y * rows));
    }
    REQUIRE(cells.size() == 16);
  }
  REQUIRE(pixel_jitter({7, 0, 0, 3}, 2) != pixel_jitter({8, 0, 0, 3}, 2));
  REQUIRE(pixel_jitter({7, 0, 0, 3}, 2) != pixel_jitter({7, 0, 0, 4}, 2));
}

TEST_CASE("the worked sphere intersection") {
  Scene scene;
  add_sphere(scene, {0, 0, 0}, 2.0, add_material(scene, diffuse(Vec3(1.0F))));
  const World world(scene);
  const DVec3 direction(2, 1, 1);
  const double length = glm::length(direction);
  const auto hit = intersect(world, {Kind::sphere, 0}, {{1, 1, 0}, direction / length, 0.0});
  REQUIRE(hit);
  REQUIRE(hit->t_m / length == Approx((std::sqrt(21.0) - 3.0) / 6.0).epsilon(kExact));
  // From a surface point inwards the origin is skipped and the chord's end is found; outwards there is nothing.
  const auto chord = intersect(world, {Kind::sphere, 0}, {{2, 0, 0}, {-0.6, 0.8, 0}, point_error({2, 0, 0}, 0)});
  REQUIRE(chord);
  REQUIRE(chord->t_m == Approx(2.4).epsilon(kExact));
  REQUIRE_FALSE(intersect(world, {Kind::sphere, 0}, {{2, 0, 0}, {0.6, 0.8, 0}, point_error({2, 0, 0}, 0)}));
}

TEST_CASE("equal distances go to the triangle before the plane, and to the first triangle") {
  Scene scene;
  const std::uint32_t material = add_material(scene, diffuse(Vec3(1.0F)));
  add_plane(scene, {0, 0, 0}, {0, 0, 1}, material);
  add_rectangle(scene, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, material);
  const World world(scene);
  const Intersector intersector(world);
  const auto hit = intersector.nearest({{0, 0, 2}, {0, 0, -1}, 0.0});  // the diagonal that both triangles share
  REQUIRE(hit);
  REQUIRE(hit->primitive == PrimitiveId{Kind::triangle, 0});
}

TEST_CASE("no ray slips through the edges of a closed mesh, and the tree agrees with brute force") {
  Scene scene;
  const std::uint32_t material = add_material(scene, diffuse(Vec3(1.0F)));
  add_smooth_ball(scene, {0.5, -0.25, 0.125}, 1.5, 24, material);
  add_box(scene, {2, -1, -1}, {3, 1, 1}, material);
  const World world(scene);
  REQUIRE(world.triangles.size() > 2000);
  const Intersector slow(world, Intersector::Method::brute_force);
  const Intersector fast(world, Intersector::Method::tree);
  for (std::uint32_t i = 0; i < 1500; ++i) {
    // A third aims from inside the ball at its vertices exactly.
    const DVec3 inside(0.5, -0.25, 0.125);
    const Mesh& ball = scene.meshes[0];
    const DVec3 target(ball.positions[i % ball.positions.size()]);
    const bool from_inside = i % 3 == 0;
    const Ray ray = from_inside ? Ray{inside, glm::normalize(target - inside), 0.0}
                                : Ray{4.0 * random_direction(i, 1), random_direction(i, 2), 0.0};
    const auto a = slow.nearest(ray);
    const auto b = fast.nearest(ray);
    if (from_inside) REQUIRE(a);
    REQUIRE(a.has_value() == b.has_value());
    if (!a) continue;
    REQUIRE(a->t_m == b->t_m);
    REQUIRE(a->primitive == b->primitive);
    REQUIRE(fast.occluded(ray, a->t_m * 1.001, {}));
    REQUIRE(slow.occluded(ray, a->t_m * 1.001, {}));
    REQUIRE_FALSE(fast.occluded(ray, a->t_m, {}));
    REQUIRE_FALSE(slow.occluded(ray, a->t_m, {}));
  }
}

TEST_CASE("textures wrap, filter between texel centres and decode before filtering") {
  Scene scene;
  add_texture(scene, 2, ColorSpace::linear, [](int x, int y) { return glm::u8vec3(x * 255, y * 255, 51); });
  Texture& texture = scene.textures[0];
  const auto red = [&](double u) { return sample_texture(texture, {u, 0.25}).r; };
  REQUIRE(red(0.25) == Approx(0.0).margin(kExact));
  REQUIRE(red(0.75) == Approx(1.0).epsilon(kExact));
  REQUIRE(red(0.375) == Approx(0.25).epsilon(kExact));
  REQUIRE(red(1.0) == Approx(0.5).epsilon(kExact));  // repeat: halfway back to the first texel
  REQUIRE(red(-0.125) == Approx(0.75).epsilon(kExact));
  texture.wrap_u = Wrap::clamp;
  REQUIRE(red(1.7) == Approx(1.0).epsilon(kExact));
  texture.wrap_u = Wrap::mirror;
  REQUIRE(red(1.25) == Approx(1.0).epsilon(kExact));
  REQUIRE(red(1.75) == Approx(0.0).margin(kExact));
  texture.filter = Filter::nearest;
  REQUIRE(red(0.499) == 0.0);
  REQUIRE(red(0.501) == 1.0);
  REQUIRE(sample_texture(texture, {0.1, 0.9}).g == 1.0);  // v grows downwards
  texture.filter = Filter::linear;
  texture.color_space = ColorSpace::srgb;
  REQUIRE(red(0.5) == Approx(0.5).epsilon(kExact));  // of decoded 0 and 1, not the decoded half
  REQUIRE(sample_texture(texture, {0.5, 0.5}).b == Approx(std::pow((0.2 + 0.055) / 1.055, 2.4)).epsilon(kExact));
}

TEST_CASE("a normal map tilts towards +u for red and up the picture for green") {
  Scene scene;
  Material material = diffuse(Vec3(1.0F));
  material.normal_texture =
      add_texture(scene, 1, ColorSpace::linear, [](int, int) { return glm::u8vec3(204, 204, 255); });
  // u runs along +x and v along -y, as in a picture held upright; the front is +z.
  const std::uint32_t index = add_material(scene, material);
  add_rectangle(scene, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, index);
  scene.meshes[0].uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  const auto normal_from = [&](double z) {
    const World world(scene);
    const Ray ray{{0.3, 0.2, z}, {0, 0, z > 0 ? -1.0 : 1.0}, 0.0};
    return surface_at(world, ray, *Intersector(world).nearest(ray)).shading_normal;
  };
  const DVec3 expected = glm::normalize(DVec3(0.6, 0.6, 1.0));
  REQUIRE(glm::distance(normal_from(2.0), expected) < kExact);
  REQUIRE(glm::distance(normal_from(-2.0), -expected) < kExact);  // seen from behind
  scene.materials[index].normal_scale = 0.5F;
  REQUIRE(glm::distance(normal_from(2.0), glm::normalize(DVec3(0.3, 0.3, 1.0))) < kExact);
  // A picture used upside down tilts the other way in y.
  scene.meshes[0].uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  REQUIRE(normal_from(2.0).y == Approx(-normal_from(2.0).x).epsilon(kExact));
}

TEST_CASE("smooth normals interpolate, and a zero vertex normal makes the triangle flat") {
  Scene scene;
  add_smooth_ball(scene, {0, 0, 0}, 1.0, 8, add_material(scene, diffuse(Vec3(1.0F))));
  scene.objects[0].to_world[1][1] = 0.5;  // an ellipsoid: normals go by the inverse transpose
  const Ray ray{{0.4, 0.33, 3}, {0, 0, -1}, 0.0};
  const auto shading_normal = [&] {
    const World world(scene);
    return surface_at(world, ray, *Intersector(world).nearest(ray)).shading_normal;
  };
  const double z = std::sqrt(1.0 - 0.4 * 0.4 - 0.66 * 0.66);
  REQUIRE(glm::distance(shading_normal(), glm::normalize(DVec3(0.4, 0.33 * 4.0, z))) < 0.05);
  const World world(scene);
  const auto hit = Intersector(world).nearest(ray);
  const WorldTriangle& triangle = world.triangles[hit->primitive.index];
  REQUIRE(glm::distance(shading_normal(), triangle.normal) > 1e-3);
  scene.meshes[0].normals.assign(scene.meshes[0].normals.size(), Vec3(0.0F));
  REQUIRE(glm::distance(shading_normal(), triangle.normal) < kExact);
}

TEST_CASE("the closed forms of the rectangle agree with the formula of Lambert and with quadrature") {
  const double a = 0.7;
  const double b = 1.3;
  const double c = 0.9;
  const DVec3 up(0, 0, 1);
  const double parallel = corner_irradiance_parallel(2.0, a, b, c);
  REQUIRE(polygon_irradiance(2.0, {{0, 0, c}, {0, b, c}, {a, b, c}, {a, 0, c}}, DVec3(0.0), up) ==
          Approx(parallel).epsilon(kExact));
  REQUIRE(polygon_irradiance(2.0, {{0, 0, c}, {a, 0, c}, {a, b, c}, {0, b, c}}, DVec3(0.0), up) ==
          Approx(-parallel).epsilon(kExact));
  const double perpendicular = corner_irradiance_perpendicular(2.0, a, b, c);
  double sum_parallel = 0.0;
  double sum_perpendicular = 0.0;
  constexpr int kCells = 200;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      const double x = a * (i + 0.5) / kCells;
      const double y = b * (j + 0.5) / kCells;
      const double squared = x * x + y * y + c * c;
      const double cell = 2.0 * a * b / (kCells * kCells) / (squared * squared);
      sum_parallel += cell * c * c;
      sum_perpendicular += cell * c * x;
    }
  }
  // Midpoint rule: the error is of the order of (1 / cells)^2.
  REQUIRE(sum_parallel == Approx(parallel).epsilon(1e-4));
  REQUIRE(sum_perpendicular == Approx(perpendicular).epsilon(1e-4));
  // A small, far sphere is a disc of its cross-section.
  REQUIRE(sphere_irradiance(2.0, 0.01, 3.0, 0.5) == Approx(2.0 * std::numbers::pi * 1e-4 / 9.0 * 0.5).epsilon(kExact));
}

TEST_CASE("image agreement tells a few wrong pixels from many slightly wrong ones") {
  Image reference;
  reference.width = 10;
  reference.height = 10;
  reference.layers = {{"", {"R"}, std::vector<float>(100, 1.0F)}};
  Image image = reference;
  image.layers[0].data[7] = 3.0F;
  auto agreement = compare_layers(image, reference);
  REQUIRE(agreement.at(0).outlier_share == Approx(0.01));
  REQUIRE(agreement[0].rel_mse == 0.0);
  for (float& value : image.layers[0].data) value = 1.001F;
  agreement = compare_layers(image, reference);
  REQUIRE(agreement[0].outlier_share == 0.0);
  REQUIRE(agreement[0].rel_mse == Approx(1e-6 / 1.01).epsilon(1e-3));
  image.layers[0].data[3] = std::nanf("");
  REQUIRE_THROWS(compare_layers(image, reference));
  image.layers.clear();
  REQUIRE_THROWS(compare_layers(image, reference));
}

TEST_CASE("Fresnel and Snell: known values") {
  REQUIRE(fresnel_from_angles(0.0, 1.0, 1.5) == Approx(0.04).epsilon(kExact));
  // At Brewster's angle only perpendicular light is reflected: R = ((n^2 - 1) / (n^2 + 1))^2 / 2.
  const double brewster = std::atan(1.5);
  REQUIRE(fresnel_from_angles(brewster, 1.0, 1.5) == Approx(0.5 * std::pow(1.25 / 3.25, 2.0)).epsilon(1e-9));
  REQUIRE(fresnel_from_angles(0.8, 1.5, 1.0) == 1.0);  // beyond 41.8 degrees
  REQUIRE(snell_angle(std::numbers::pi / 6.0, 1.0, 1.5) == Approx(std::asin(1.0 / 3.0)).epsilon(kExact));
  REQUIRE(std::isnan(snell_angle(0.8, 1.5, 1.0)));
}

}  // namespace hemiray::reference

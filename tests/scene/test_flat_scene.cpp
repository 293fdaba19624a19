// The scene as the kernels get it: transforms applied, mirrored winding, normals, indices, lights collected.
#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <vector>

#include "host/scene/flat_lights.hpp"
#include "host/scene/flat_scene.hpp"
#include "tests/reference/scene_builder.hpp"

namespace hemiray {
namespace {

using namespace reference;

// World coordinates are computed in double and rounded once.
constexpr double kRounding = 1e-6;

DVec3 position(const FlatScene& flat, std::uint32_t i) {
  return {flat.positions.at(3 * i), flat.positions.at(3 * i + 1), flat.positions.at(3 * i + 2)};
}

DVec3 normal(const FlatScene& flat, std::uint32_t i) {
  return {flat.normals.at(3 * i), flat.normals.at(3 * i + 1), flat.normals.at(3 * i + 2)};
}

DVec3 xyz(const shared::float4& v) { return {v.x, v.y, v.z}; }

bool near(const DVec3& a, const DVec3& b, double tolerance = kRounding) { return glm::length(a - b) <= tolerance; }

// Geometric normal of a flat triangle, not normalised.
DVec3 front(const FlatScene& flat, std::size_t triangle) {
  const shared::uint4 t = flat.triangles.at(triangle);
  return glm::cross(position(flat, t.y) - position(flat, t.x), position(flat, t.z) - position(flat, t.x));
}

DMat4 matrix(const DVec3& x, const DVec3& y, const DVec3& z, const DVec3& move) {
  return {glm::dvec4(x, 0), glm::dvec4(y, 0), glm::dvec4(z, 0), glm::dvec4(move, 1)};
}

Scene one_rectangle(const DMat4& to_world, const Material& material) {
  Scene scene = empty_scene({0, 0, 5}, {0, 0, 0});
  add_rectangle(scene, {0, 0, 0}, {2, 0, 0}, {0, 1, 0}, add_material(scene, material));
  scene.objects[0].to_world = to_world;
  return scene;
}

}  // namespace

TEST_CASE("vertices are moved to the world and rounded once") {
  // 2^24 + 1 is no float: moved by -2^24 in double it comes out exactly.
  const double big = 16777216.0;
  const FlatScene flat =
      flatten_scene(one_rectangle(matrix({3, 0, 0}, {0, 0, 5}, {0, 1, 0}, {big + 1, 7, -2}), diffuse(Vec3(0.5F))));
  REQUIRE(flat.positions.size() == 12);
  CHECK(position(flat, 0) == DVec3(big, 7, -2));      // ties to even
  CHECK(position(flat, 1) == DVec3(big + 8, 7, -2));  // big + 7, rounded
  CHECK(position(flat, 3) == DVec3(big, 7, 3));
  const double third = 1.0 / 3.0;
  const FlatScene thirds =
      flatten_scene(one_rectangle(matrix({third, 0, 0}, {0, third, 0}, {0, 0, third}, {1, 1, 1}), diffuse(Vec3(0.5F))));
  CHECK(position(thirds, 1).x == static_cast<double>(static_cast<float>(2.0 * third + 1.0)));
}

TEST_CASE("a mirroring transform keeps the front in front") {
  const Material grey = diffuse(Vec3(0.5F));
  const FlatScene plain = flatten_scene(one_rectangle(DMat4(1.0), grey));
  CHECK(near(front(plain, 0), {0, 0, 2}));
  CHECK(near(front(plain, 1), {0, 0, 2}));
  CHECK(plain.triangles[0].y == 1);
  // x mirrored: the front still looks to +z, as the object's own front does after the transform.
  const FlatScene mirrored = flatten_scene(one_rectangle(matrix({-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}), grey));
  CHECK(near(front(mirrored, 0), {0, 0, 2}));
  CHECK(near(front(mirrored, 1), {0, 0, 2}));
  CHECK(mirrored.triangles[0].y == 2);
  // z mirrored: the front looks to -z. Twice mirrored is a rotation.
  CHECK(near(front(flatten_scene(one_rectangle(matrix({1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 0}), grey)), 0),
             {0, 0, -2}));
  CHECK(near(front(flatten_scene(one_rectangle(matrix({-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, 0}), grey)), 0),
             {0, 0, 2}));
}

TEST_CASE("normals go by the inverse transpose, have unit length and follow mirroring") {
  Scene scene = empty_scene({0, 0, 5}, {0, 0, 0});
  add_rectangle(scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 1}, add_material(scene, diffuse(Vec3(0.5F))));
  const DVec3 n = glm::normalize(DVec3(0, -1, 1));
  scene.meshes[0].normals = {Vec3(n), Vec3(n), Vec3(0.0F), 5.0F * Vec3(n)};
  const auto transform = GENERATE(matrix({4, 0, 0}, {0, 1, 0}, {0, 0, 2}, {1, 2, 3}),
                                  matrix({-1, 0, 0}, {0, 3, 0}, {0, 0.5, 1}, {0, 0, 0}),
                                  matrix({1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 0}));
  scene.objects[0].to_world = transform;
  const FlatScene flat = flatten_scene(scene);
  const DVec3 expected = glm::normalize(front(flat, 0));
  CHECK(near(normal(flat, 0), expected));
  CHECK(near(normal(flat, 1), expected));
  CHECK(normal(flat, 2) == DVec3(0.0));  // zero says "flat here"
  CHECK(near(normal(flat, 3), expected));
}

TEST_CASE("attributes that some mesh has are filled for all, and those that none has are left out") {
  Scene scene = empty_scene({0, 0, 5}, {0, 0, 0});
  const std::uint32_t grey = add_material(scene, diffuse(Vec3(0.5F)));
  add_rectangle(scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, grey);
  add_box(scene, {0, 0, 0}, {1, 1, 1}, grey);
  FlatScene flat = flatten_scene(scene);
  CHECK(flat.normals.empty());
  CHECK(flat.uvs.empty());  // there are uvs, but no texture
  CHECK(flat.colors.empty());
  scene.meshes[1].colors.assign(8, {0.25F, 0.5F, 0.75F});
  scene.meshes[1].normals.assign(8, {0, 1, 0});
  add_texture(scene, 2, ColorSpace::srgb, [](int x, int y) { return glm::u8vec3(10 * x, 20 * y, 255); });
  flat = flatten_scene(scene);
  REQUIRE(flat.positions.size() == 36);
  REQUIRE(flat.normals.size() == 36);
  REQUIRE(flat.colors.size() == 36);
  REQUIRE(flat.uvs.size() == 12);
  CHECK(normal(flat, 3) == DVec3(0.0));
  CHECK(normal(flat, 4) == DVec3(0, 1, 0));
  CHECK(flat.colors[0] == 1.0F);
  CHECK(flat.colors[12] == 0.25F);
  CHECK(flat.uvs[2].x == 1.0F);
  CHECK(flat.uvs[4].x == 0.0F);
  CHECK(flat.texels == std::vector<std::uint32_t>{0xffff0000U, 0xffff000aU, 0xffff1400U, 0xffff140aU});
  CHECK(flat.textures[0].flags == HR_TEXTURE_SRGB);
}

TEST_CASE("primitive, object and material indices follow their order") {
  Scene scene = empty_scene({0, 0, 5}, {0, 0, 0});
  const std::uint32_t a = add_material(scene, diffuse(Vec3(0.1F))), b = add_material(scene, diffuse(Vec3(0.2F)));
  add_rectangle(scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, a);
  scene.meshes[0].triangle_materials[1] = b;
  scene.objects.push_back(scene.objects[0]);
  scene.objects[1].material = static_cast<int>(b);
  add_sphere(scene, {1, 2, 3}, 0.5, b);
  add_plane(scene, {0, -1, 0}, {0, 2, 0}, a);
  add_area_light(scene, {0, 3, 0}, {1, 0, 0}, {0, 0, 1}, Vec3(2.0F)).visible = false;
  add_area_light(scene, {5, 3, 0}, {1, 0, 0}, {0, 0, 2}, Vec3(7.0F));
  const FlatScene flat = flatten_scene(scene);
  REQUIRE(flat.triangles.size() == 6);
  CHECK(flat.triangle_objects == std::vector<std::uint32_t>{0, 0, 1, 1, 4, 4});
  CHECK(flat.triangles[0].w == a);
  CHECK(flat.triangles[1].w == b);
  CHECK(flat.triangles[2].w == b);
  CHECK(flat.triangles[2].x == 4);
  CHECK(flat.spheres.at(0).object == 2);
  CHECK(flat.spheres.at(0).material == b);
  CHECK(flat.spheres.at(0).center_radius.w == 0.5F);
  CHECK(flat.planes.at(0).object == 3);
  CHECK(near(xyz(flat.planes.at(0).normal), {0, 1, 0}));
  // The visible light is a black quad that shines as the light does, where the light is.
  REQUIRE(flat.materials.size() == 3);
  CHECK(flat.triangles[4].w == 2);
  CHECK(flat.materials[2].emission.x == 7.0F);
  CHECK(flat.materials[2].kd.x == 0.0F);
  CHECK(near(front(flat, 4), {0, -2, 0}));
  CHECK(near(front(flat, 5), {0, -2, 0}));
  CHECK(near(position(flat, flat.triangles[4].x), {5, 3, 0}));
  REQUIRE(flat.lights.size() == 2);
  CHECK(flat.lights[0].primitive_count == 0);
  CHECK(flat.lights[1].primitive_count == 2);
  CHECK(flat.lights[1].first_primitive == 4);
}

TEST_CASE("lights keep their kind, and their samples are numbered through") {
  Scene scene = empty_scene({0, 0, 5}, {0, 0, 0});
  add_point_light(scene, {1, 2, 3}, {4.0F, 5.0F, 6.0F});
  Light& spot = add_point_light(scene, {0, 4, 0}, Vec3(1.0F));
  spot.kind = LightKind::spot;
  spot.direction = {0, -1, 0};
  spot.inner_angle_deg = 30.0;
  spot.outer_angle_deg = 60.0;
  Light& sun = add_point_light(scene, {0, 0, 0}, Vec3(1.0F));
  sun.kind = LightKind::directional;
  sun.direction = {1, 0, 0};
  Light& area = add_area_light(scene, {0, 3, 0}, {2, 0, 0}, {0, 0, 3}, Vec3(2.0F));
  area.samples_u = 4;
  area.samples_v = 3;
  area.jitter = false;
  area.visible = false;
  add_point_light(scene, {0, 0, 0}, Vec3(1.0F));
  const FlatScene flat = flatten_scene(scene);
  REQUIRE(flat.lights.size() == 5);
  const std::vector<std::uint32_t> kinds = {HR_LIGHT_POINT, HR_LIGHT_SPOT, HR_LIGHT_DIRECTIONAL, HR_LIGHT_AREA,
                                            HR_LIGHT_POINT};
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < 5; i++) {
    INFO("light " << i);
    CHECK(flat.lights[i].kind == kinds[i]);
    CHECK(flat.lights[i].first_sample == before);
    CHECK(flat.lights[i].sample_count == (i == 3 ? 12U : 1U));
    before += flat.lights[i].sample_count;
  }
  CHECK(near(xyz(flat.lights[0].position), {1, 2, 3}));
  CHECK(near(xyz(flat.lights[0].intensity), {4, 5, 6}));
  CHECK(flat.lights[1].position.w == Approx(0.5));
  CHECK(flat.lights[1].direction.w == Approx(1.0 / (std::sqrt(3.0) / 2.0 - 0.5)));
  CHECK(near(xyz(flat.lights[3].direction), {0, -1, 0}));
  CHECK(flat.lights[3].intensity.w == Approx(6.0 / 12.0));  // a cell's area
  CHECK(flat.lights[3].jitter == 0);
}

TEST_CASE("an emissive rectangle is a jittered array that shines to its front, mirrored or not") {
  const auto transform = GENERATE(DMat4(1.0), matrix({-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {3, 0, 0}),
                                  matrix({0, 2, 0}, {1, 0, 0}, {0, 0, 1}, {0, 0, 4}),
                                  matrix({1, 0, 0}, {0.5, 1, 0}, {0, 0, -1}, {0, 0, 0}));
  const FlatScene flat = flatten_scene(one_rectangle(transform, emissive({1.0F, 2.0F, 3.0F})));
  REQUIRE(flat.lights.size() == 1);
  CHECK(flat.emitters.empty());
  const shared::Light& light = flat.lights[0];
  CHECK(light.kind == HR_LIGHT_AREA);
  CHECK(light.samples_u == kRectangleSamples);
  CHECK(light.sample_count == kRectangleSamples * kRectangleSamples);
  CHECK(light.jitter == 1);
  CHECK(light.first_primitive == 0);
  CHECK(light.primitive_count == 2);
  CHECK(near(xyz(light.direction), glm::normalize(front(flat, 0))));
  CHECK(near(glm::cross(xyz(light.edge_u), xyz(light.edge_v)), front(flat, 0)));
  CHECK(light.intensity.w == Approx(glm::length(front(flat, 0)) / (kRectangleSamples * kRectangleSamples)));
  // The parallelogram's corners are the mesh's.
  const DVec3 corner = xyz(light.position);
  CHECK(near(corner, position(flat, 0)));
  CHECK(near(corner + xyz(light.edge_u) + xyz(light.edge_v), position(flat, 2)));
}

TEST_CASE("emitters share out their weights, and their densities integrate to one") {
  Scene scene = empty_scene({0, 0, 5}, {0, 0, 0});
  scene.emitter_samples = 9;
  const std::uint32_t dim = add_material(scene, emissive({1.0F, 2.0F, 3.0F}));      // mean 2
  const std::uint32_t bright = add_material(scene, emissive({30.0F, 0.0F, 0.0F}));  // mean 10
  const std::uint32_t dark = add_material(scene, diffuse(Vec3(0.5F)));
  add_box(scene, {0, 0, 0}, {1, 2, 3}, dim);  // 22 m^2
  add_box(scene, {5, 5, 5}, {6, 6, 6}, dark);
  add_sphere(scene, {9, 0, 0}, 2.0, bright);  // 16 pi m^2
  add_sphere(scene, {20, 0, 0}, 2.0, dark);
  add_point_light(scene, {0, 9, 0}, Vec3(1.0F));
  const FlatScene flat = flatten_scene(scene);
  REQUIRE(flat.lights.size() == 2);
  CHECK(flat.lights[1].kind == HR_LIGHT_EMITTERS);
  CHECK(flat.lights[1].sample_count == 9);
  CHECK(flat.lights[1].first_sample == 1);
  CHECK(flat.lights[1].jitter == 1);
  REQUIRE(flat.emitters.size() == 13);
  const double sphere_area = 16.0 * std::numbers::pi;
  const double total = 22.0 * 2.0 + sphere_area * 10.0;
  double previous = 0.0, probability = 0.0;
  for (std::size_t i = 0; i < flat.emitters.size(); i++) {
    const shared::Emitter& emitter = flat.emitters[i];
    const bool is_sphere = i == 12;
    const double area = is_sphere ? sphere_area : 0.5 * glm::length(front(flat, emitter.primitive));
    const double share = static_cast<double>(emitter.cumulative) - previous;
    INFO("emitter " << i);
    CHECK(emitter.primitive == (is_sphere ? 24U : i));  // behind the 24 triangles of the boxes
    CHECK(share == Approx(area * (is_sphere ? 10.0 : 2.0) / total).epsilon(1e-5));
    CHECK(emitter.inverse_pdf == Approx(area / share).epsilon(1e-5));  // 1 / (chance / area)
    probability += area / static_cast<double>(emitter.inverse_pdf);
    previous = static_cast<double>(emitter.cumulative);
  }
  CHECK(flat.emitters.back().cumulative == 1.0F);
  CHECK(probability == Approx(1.0).epsilon(1e-6));
}

TEST_CASE("degenerate triangles of an emissive mesh are no emitters") {
  Scene scene = empty_scene({0, 0, 5}, {0, 0, 0});
  add_box(scene, {0, 0, 0}, {1, 1, 1}, add_material(scene, emissive(Vec3(1.0F))));
  scene.meshes[0].triangles[3] = {2, 2, 5};
  const FlatScene flat = flatten_scene(scene);
  CHECK(flat.emitters.size() == 11);
  for (const shared::Emitter& emitter : flat.emitters) CHECK(emitter.primitive != 3);
}

TEST_CASE("an empty scene flattens to nothing") {
  const FlatScene flat = flatten_scene(empty_scene({0, 0, 5}, {0, 0, 0}));
  CHECK(flat.positions.empty());
  CHECK(flat.triangles.empty());
  CHECK(flat.lights.empty());
  CHECK(flat.materials.empty());
}

}  // namespace hemiray

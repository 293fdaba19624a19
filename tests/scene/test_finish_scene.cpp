// Completion of scenes (camera, light), world bounds, validation of scenes built in code, summaries.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <numbers>

#include "host/base/error.hpp"
#include "host/scene/bounds.hpp"
#include "host/scene/emission.hpp"
#include "host/scene/load.hpp"
#include "host/scene/summary.hpp"

using namespace hemiray;

namespace {

constexpr double kAngleSlack = 1e-9;  // rad: rounding of a few double operations

Scene sphere_scene(const DVec3& center, double radius) {
  Scene scene;
  scene.materials.emplace_back();
  Sphere sphere;
  sphere.center = center;
  sphere.radius = radius;
  scene.spheres.push_back(sphere);
  return scene;
}

Scene triangle_scene() {
  Scene scene;
  scene.materials.emplace_back();
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.triangle_materials = {0};
  scene.meshes.push_back(mesh);
  scene.objects.emplace_back();
  return scene;
}

// The whole sphere lies inside the camera's frustum (all four sides).
bool in_view(const Camera& camera, const DVec3& center, double radius) {
  const DVec3 c(glm::inverse(camera.to_world) * glm::dvec4(center, 1.0));
  if (c.z + radius >= 0.0) return false;
  const double half_y = camera.fov_y_deg * std::numbers::pi / 360.0;
  const double half_x = std::atan(std::tan(half_y) * camera.width / camera.height);
  const auto inside = [&](double offset, double half) {
    return std::atan2(std::abs(offset), -c.z) + std::asin(radius / std::hypot(offset, c.z)) <= half + kAngleSlack;
  };
  return inside(c.x, half_x) && inside(c.y, half_y);
}

std::string validation_error(const Scene& scene) {
  try {
    validate_scene(scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("finish: the default camera sees the whole bounding sphere from the front right above") {
  for (const auto& [width, height] : {std::pair(512, 512), std::pair(640, 200), std::pair(100, 900)}) {
    CAPTURE(width, height);
    Scene scene = sphere_scene({10, -3, 5}, 2.5);
    scene.camera.width = width;
    scene.camera.height = height;
    finish_scene(scene);
    REQUIRE(scene.has_camera);
    CHECK(validation_error(scene).empty());
    CHECK(in_view(scene.camera, {10, -3, 5}, 2.5));
    CHECK_FALSE(in_view(scene.camera, {10, -3, 5}, 2.5 * 1.2));  // and not from needlessly far
    const DVec3 from = DVec3(scene.camera.to_world[3]) - DVec3(10, -3, 5);
    CHECK(from.x > 0.0);
    CHECK(from.y > 0.0);
    CHECK(from.z > from.x);
  }
}

TEST_CASE("finish: an orthographic default camera sees it too") {
  Scene scene = sphere_scene({0, 0, 0}, 1.0);
  scene.camera.kind = CameraKind::orthographic;
  scene.camera.width = 200;
  scene.camera.height = 400;
  finish_scene(scene);
  CHECK(scene.camera.height_m * 200.0 / 400.0 >= 2.0);
  CHECK(scene.camera.height_m * 200.0 / 400.0 <= 2.2);
}

TEST_CASE("finish: empty scenes, points and distant specks get a usable camera") {
  Scene empty;
  finish_scene(empty);
  CHECK(validation_error(empty).empty());
  Scene speck = triangle_scene();
  speck.objects[0].to_world = DMat4(1e-30);
  speck.objects[0].to_world[3] = glm::dvec4(1e6, 0, 0, 1);
  finish_scene(speck);
  CHECK(validation_error(speck).empty());
  CHECK(glm::length(DVec3(speck.camera.to_world[3]) - DVec3(1e6, 0, 0)) > 1.0);
  Scene huge = sphere_scene({0, 0, 0}, 1e17);
  finish_scene(huge);
  CHECK(validation_error(huge).empty());
}

TEST_CASE("finish: a given camera is kept, and so is its silence") {
  Scene scene = sphere_scene({0, 0, 0}, 1.0);
  scene.has_camera = true;
  scene.has_lights = true;
  scene.camera.to_world[3] = glm::dvec4(7, 8, 9, 1);
  finish_scene(scene);
  CHECK(DVec3(scene.camera.to_world[3]) == DVec3(7, 8, 9));
  CHECK(scene.lights.empty());
  CHECK(scene.notes.empty());
}

TEST_CASE("finish: a default light comes over the camera's left shoulder if nothing emits") {
  Scene scene = triangle_scene();
  finish_scene(scene);
  REQUIRE(scene.lights.size() == 1);
  CHECK(scene.lights[0].kind == LightKind::directional);
  CHECK(scene.lights[0].intensity == Vec3(3.0F));
  CHECK(scene.ambient == Vec3(0.15F));
  const DVec3 direction(glm::inverse(scene.camera.to_world) * glm::dvec4(scene.lights[0].direction, 0.0));
  CHECK(direction.x > 0.0);  // from the left
  CHECK(direction.y < 0.0);  // from above
  CHECK(direction.z < 0.0);  // from behind
  REQUIRE(scene.notes.size() == 2);
  CHECK(scene.notes[0].find("camera") != std::string::npos);
  CHECK(scene.notes[1].find("light") != std::string::npos);
  finish_scene(scene);  // nothing more to do
  CHECK(scene.lights.size() == 1);
  CHECK(scene.notes.size() == 2);

  Scene with_ambient = triangle_scene();
  with_ambient.ambient = Vec3(0.4F);
  finish_scene(with_ambient);
  CHECK(with_ambient.ambient == Vec3(0.4F));
  CHECK(with_ambient.lights.size() == 1);
}

TEST_CASE("finish: no default light where something emits or lights are given") {
  Scene emissive = triangle_scene();
  emissive.materials[0].emission = Vec3(1.0F);
  finish_scene(emissive);
  CHECK(emissive.lights.empty());

  Scene overridden = triangle_scene();  // the emissive material is there, but overridden
  overridden.materials[0].emission = Vec3(1.0F);
  overridden.materials.emplace_back();
  overridden.objects[0].material = 1;
  CHECK(count_emitters(overridden) == 0);
  finish_scene(overridden);
  CHECK(overridden.lights.size() == 1);

  Scene sphere = sphere_scene({0, 0, 0}, 1.0);
  sphere.materials[0].emission = Vec3(0.0F, 0.0F, 2.0F);
  CHECK(has_emitters(sphere));
  finish_scene(sphere);
  CHECK(sphere.lights.empty());

  Scene dark = triangle_scene();
  dark.has_lights = true;
  finish_scene(dark);
  CHECK(dark.lights.empty());
  CHECK(dark.ambient == Vec3(0.0F));
}

TEST_CASE("bounds: instances, spheres and visible area lights count, unused vertices and planes do not") {
  Scene scene = triangle_scene();
  scene.meshes[0].positions.emplace_back(100.0F, 100.0F, 100.0F);
  scene.objects[0].to_world[3] = glm::dvec4(0, 0, -4, 1);
  scene.planes.emplace_back();
  scene.planes[0].point = DVec3(0, -50, 0);
  Light light;
  light.kind = LightKind::area;
  light.position = DVec3(0, 9, 0);
  light.visible = false;
  scene.lights = {light};
  CHECK(world_bounds(scene).min == DVec3(0, 0, -4));
  CHECK(world_bounds(scene).max == DVec3(1, 1, -4));
  scene.lights[0].visible = true;
  CHECK(world_bounds(scene).max == DVec3(1, 9, 1));
  scene.spheres = sphere_scene({-5, 0, 0}, 2.0).spheres;
  CHECK(world_bounds(scene).min == DVec3(-7, -2, -4));
  CHECK(bounding_radius(scene, DVec3(0.0)) == Approx(std::sqrt(83.0)));
  CHECK(world_bounds(Scene{}).empty());
}

TEST_CASE("validate: scenes built in code") {
  CHECK(validation_error(triangle_scene()).empty());
  const auto broken = [](auto change) {
    Scene scene = triangle_scene();
    change(scene);
    return validation_error(scene);
  };
  using Catch::StartsWith;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK_THAT(broken([&](Scene& s) { s.meshes[0].positions[1].y = nan; }), StartsWith("scene: /meshes/0/positions/1: "));
  CHECK_THAT(broken([](Scene& s) { s.meshes[0].triangles[0].z = 3; }), StartsWith("scene: /meshes/0/triangles/0: "));
  CHECK_THAT(broken([](Scene& s) { s.meshes[0].triangle_materials[0] = 1; }),
             StartsWith("scene: /meshes/0/triangle_materials/0: material 1 is out of range: there are 1"));
  CHECK_THAT(broken([](Scene& s) { s.meshes[0].triangle_materials.clear(); }),
             StartsWith("scene: /meshes/0/triangle_materials: "));
  CHECK_THAT(broken([](Scene& s) { s.meshes[0].uvs.resize(2); }), StartsWith("scene: /meshes/0/uvs: "));
  CHECK_THAT(broken([](Scene& s) { s.objects[0].mesh = 1; }), StartsWith("scene: /objects/0/mesh: "));
  CHECK_THAT(broken([](Scene& s) { s.objects[0].material = -2; }), StartsWith("scene: /objects/0/material: "));
  CHECK_THAT(broken([](Scene& s) { s.objects[0].to_world[0][0] = 1e300; }), StartsWith("scene: /objects/0/to_world: "));
  CHECK_THAT(broken([](Scene& s) { s.materials[0].kd_texture = 0; }), StartsWith("scene: /materials/0: texture 0"));
  CHECK_THAT(broken([](Scene& s) { s.materials[0].ior = 0.0F; }), StartsWith("scene: /materials/0/ior: "));
  CHECK_THAT(broken([](Scene& s) { s.spheres.emplace_back().radius = 0.0; }), StartsWith("scene: /spheres/0/radius: "));
  CHECK_THAT(broken([](Scene& s) { s.planes.emplace_back().normal = DVec3(0, 2, 0); }),
             StartsWith("scene: /planes/0/normal: "));
  CHECK_THAT(broken([](Scene& s) {
               s.materials[0].emission = Vec3(1.0F);
               s.planes.emplace_back();
             }),
             StartsWith("scene: /planes/0/material: "));
  CHECK_THAT(broken([](Scene& s) { s.lights.emplace_back().intensity = Vec3(-1.0F); }), StartsWith("scene: /lights/0"));
  CHECK_THAT(broken([](Scene& s) { s.camera.width = 0; }), StartsWith("scene: /camera/size: "));
  CHECK_THAT(broken([](Scene& s) { s.camera.to_world[0][0] = 2.0; }), StartsWith("scene: /camera: "));
  CHECK_THAT(broken([](Scene& s) { s.textures.emplace_back().width = 3; }), StartsWith("scene: /textures/0: "));
}

TEST_CASE("summary: counts after instancing, in text and JSON") {
  Scene scene = triangle_scene();
  scene.source = "a.json";
  scene.objects.emplace_back();
  scene.spheres = sphere_scene({0, 0, 0}, 1.0).spheres;
  scene.materials[0].emission = Vec3(1.0F);
  scene.lights.emplace_back();
  scene.dropped_triangles = 4;
  scene.notes = {"first note"};
  const SceneSummary summary = summarize(scene);
  CHECK(summary.objects == 2);
  CHECK(summary.meshes == 1);
  CHECK(summary.triangles == 2);
  CHECK(summary.vertices == 6);
  CHECK(summary.spheres == 1);
  CHECK(summary.point_lights == 1);
  CHECK(summary.emissive_objects == 3);
  CHECK(summary.dropped_triangles == 4);

  const std::string text = summary_text(summary);
  CHECK_THAT(text, Catch::StartsWith("a.json: valid"));
  CHECK_THAT(text, Catch::Contains("first note"));
  CHECK_THAT(text, Catch::Contains("4 triangles"));
  const nlohmann::json json = nlohmann::json::parse(summary_json(summary));
  CHECK(json.at("triangles") == 2);
  CHECK(json.at("bounds_max").at(0) == 1.0);
  CHECK(json.at("notes").at(0) == "first note");
}

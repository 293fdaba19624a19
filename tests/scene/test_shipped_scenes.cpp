// Every scene in scenes/ loads without a remark, and the ones that stand for something published say what it says.
#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "host/scene/bounds.hpp"
#include "host/scene/load.hpp"

using namespace hemiray;

namespace {

std::filesystem::path scenes_folder() { return std::filesystem::path(HR_SOURCE_DIR) / "scenes"; }

const Object& object_named(const Scene& scene, const std::string& name) {
  const auto found = std::find_if(scene.objects.begin(), scene.objects.end(),
                                  [&](const Object& object) { return object.name == name; });
  REQUIRE(found != scene.objects.end());
  return *found;
}

}  // namespace

TEST_CASE("shipped scenes: all load") {
  std::size_t loaded = 0;
  for (const auto& entry : std::filesystem::directory_iterator(scenes_folder())) {
    const std::filesystem::path& path = entry.path();
    const std::set<std::string> kinds{".json", ".gltf", ".glb", ".obj", ".ply"};
    if (!kinds.contains(path.extension().string()) || path.filename() == "scene.schema.json") continue;
    CAPTURE(path.filename().string());
    const Scene scene = load_scene(path);
    CHECK(scene.objects.size() + scene.spheres.size() + scene.shapes.size() > 0);
    CHECK(scene.dropped_triangles == 0);
    CHECK(scene.has_camera);
    // A bare OBJ has neither camera nor light; the other files are complete.
    if (path.extension() != ".obj") {
      CAPTURE(scene.notes);
      CHECK(scene.notes.empty());
      CHECK(scene.lights.size() + static_cast<std::size_t>(scene.has_lights) > 0);
    }
    ++loaded;
  }
  CHECK(loaded >= 8);
}

TEST_CASE("shipped scenes: the Cornell box") {
  const Scene scene = load_scene(scenes_folder() / "cornell_box.json");
  // Seen from the camera the red wall is on the left, the green one on the right, as in the photograph.
  const DMat4 to_camera = glm::inverse(scene.camera.to_world);
  const auto side = [&](const char* name) {
    const Mesh& mesh = scene.meshes[object_named(scene, name).mesh];
    return (to_camera * glm::dvec4(mesh.positions[0], 1.0)).x;
  };
  CHECK(side("left wall") < 0.0);
  CHECK(side("right wall") > 0.0);
  const auto material = [&](const char* name) {
    return scene.materials[scene.meshes[object_named(scene, name).mesh].triangle_materials[0]].name;
  };
  CHECK(material("left wall") == "red");
  CHECK(material("right wall") == "green");

  // Walls face inwards, blocks outwards.
  const DVec3 middle(0.278, 0.274, 0.28);
  for (const Object& object : scene.objects) {
    const Mesh& mesh = scene.meshes[object.mesh];
    const bool block = object.name.ends_with("block");
    DVec3 center(0.0);
    for (const Vec3& p : mesh.positions) center += DVec3(p) / static_cast<double>(mesh.positions.size());
    for (const UVec3& t : mesh.triangles) {
      CAPTURE(object.name, t.x, t.y, t.z);
      const DVec3 a(mesh.positions[t.x]);
      const DVec3 normal = glm::cross(DVec3(mesh.positions[t.y]) - a, DVec3(mesh.positions[t.z]) - a);
      CHECK((block ? glm::dot(normal, a - center) : glm::dot(normal, middle - a)) > 0.0);
    }
  }

  // The light fills the hole in the ceiling: same plane, and their areas add up to the whole ceiling.
  REQUIRE(scene.lights.size() == 1);
  const Light& light = scene.lights[0];
  CHECK(glm::cross(light.edge_u, light.edge_v).y < 0.0);
  const Mesh& ceiling = scene.meshes[object_named(scene, "ceiling with a hole for the light").mesh];
  double area = 0.0;
  for (const UVec3& t : ceiling.triangles) {
    const DVec3 a(ceiling.positions[t.x]);
    area += 0.5 * glm::length(glm::cross(DVec3(ceiling.positions[t.y]) - a, DVec3(ceiling.positions[t.z]) - a));
  }
  CHECK(area == Approx(0.556 * 0.5592 - 0.13 * 0.105).epsilon(1e-6));
  // 35 mm focal length, 25 mm film.
  CHECK(scene.camera.fov_y_deg == Approx(glm::degrees(2.0 * std::atan(0.5 * 25.0 / 35.0))).epsilon(1e-6));
}

TEST_CASE("shipped scenes: the light arrays differ in nothing but their samples") {
  const Scene scene = load_scene(scenes_folder() / "light_arrays.json");
  REQUIRE(scene.lights.size() == 6);
  std::set<std::tuple<int, int, bool>> arrays;
  for (const Light& light : scene.lights) {
    arrays.emplace(light.samples_u, light.samples_v, light.jitter);
    CHECK(light.edge_u == scene.lights[0].edge_u);
    CHECK(light.edge_v == scene.lights[0].edge_v);
    CHECK(light.intensity == scene.lights[0].intensity);
    CHECK(glm::cross(light.edge_u, light.edge_v).z < 0.0);  // towards the wall
  }
  const std::set<std::tuple<int, int, bool>> expected{{2, 2, false}, {4, 3, false}, {5, 5, false},
                                                      {2, 2, true},  {4, 3, true},  {5, 5, true}};
  CHECK(arrays == expected);
}

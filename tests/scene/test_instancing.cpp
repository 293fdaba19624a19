// Which objects become instances, and how they stand in the flat scene.
#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include "host/base/error.hpp"
#include "host/scene/features.hpp"
#include "host/scene/flat_scene.hpp"
#include "host/scene/summary.hpp"
#include "tests/reference/scene_builder.hpp"

namespace hemiray {
namespace {

using namespace reference;

// A fan of that many triangles, placed `copies` times along x.
Scene row_of_fans(std::uint32_t triangles, std::size_t copies, const Material& material) {
  Scene scene = empty_scene({0, 0, 5}, {0, 0, 0});
  const std::uint32_t index = add_material(scene, material);
  Mesh mesh;
  for (std::uint32_t i = 0; i < triangles + 2; i++) mesh.positions.emplace_back(static_cast<float>(i), i % 2, 0);
  for (std::uint32_t i = 0; i < triangles; i++) mesh.triangles.emplace_back(i, i + 1, i + 2);
  mesh.triangle_materials.assign(triangles, index);
  scene.meshes.push_back(mesh);
  for (std::size_t i = 0; i < copies; i++) {
    Object object;
    object.to_world[3] = {static_cast<double>(i), 2.0, 3.0, 1.0};
    scene.objects.push_back(object);
  }
  return scene;
}

std::size_t shared_objects(const Scene& scene, Instancing instancing) {
  std::size_t count = 0;
  for (const bool instanced : instanced_objects(scene, instancing)) count += instanced ? 1 : 0;
  return count;
}

constexpr std::uint32_t kMany = 1U << 14U;  // triangles that are worth sharing

}  // namespace

TEST_CASE("a mesh is shared where that saves enough triangles, or wherever it is told to be") {
  const Material grey = diffuse(Vec3(0.5F));
  CHECK(shared_objects(row_of_fans(kMany, 2, grey), Instancing::automatic) == 2);
  CHECK(shared_objects(row_of_fans(kMany, 1, grey), Instancing::automatic) == 0);
  CHECK(shared_objects(row_of_fans(kMany - 1, 2, grey), Instancing::automatic) == 0);
  CHECK(shared_objects(row_of_fans(kMany / 16, 17, grey), Instancing::automatic) == 17);
  CHECK(shared_objects(row_of_fans(kMany / 16, 16, grey), Instancing::automatic) == 0);
  CHECK(shared_objects(row_of_fans(3, 1, grey), Instancing::always) == 1);
  CHECK(shared_objects(row_of_fans(kMany, 9, grey), Instancing::never) == 0);
}

TEST_CASE("what emits stays in the world, by its material or by the object's") {
  CHECK(shared_objects(row_of_fans(5, 3, emissive(Vec3(1.0F))), Instancing::always) == 0);
  Scene scene = row_of_fans(5, 3, diffuse(Vec3(0.5F)));
  scene.objects[1].material = static_cast<int>(add_material(scene, emissive(Vec3(2.0F))));
  CHECK(instanced_objects(scene, Instancing::always) == std::vector<bool>{true, false, true});
  const FlatScene flat = flatten_scene(scene, Instancing::always);
  CHECK(flat.world_triangles() == 5);
  CHECK(flat.triangle_objects == std::vector<std::uint32_t>(5, 1));
  CHECK(flat.emitters.size() == 5);
  CHECK(flat.instances.size() == 2);
}

TEST_CASE("matrices that single precision cannot turn back stay in the world") {
  Scene scene = row_of_fans(5, 5, diffuse(Vec3(0.5F)));
  scene.objects[0].to_world[0] = {2000.0, 0, 0, 0};  // stretches more than it can take back
  scene.objects[1].to_world[1] = {0, 0, 0, 0};       // flat
  for (int c = 0; c < 3; c++) scene.objects[2].to_world[c] *= 1e-13;
  for (int c = 0; c < 3; c++) scene.objects[3].to_world[c] *= 1e-9;
  CHECK(instanced_objects(scene, Instancing::always) == std::vector<bool>{false, false, false, true, true});
}

TEST_CASE("instances stand behind all other primitives, in the order of their objects") {
  Scene scene = row_of_fans(5, 3, diffuse(Vec3(0.5F)));
  const std::uint32_t red = add_material(scene, diffuse({1.0F, 0.0F, 0.0F}));
  scene.objects[1].material = static_cast<int>(red);
  scene.objects[2].to_world[0][0] = -2.0;
  add_area_light(scene, {0, 9, 0}, {1, 0, 0}, {0, 0, 1}, Vec3(1.0F));  // two triangles
  add_sphere(scene, {0, 0, 0}, 1.0, 0);
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, 0);
  const FlatScene flat = flatten_scene(scene, Instancing::always);
  REQUIRE(flat.shared_meshes.size() == 1);
  CHECK(flat.shared_meshes[0].first_triangle == 2);
  CHECK(flat.shared_meshes[0].triangle_count == 5);
  CHECK(flat.world_triangles() == 2);
  CHECK(flat.triangles.size() == 7);
  REQUIRE(flat.instances.size() == 3);
  for (std::uint32_t i = 0; i < 3; i++) {
    const shared::Instance& instance = flat.instances[i];
    CHECK(instance.first_id == 4 + 5 * i);
    CHECK(instance.object == i);
    CHECK(instance.material == (i == 1 ? red : HR_NO_MATERIAL));
    CHECK(instance.flags == (i == 2 ? HR_INSTANCE_MIRRORED : 0U));
    CHECK(instance.to_world_x.w == static_cast<float>(i));
    CHECK(instance.to_world_y.w == 2.0F);
    CHECK(instance.to_object_x.x == (i == 2 ? -0.5F : 1.0F));
  }
  // The mesh's own vertices, not moved.
  CHECK(flat.positions[std::size_t{3} * flat.triangles[2].x] == 0.0F);
  CHECK(flat.positions[std::size_t{3} * flat.triangles[2].x + 1] == 0.0F);
}

TEST_CASE("a scene with instances calls for them, and for the materials its instances show") {
  Material glossy = diffuse(Vec3(0.5F));
  glossy.ks = Vec3(0.5F);
  Scene scene = row_of_fans(5, 2, glossy);
  const auto mask = [&scene] { return features_of(scene, flatten_scene(scene, Instancing::always), 3); };
  constexpr std::uint32_t kShapes = HR_FEATURE_TRIANGLES | HR_FEATURE_INSTANCES;
  CHECK(mask() == (kShapes | HR_FEATURE_SPECULAR));
  const auto plain = static_cast<int>(add_material(scene, diffuse(Vec3(0.2F))));
  scene.objects[0].material = plain;
  CHECK(mask() == (kShapes | HR_FEATURE_SPECULAR));
  scene.objects[1].material = plain;
  CHECK(mask() == kShapes);
  CHECK(features_of(scene, flatten_scene(scene), 3) == HR_FEATURE_TRIANGLES);
}

TEST_CASE("a summary counts triangles as if copied, those on the device, and instances") {
  Scene scene = row_of_fans(kMany, 3, diffuse(Vec3(0.5F)));
  scene.objects[2].material = static_cast<int>(add_material(scene, emissive(Vec3(1.0F))));
  const SceneSummary summary = summarize(scene);
  CHECK(summary.triangles == 3 * kMany);
  CHECK(summary.unique_triangles == 2 * kMany);
  CHECK(summary.instances == 2);
  CHECK_THAT(summary_text(summary), Catch::Contains("2 that share their triangles"));
  const SceneSummary plain = summarize(row_of_fans(5, 3, diffuse(Vec3(0.5F))));
  CHECK(plain.unique_triangles == 15);
  CHECK(plain.instances == 0);
  CHECK_THAT(summary_text(plain), !Catch::Contains("instances"));
}

TEST_CASE("more primitives than there are indices are refused") {
  const Scene fits = row_of_fans(1U << 16U, (1U << 15U) - 1, diffuse(Vec3(0.5F)));
  CHECK(flatten_scene(fits, Instancing::automatic).instances.size() == (1U << 15U) - 1);
  const Scene scene = row_of_fans(1U << 16U, 1U << 15U, diffuse(Vec3(0.5F)));
  CHECK_THROWS_AS(flatten_scene(scene, Instancing::automatic), DeviceError);
  CHECK_THROWS_WITH(flatten_scene(scene, Instancing::automatic),
                    Catch::Contains("2^31") && Catch::Contains("place fewer copies"));
}

}  // namespace hemiray

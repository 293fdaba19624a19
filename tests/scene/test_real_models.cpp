// Loads models made elsewhere, where they are at hand: ../shared/data beside the repository, or HEMIRAY_TEST_DATA.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>

#include "host/scene/load.hpp"

using namespace hemiray;

namespace {

struct Model {
  const char* file;
  std::size_t meshes;
  std::size_t objects;
  std::size_t triangles;  // of all meshes, each counted once, with those dropped
  std::size_t dropped;
  std::size_t textures;
};

// Faces as counted in the files themselves: f lines with n corners give n - 2, element and accessor counts.
constexpr Model kModels[] = {{"meshes/bunny.ply", 1, 1, 69451, 0, 0},
                             {"meshes/fandisk.obj", 1, 1, 12946, 0, 0},
                             {"meshes/spot.obj", 1, 1, 5856, 0, 0},
                             {"meshes/suzanne.obj", 1, 1, 968, 0, 0},
                             {"meshes/legocar.obj", 26, 26, 10992, 112, 0},
                             {"cornell/CornellBox-Sphere.obj", 8, 8, 2188, 0, 0},
                             {"cornell/CornellBox-Water.obj", 9, 9, 7088, 0, 0},
                             {"gltf/Box.glb", 1, 1, 12, 0, 0},
                             {"gltf/BoxInterleaved.glb", 1, 1, 12, 0, 0},
                             {"gltf/BoxTextured.glb", 1, 1, 12, 0, 1},
                             {"gltf/BoxVertexColors.glb", 1, 1, 12, 0, 0},
                             {"gltf/CesiumMilkTruck.glb", 2, 3, 2856, 0, 1},
                             {"gltf/Avocado/Avocado.gltf", 1, 1, 682, 0, 3}};

std::filesystem::path data_folder() {
  const char* chosen = std::getenv("HEMIRAY_TEST_DATA");
  return chosen != nullptr ? std::filesystem::path(chosen) : std::filesystem::path(HR_SOURCE_DIR) / "../shared/data";
}

}  // namespace

TEST_CASE("real models load with the triangles their files hold") {
  const std::filesystem::path folder = data_folder();
  if (!std::filesystem::is_directory(folder)) {
    WARN("no folder " << folder.string() << ": real models are not tested; set HEMIRAY_TEST_DATA to one that has them");
    return;
  }
  for (const Model& model : kModels) {
    CAPTURE(model.file);
    const Scene scene = load_scene(folder / model.file);
    std::size_t triangles = 0;
    for (const Mesh& mesh : scene.meshes) triangles += mesh.triangles.size();
    CHECK(scene.meshes.size() == model.meshes);
    CHECK(scene.objects.size() == model.objects);
    CHECK(triangles + scene.dropped_triangles == model.triangles);
    CHECK(scene.dropped_triangles == model.dropped);
    CHECK(scene.textures.size() == model.textures);
  }
}

TEST_CASE("the Cornell box of spheres has a mirror, a glass ball and a rectangular lamp") {
  const std::filesystem::path file = data_folder() / "cornell/CornellBox-Sphere.obj";
  if (!std::filesystem::exists(file)) {
    WARN("no file " << file.string() << ": not tested");
    return;
  }
  const Scene scene = load_scene(file);
  const auto material = [&](const std::string& name) {
    for (const Material& m : scene.materials) {
      if (m.name == name) return m;
    }
    FAIL("no material " << name);
    return Material{};
  };
  CHECK(material("leftSphere").kr == Vec3(0.95F));
  CHECK(material("rightSphere").kt.x == Approx(std::sqrt(0.1)));
  CHECK(material("rightSphere").ior == 2.5F);
  CHECK(material("light").emission == Vec3(10.0F));
  CHECK(scene.meshes.back().name == "light");
  CHECK(scene.meshes.back().rectangle);
}

// Pictures of scenes whose meshes are shared by instances: the same as of copies, and the same bits from both
// engines.
#include <catch2/catch.hpp>

#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <string>

#include "host/path/render.hpp"
#include "host/scene/features.hpp"
#include "tests/path/render_on_device.hpp"
#include "tests/reference/image_agreement.hpp"
#include "tests/reference/scene_builder.hpp"

namespace hemiray {
namespace {

using namespace reference;

// Where a ray passes an edge, or a texel's, within rounding, the picture may differ outright; elsewhere by roundings.
constexpr double kOutlierShare = 0.01;
constexpr double kRelMse = 1e-6;

DMat4 placed(DVec3 place, DVec3 scale, double degrees) {
  const DMat4 moved = glm::translate(DMat4(1.0), place);
  return glm::scale(glm::rotate(moved, glm::radians(degrees), glm::normalize(DVec3(1.0, 2.0, 0.5))), scale);
}

void add_copy(Scene& scene, std::size_t of, const DMat4& to_world, int material = kNone) {
  Object object;
  object.mesh = scene.objects[of].mesh;
  object.to_world = to_world;
  object.material = material;
  scene.objects.push_back(object);
}

// Copies of a smooth textured ball, of a box with colours at its corners and of a rectangle with a normal map: turned,
// stretched, mirrored, and in other materials. A mirror, glass and a lamp besides.
Scene market() {
  Scene scene = empty_scene({0, 2.5, 6}, {0, 0.6, 0}, 45.0);
  scene.ambient = Vec3(0.1F);
  scene.background = Vec3(0.2F, 0.3F, 0.5F);
  Material tiles = diffuse(Vec3(0.8F));
  tiles.kd_texture =
      add_texture(scene, 8, ColorSpace::srgb, [](int x, int y) { return glm::u8vec3(30 * x, 200 - 20 * y, 90); });
  tiles.ks = Vec3(0.2F);
  Material bumpy = diffuse(Vec3(0.6F));
  bumpy.normal_texture = add_texture(scene, 4, ColorSpace::linear, [](int x, int y) {
    return glm::u8vec3((x + y) % 2 == 0 ? 160 : 100, x % 2 == 0 ? 150 : 110, 230);
  });
  const auto glass_index = static_cast<int>(add_material(scene, glass(1.5F)));
  const auto mirror_index = static_cast<int>(add_material(scene, mirror(0.8F)));
  const std::size_t ball = add_smooth_ball(scene, {0, 0, 0}, 0.5, 8, add_material(scene, tiles));
  const std::size_t box = add_box(scene, {-0.4, -0.4, -0.4}, {0.4, 0.4, 0.4}, add_material(scene, diffuse(Vec3(0.7F))));
  const std::size_t relief = add_rectangle(scene, {-0.5, -0.5, 0}, {1, 0, 0}, {0, 1, 0}, add_material(scene, bumpy));
  Mesh& corners = scene.meshes[scene.objects[box].mesh];
  for (std::size_t i = 0; i < corners.positions.size(); i++) {
    corners.colors.emplace_back(0.2F + 0.1F * static_cast<float>(i % 8), i % 2 == 0 ? 1.0F : 0.3F, 0.5F);
  }
  scene.objects[ball].to_world = placed({-1.5, 0.5, 0.5}, {1, 1, 1}, 0);
  scene.objects[box].to_world = placed({0, 0.5, 1}, {1, 1, 1}, 30);
  scene.objects[relief].to_world = placed({1.6, 0.7, 1}, {1, 1, 1}, 0);
  add_copy(scene, ball, placed({-0.4, 1.2, -0.5}, {0.5, 1.2, 0.8}, 70));
  add_copy(scene, ball, placed({0.9, 0.5, 0.2}, {-0.8, 0.9, 0.7}, 140));
  add_copy(scene, ball, placed({2.1, 0.6, -0.8}, {1, 1, 1}, 20), mirror_index);
  add_copy(scene, ball, placed({-0.6, 0.5, 2}, {0.8, 0.8, -0.8}, 50), glass_index);
  add_copy(scene, box, placed({-2.2, 0.6, -0.8}, {0.7, -1.2, 0.5}, 60));
  add_copy(scene, box, placed({1, 1.6, -1}, {0.5, 0.5, 0.9}, 200), mirror_index);
  add_copy(scene, relief, placed({0, 0.8, -1.6}, {-2, 1.5, 1}, 5));
  add_rectangle(scene, {-4, 0, 4}, {8, 0, 0}, {0, 0, -8}, add_material(scene, diffuse(Vec3(0.5F))));
  add_point_light(scene, {2, 4, 3}, Vec3(20.0F));
  add_area_light(scene, {-1, 3.5, -0.5}, {1, 0, 0}, {0, 0, 1}, Vec3(4.0F));
  return scene;
}

Image render(const Scene& scene, Instancing instancing, EngineKind engine, bool strict) {
  RenderOptions options;
  options.width = 80;
  options.height = 56;
  options.spp = 2;
  options.depth = 4;
  options.engine = engine;
  options.strict = strict;
  options.instancing = instancing;
  Context context(choose_device(""), profile_with_tail(0));
  RenderResult result = render_scene(context, scene, options);
  const bool shared = instancing == Instancing::always;
  CHECK(((result.statistics.features & HR_FEATURE_INSTANCES) != 0) == shared);
  CHECK((result.statistics.accel.instances > 0) == shared);
  return std::move(result.image);
}

bool same_bits(const Image& a, const Image& b) {
  if (a.layers.size() != b.layers.size()) return false;
  for (std::size_t l = 0; l < a.layers.size(); l++) {
    const std::vector<float>&x = a.layers[l].data, &y = b.layers[l].data;
    if (x.size() != y.size() || std::memcmp(x.data(), y.data(), x.size() * sizeof(float)) != 0) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("a picture of instances is the picture of copies") {
  const Scene scene = market();
  const Image copies = render(scene, Instancing::never, EngineKind::wavefront, false);
  const Image instances = render(scene, Instancing::always, EngineKind::wavefront, false);
  for (const LayerAgreement& layer : compare_layers(instances, copies)) {
    INFO("layer '" << layer.layer << "': " << layer.outlier_share << ", " << layer.rel_mse);
    CHECK(layer.outlier_share <= kOutlierShare);
    CHECK(layer.rel_mse <= kRelMse);
  }
}

TEST_CASE("strict engines give the same bits: instances") {
  const Scene scene = market();
  const Image wavefront = render(scene, Instancing::always, EngineKind::wavefront, true);
  CHECK(same_bits(wavefront, render(scene, Instancing::always, EngineKind::megakernel, true)));
  CHECK_FALSE(same_bits(wavefront, render(scene, Instancing::never, EngineKind::wavefront, true)));
}

}  // namespace hemiray

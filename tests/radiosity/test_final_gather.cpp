// The final gather: exact where light is even, nearer to the truth where the mesh is coarse, with the scene's lights.
#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "host/base/compare.hpp"
#include "host/scene/load.hpp"
#include "tests/path/render_on_device.hpp"
#include "tests/radiosity/displayed_scene.hpp"
#include "tests/radiosity/radiosity_bench.hpp"
#include "tests/reference/diffuse_reference.hpp"
#include "tests/reference/scene_builder.hpp"

namespace hemiray {
namespace {

using Columns = std::vector<std::array<double, 3>>;
using namespace reference;

double rel_mse(const Image& image, const Image& truth) {
  Image a, b;
  a.width = b.width = image.width;
  a.height = b.height = image.height;
  Layer shown{"", {"R", "G", "B"}, {}};
  for (std::size_t i = 0; i < image.pixel_count(); i++) {
    for (std::size_t c = 0; c < 3; c++) shown.data.push_back(image.find("")->data[4 * i + c]);
  }
  a.layers = {shown};
  b.layers = {*truth.find("")};
  return compare_images(a, b, "shown", "path-traced").layers[0].rel_mse;
}

DVec3 mean_of(const Image& image) {
  DVec3 sum(0.0);
  for (int y = 0; y < image.height; y++) {
    for (int x = 0; x < image.width; x++) {
      for (int c = 0; c < 3; c++) sum[c] += value_at(image, "", x, y, static_cast<std::size_t>(c));
    }
  }
  return sum / static_cast<double>(image.pixel_count());
}

struct Solved {
  FlatScene flat;
  Radiosity radiosity;
};

Solved solve(Context& context, const Scene& scene, std::uint32_t patches) {
  Solved solved{flatten_scene(scene), {}};
  RadiosityOptions options;
  options.mesh.patches = patches;
  options.residual_samples = 0;
  solved.radiosity = compute_radiosity(context, solved.flat, options);
  return solved;
}

FlatScene gathered(const Solved& solved, std::uint32_t rays) {
  return gathered_patches(solved.flat, solved.radiosity.mesh, solved.radiosity.irradiance, rays);
}

}  // namespace

TEST_CASE("tiny: a final gather in even light is exact, in both engines") {
  FlatScene flat = test::flat_without_materials();
  const DVec3 rho(0.8, 0.5, 0.25);
  test::add_room(flat, Vec3(1.0F, 2.0F, 1.5F), test::add_material(flat, Vec3(rho), Vec3(0.0F)));
  const PatchMesh mesh = make_patch_mesh(flat, {0.0, 12, 0.0});
  Columns irradiance(mesh.side_count(), {0.0, 0.0, 0.0});
  for (std::uint32_t i = 0; i < mesh.patch_count(); i++) irradiance[std::size_t{2} * i] = {3.0, 3.0, 3.0};
  const FlatScene patches = gathered_patches(flat, mesh, irradiance, 3);
  const Scene scene = empty_scene({0.5, 1.0, 0.7}, {0, 0.2, 0.1});
  for (const EngineKind engine : {EngineKind::wavefront, EngineKind::megakernel}) {
    Context context(choose_device(""), profile_with_tail(0));
    const Image image = test::show_patches(context, scene, patches, {4, 3, 2, 0, 1}, engine);
    for (int i = 0; i < 12; i++) {
      for (int c = 0; c < 3; c++) {
        // Every ray meets a wall that sends rho 3 / pi.
        const double expected = rho[c] * rho[c] * 3.0 / std::numbers::pi;
        CHECK(std::abs(value_at(image, "", i % 4, i / 4, static_cast<std::size_t>(c)) / expected - 1.0) < 1e-6);
      }
    }
  }
}

TEST_CASE("on a coarse mesh of the Cornell box a final gather is nearer to the path-traced picture") {
  Context context(choose_device(""));
  const Scene scene = load_scene(HR_SOURCE_DIR "/scenes/cornell_box.json");
  const Solved solved = solve(context, scene, 200);
  const Image truth = render_diffuse_reference(scene, {16, 16, 768, 0, 1});
  const FlatScene plain = lit_patches(solved.radiosity.mesh, solved.radiosity.irradiance);
  const double interpolated = rel_mse(test::show_patches(context, scene, plain, {16, 16, 64, 0, 2}), truth);
  const double looked_for = rel_mse(test::show_patches(context, scene, gathered(solved, 4), {16, 16, 64, 0, 2}), truth);
  WARN("relMSE at " << solved.radiosity.mesh.patch_count() << " patches: interpolated " << interpolated << ", gathered "
                    << looked_for);
  CHECK(looked_for < 0.5 * interpolated);
}

TEST_CASE("a final gather samples every kind of light, on patches as on the scene itself") {
  Scene scene = empty_scene({-0.9, 0.2, 0.9}, {0.2, -0.3, -0.5}, 80.0);
  add_box(scene, {-1, -1, -1}, {1, 1, 1}, add_material(scene, diffuse(Vec3(0.5F))));
  add_sphere(scene, {0.5, 0.4, -0.4}, 0.2, add_material(scene, emissive({4, 0, 0})));
  add_rectangle(scene, {-0.3, 0.9, -0.3}, {0.5, 0, 0}, {0, 0, 0.6}, add_material(scene, emissive({0, 3, 0})));
  add_point_light(scene, {-0.4, 0, -0.5}, {0, 0, 1});
  Context context(choose_device(""));
  const DVec3 truth = mean_of(render_diffuse_reference(scene, {16, 16, 256, 0, 5}));
  const FlatScene patches = gathered(solve(context, scene, 600), 8);
  const DVec3 ratio = mean_of(test::show_patches(context, scene, patches, {16, 16, 16, 0, 4})) / truth;
  // One light a channel. The ball is cut to 1 % of its radius, which takes 2 % of its area; the rest is noise.
  for (int c = 0; c < 3; c++) CHECK(std::abs(ratio[c] - 1.0) < 0.03);
}

TEST_CASE("a lamp that is gathered has all its patches, in whatever order refinement leaves them") {
  Scene scene = empty_scene({0, 0, 3}, {0, 0, 0}, 60.0);
  add_rectangle(scene, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, add_material(scene, diffuse(Vec3(0.5F))));
  add_rectangle(scene, {0.5, 1, 0.5}, {-1, 0, 0}, {0, 0, 1}, add_material(scene, emissive({0, 3, 0})));
  const FlatScene flat = flatten_scene(scene);
  PatchMesh mesh = make_patch_mesh(flat, {0.0, 100, 0.0});
  const auto lamp_of = [&](const FlatScene& patches) {
    double area = 0.0, dark = 0.0;
    REQUIRE(patches.lights.size() == 1);
    const shared::Light& light = patches.lights[0];
    for (std::uint32_t k = 0; k < light.primitive_count; k++) {
      const shared::uint4& t = patches.triangles[light.first_primitive + k];
      const Vec3 a = test::vertex(patches, t.x), b = test::vertex(patches, t.y), c = test::vertex(patches, t.z);
      (patches.materials[t.w].emission.y > 0.0F ? area : dark) += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return std::pair(area, dark);
  };
  const Columns dim(mesh.side_count(), {0.1, 0.1, 0.1});
  for (const bool in_order : {true, false}) {
    if (!in_order) {  // back to front
      std::ranges::reverse(mesh.flat.triangles);
      std::ranges::reverse(mesh.flat.triangle_objects);
      std::ranges::reverse(mesh.normals);
      std::ranges::reverse(mesh.faces);
    }
    const auto [area, dark] = lamp_of(gathered_patches(flat, mesh, dim, 4));
    CAPTURE(in_order);
    CHECK(std::abs(area - 1.0) < 1e-5);
    CHECK(dark == 0.0);
  }
}

TEST_CASE("a final gather gives the same bits and rays in both engines, mirrors in the picture") {
  Scene scene = load_scene(HR_SOURCE_DIR "/scenes/cornell_box.json");
  scene.materials.push_back(scene.materials[0]);
  scene.materials.back().kr = Vec3(0.4F);
  scene.objects[6].material = static_cast<int>(scene.materials.size()) - 1;
  Context setup(choose_device(""));
  const Solved solved = solve(setup, scene, 300);
  const FlatScene patches = gathered(solved, 5);
  std::vector<RenderResult> results;
  const auto add = [&](EngineKind engine, std::uint32_t tail) {
    RenderOptions options;
    options.engine = engine;
    options.strict = true;
    options.width = 21;
    options.height = 17;
    options.spp = 2;
    options.patches = &patches;
    Context context(choose_device(""), profile_with_tail(tail));
    results.push_back(render_scene(context, scene, options));
  };
  add(EngineKind::megakernel, 0);
  add(EngineKind::wavefront, 0);
  add(EngineKind::wavefront, 100);
  const RayCounts& rays = results[0].statistics.rays;
  const std::vector<float>& reflected = results[0].image.find("reflection")->data;
  CHECK(std::ranges::any_of(reflected, [](float value) { return value > 0.01F; }));  // the mirror is in the picture
  CHECK(rays.closest > 4ULL * 21 * 17 * 2);  // 5 a hit, but some pixels miss or see the lamp
  for (const RenderResult& other : results) {
    CHECK(compare_images(other.image, results[0].image, "this", "megakernel").identical);
    CHECK(other.statistics.rays.closest == rays.closest);
    CHECK(other.statistics.rays.shadow == rays.shadow);
  }
}

}  // namespace hemiray

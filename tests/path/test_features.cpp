// The effect mask: which scene calls for what, and that kernels compile for every kind of mask.
#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include "host/gpu/program.hpp"
#include "host/scene/features.hpp"
#include "host/scene/flat_scene.hpp"
#include "tests/reference/scene_builder.hpp"

namespace hemiray {
namespace {

using reference::add_area_light;
using reference::add_box;
using reference::add_material;
using reference::add_plane;
using reference::add_point_light;
using reference::add_rectangle;
using reference::add_smooth_ball;
using reference::add_sphere;
using reference::add_texture;
using reference::diffuse;
using reference::emissive;
using reference::empty_scene;
using reference::glass;
using reference::mirror;

std::uint32_t mask_of(const Scene& scene, int depth = 5) { return features_of(scene, flatten_scene(scene), depth); }

Scene dark_box(const Material& material) {
  Scene scene = empty_scene({0, 0, 5}, {0, 0, 0});
  add_box(scene, {-1, -1, -1}, {1, 1, 1}, add_material(scene, material));
  return scene;
}

std::uint32_t mask_of_material(const Material& material, int depth = 5) { return mask_of(dark_box(material), depth); }

Scene textured_box(int Material::*slot) {
  Scene scene = empty_scene({0, 0, 5}, {0, 0, 0});
  Material material = diffuse(Vec3(0.5F));
  material.*slot = add_texture(scene, 2, ColorSpace::linear, [](int, int) { return glm::u8vec3(128); });
  material.emission = slot == &Material::emission_texture ? Vec3(1.0F) : Vec3(0.0F);
  add_rectangle(scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, add_material(scene, material));
  return scene;
}

constexpr std::uint32_t kReflects = HR_FEATURE_REFLECTION | HR_FEATURE_SECONDARY;
constexpr std::uint32_t kRefracts = HR_FEATURE_REFRACTION | HR_FEATURE_SECONDARY;

// A feature with everything that features_of() never gives it without.
std::uint32_t with_implied(std::uint32_t bit) {
  switch (bit) {
    case HR_FEATURE_POINT_LIGHTS:
    case HR_FEATURE_DIRECTIONAL_LIGHTS:
    case HR_FEATURE_SPOT_LIGHTS:
    case HR_FEATURE_AREA_LIGHTS:
      return bit | HR_FEATURE_LIGHTS;
    case HR_FEATURE_EMITTERS:
      return bit | HR_FEATURE_LIGHTS | HR_FEATURE_EMISSION | HR_FEATURE_SPHERES;
    case HR_FEATURE_INSTANCES:
    case HR_FEATURE_SMOOTH_NORMALS:
    case HR_FEATURE_VERTEX_COLORS:
    case HR_FEATURE_TEXTURES:
    case HR_FEATURE_RADIOSITY:
    case HR_FEATURE_THIN_TRIANGLES:
      return bit | HR_FEATURE_TRIANGLES;
    case HR_FEATURE_GATHER:
      return bit | HR_FEATURE_RADIOSITY | HR_FEATURE_TRIANGLES;
    case HR_FEATURE_IMPLICITS:
      return bit | HR_FEATURE_SHAPES;
    case HR_FEATURE_NORMAL_MAPS:
      return bit | HR_FEATURE_TEXTURES | HR_FEATURE_TRIANGLES;
    case HR_FEATURE_METALLIC_ROUGHNESS:
      return bit | HR_FEATURE_SPECULAR;
    case HR_FEATURE_REFLECTION:
    case HR_FEATURE_REFRACTION:
      return bit | HR_FEATURE_SECONDARY;
    case HR_FEATURE_BRANCHING:
      return bit | kReflects | kRefracts;
    case HR_FEATURE_FRESNEL:
      return bit | kRefracts;
    default:
      return bit;
  }
}

constexpr std::uint32_t kAll = (1U << HR_FEATURE_COUNT) - 1;

// All features but `bit` and those that need it.
std::uint32_t all_without(std::uint32_t bit) {
  std::uint32_t mask = 0;
  for (unsigned i = 0; i < HR_FEATURE_COUNT; i++) {
    if ((with_implied(1U << i) & bit) == 0) mask |= 1U << i;
  }
  return mask;
}

// Both engines' programs compile with this mask and have the kernels it calls for, and no others.
void check_compiles(Context& context, std::uint32_t mask) {
  std::string names;
  for (const std::string& name : feature_names(mask)) names += name + " ";
  INFO("features: " << names);
  Program wavefront(context, "wavefront",
                    {"path/queue.cl", "path/wavefront.cl", "path/finish.cl", "film/accumulate.cl"},
                    ProgramOptions{mask, false});
  const std::size_t stages =
      4 + (has_feature(mask, HR_FEATURE_LIGHTS) ? 1 : 0) + (has_feature(mask, HR_FEATURE_GATHER) ? 1 : 0) +
      (has_feature(mask, HR_FEATURE_SECONDARY) ? 1 : 0) + (has_feature(mask, HR_FEATURE_BRANCHING) ? 1 : 0);
  CHECK(wavefront.kernel_count() == stages + 4);
  CHECK_NOTHROW(wavefront.kernel("path_shade_surface"));
  const Program megakernel(context, "megakernel", {"path/megakernel.cl", "film/accumulate.cl"},
                           ProgramOptions{mask, false});
  CHECK(megakernel.kernel_count() == 2);
}

void check_each(std::uint32_t (*mask_for)(std::uint32_t bit), unsigned first, unsigned last) {
  Context context(choose_device(""));
  for (unsigned i = first; i < last; i++) check_compiles(context, mask_for(1U << i));
}

}  // namespace

TEST_CASE("a scene calls for its shapes") {
  Scene scene = empty_scene({0, 0, 5}, {0, 0, 0});
  CHECK(mask_of(scene) == 0);
  const std::uint32_t grey = add_material(scene, diffuse(Vec3(0.5F)));
  CHECK(mask_of(scene) == 0);
  add_sphere(scene, {0, 0, 0}, 1.0, grey);
  CHECK(mask_of(scene) == HR_FEATURE_SPHERES);
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, grey);
  CHECK(mask_of(scene) == (HR_FEATURE_SPHERES | HR_FEATURE_PLANES));
  Scene round = empty_scene({0, 0, 5}, {0, 0, 0});
  round.shapes.emplace_back().material = add_material(round, mirror(0.5F));
  CHECK(mask_of(round) == (HR_FEATURE_SHAPES | kReflects));
  add_box(scene, {-1, -1, -1}, {1, 1, 1}, grey);
  CHECK(mask_of(scene) == (HR_FEATURE_SPHERES | HR_FEATURE_PLANES | HR_FEATURE_TRIANGLES));
  scene.meshes[0].colors.assign(8, Vec3(1.0F));
  add_smooth_ball(scene, {0, 0, 0}, 1.0, 4, grey);
  CHECK(mask_of(scene) == (HR_FEATURE_SPHERES | HR_FEATURE_PLANES | HR_FEATURE_TRIANGLES | HR_FEATURE_SMOOTH_NORMALS |
                           HR_FEATURE_VERTEX_COLORS));
}

TEST_CASE("a scene calls for what its materials in use do, as far as the depth lets it be seen") {
  constexpr std::uint32_t kBox = HR_FEATURE_TRIANGLES;
  Material glossy = diffuse(Vec3(0.5F));
  glossy.ks = {0.0F, 0.0F, 0.1F};
  CHECK(mask_of_material(glossy) == (kBox | HR_FEATURE_SPECULAR));
  Material metal = diffuse(Vec3(0.5F));
  metal.metallic_roughness = true;
  CHECK(mask_of_material(metal) == (kBox | HR_FEATURE_METALLIC_ROUGHNESS | HR_FEATURE_SPECULAR));
  CHECK(mask_of_material(mirror(0.5F)) == (kBox | kReflects));
  CHECK(mask_of_material(mirror(0.5F), 0) == kBox);
  Material clear = glass(1.5F);
  CHECK(mask_of_material(clear) == (kBox | kReflects | kRefracts | HR_FEATURE_BRANCHING | HR_FEATURE_FRESNEL));
  CHECK(mask_of_material(clear, 0) == kBox);
  clear.fresnel = false;
  CHECK(mask_of_material(clear) == (kBox | kReflects | kRefracts | HR_FEATURE_BRANCHING));
  clear.kr = Vec3(0.0F);
  CHECK(mask_of_material(clear) == (kBox | kRefracts));
  clear.fresnel = true;
  CHECK(mask_of_material(clear) == (kBox | kRefracts | HR_FEATURE_FRESNEL));
  CHECK(mask_of_material(emissive(Vec3(1.0F))) ==
        (kBox | HR_FEATURE_EMISSION | HR_FEATURE_EMITTERS | HR_FEATURE_LIGHTS));
  Scene unused = dark_box(diffuse(Vec3(0.5F)));
  add_material(unused, glass(1.5F));
  add_material(unused, emissive(Vec3(1.0F)));
  CHECK(mask_of(unused) == kBox);
}

TEST_CASE("a mirror beside glass that does not reflect calls for no branches") {
  Scene scene = dark_box(mirror(0.5F));
  Material clear = glass(1.5F);
  clear.kr = Vec3(0.0F);
  add_sphere(scene, {0, 0, 0}, 1.0, add_material(scene, clear));
  CHECK((mask_of(scene) & (kReflects | kRefracts)) == (kReflects | kRefracts));
  CHECK((mask_of(scene) & HR_FEATURE_BRANCHING) == 0);
}

TEST_CASE("a scene calls for its textures") {
  CHECK(mask_of(textured_box(&Material::kd_texture)) == (HR_FEATURE_TRIANGLES | HR_FEATURE_TEXTURES));
  CHECK(mask_of(textured_box(&Material::normal_texture)) ==
        (HR_FEATURE_TRIANGLES | HR_FEATURE_TEXTURES | HR_FEATURE_NORMAL_MAPS));
  // An emissive rectangle is an array light unless it has a texture.
  CHECK(mask_of(textured_box(&Material::emission_texture)) ==
        (HR_FEATURE_TRIANGLES | HR_FEATURE_TEXTURES | HR_FEATURE_EMISSION | HR_FEATURE_EMITTERS | HR_FEATURE_LIGHTS));
  Scene without_uvs = textured_box(&Material::kd_texture);
  without_uvs.meshes[0].uvs.clear();
  CHECK(mask_of(without_uvs) == HR_FEATURE_TRIANGLES);
}

TEST_CASE("a scene calls for its lights, ambient light, view and shading") {
  Scene scene = empty_scene({0, 0, 5}, {0, 0, 0});
  Light& light = add_point_light(scene, {0, 5, 0}, Vec3(1.0F));
  CHECK(mask_of(scene) == (HR_FEATURE_LIGHTS | HR_FEATURE_POINT_LIGHTS));
  light.kind = LightKind::directional;
  CHECK(mask_of(scene) == (HR_FEATURE_LIGHTS | HR_FEATURE_DIRECTIONAL_LIGHTS));
  light.kind = LightKind::spot;
  CHECK(mask_of(scene) == (HR_FEATURE_LIGHTS | HR_FEATURE_SPOT_LIGHTS));
  scene.lights.clear();
  add_area_light(scene, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}, Vec3(1.0F)).visible = false;
  CHECK(mask_of(scene) == (HR_FEATURE_LIGHTS | HR_FEATURE_AREA_LIGHTS));
  scene.lights[0].visible = true;
  CHECK(mask_of(scene) == (HR_FEATURE_LIGHTS | HR_FEATURE_AREA_LIGHTS | HR_FEATURE_TRIANGLES | HR_FEATURE_EMISSION));
  scene.lights.clear();
  add_rectangle(scene, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}, add_material(scene, emissive(Vec3(1.0F))));
  CHECK(mask_of(scene) == (HR_FEATURE_LIGHTS | HR_FEATURE_AREA_LIGHTS | HR_FEATURE_TRIANGLES | HR_FEATURE_EMISSION));
  Scene plain = empty_scene({0, 0, 5}, {0, 0, 0});
  plain.ambient = {0.0F, 0.0F, 0.1F};
  CHECK(mask_of(plain) == HR_FEATURE_AMBIENT);
  plain.camera.kind = CameraKind::orthographic;
  CHECK(mask_of(plain) == (HR_FEATURE_AMBIENT | HR_FEATURE_ORTHOGRAPHIC));
  plain.shading = Shading::phong;
  CHECK(mask_of(plain) == (HR_FEATURE_AMBIENT | HR_FEATURE_ORTHOGRAPHIC | HR_FEATURE_PHONG_SHADING));
}

TEST_CASE("features have names in the order of their bits") {
  CHECK(feature_names(0).empty());
  CHECK(feature_names(HR_FEATURE_PLANES | HR_FEATURE_TRIANGLES | HR_FEATURE_PHONG_SHADING) ==
        std::vector<std::string>{"triangles", "planes", "phong-shading"});
  CHECK(feature_names(kAll).size() == HR_FEATURE_COUNT);
}

TEST_CASE("kernels compile with no feature and with all") {
  Context context(choose_device(""));
  check_compiles(context, 0);
  check_compiles(context, kAll);
}
TEST_CASE("kernels compile with each feature alone: shapes and materials") { check_each(with_implied, 0, 11); }
TEST_CASE("kernels compile with each feature alone: lights, bounces and views") {
  check_each(with_implied, 11, HR_FEATURE_COUNT);
}
TEST_CASE("kernels compile without each feature: shapes and materials") { check_each(all_without, 0, 11); }
TEST_CASE("kernels compile without each feature: lights, bounces and views") {
  check_each(all_without, 11, HR_FEATURE_COUNT);
}

}  // namespace hemiray

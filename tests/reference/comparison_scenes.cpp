// Builds the comparison scenes; each name says what it is there for.
#include "tests/reference/comparison_scenes.hpp"

#include <cmath>
#include <string>

namespace hemiray::reference {

namespace {

Material glossy(const Vec3& kd, float ks, float shininess) {
  Material material = diffuse(kd);
  material.ks = Vec3(ks);
  material.shininess = shininess;
  return material;
}

/// A floor of 12 m x 12 m at y = 0 with a checker of 8 x 8 fields.
void add_checker_floor(Scene& scene) {
  Material material = glossy(Vec3(0.9F), 0.1F, 10.0F);
  material.kd_texture = add_texture(scene, 8, ColorSpace::srgb, [](int x, int y) {
    return (x + y) % 2 == 0 ? glm::u8vec3(230, 200, 40) : glm::u8vec3(160, 30, 20);
  });
  scene.textures.back().filter = Filter::nearest;
  add_rectangle(scene, {-6, 0, 6}, {12, 0, 0}, {0, 0, -12}, add_material(scene, material));
}

Scene whitted_spheres() {
  Scene scene = empty_scene({0.3, 2.2, 7}, {0, 1, 0}, 40.0);
  scene.background = {0.2F, 0.3F, 0.5F};
  scene.ambient = Vec3(0.1F);
  add_checker_floor(scene);
  add_sphere(scene, {-0.9, 1.3, 1.4}, 0.9, add_material(scene, glass(1.5F)));
  Material shiny = glossy(Vec3(0.1F), 0.4F, 60.0F);
  shiny.kr = Vec3(0.8F, 0.7F, 0.6F);
  add_sphere(scene, {1.1, 1.1, -0.4}, 1.0, add_material(scene, shiny));
  add_point_light(scene, {3, 6, 4}, Vec3(120.0F));
  add_point_light(scene, {-5, 4, 1}, {40.0F, 30.0F, 20.0F});
  return scene;
}

/// A box of unit half size open at the front, with two boxes and a ceiling lamp.
Scene cornell(bool lamp_is_object) {
  Scene scene = empty_scene({0, 0, 3.9}, {0, 0, 0}, 40.0);
  const std::uint32_t white = add_material(scene, diffuse(Vec3(0.75F)));
  const std::uint32_t red = add_material(scene, diffuse({0.65F, 0.05F, 0.05F}));
  const std::uint32_t green = add_material(scene, diffuse({0.12F, 0.45F, 0.15F}));
  add_rectangle(scene, {-1, -1, 1}, {2, 0, 0}, {0, 0, -2}, white);
  add_rectangle(scene, {-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, white);
  add_rectangle(scene, {-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, white);
  add_rectangle(scene, {-1, -1, 1}, {0, 0, -2}, {0, 2, 0}, red);
  add_rectangle(scene, {1, -1, -1}, {0, 0, 2}, {0, 2, 0}, green);
  const std::size_t tall = add_box(scene, {-0.3, 0, -0.3}, {0.3, 1.2, 0.3}, white);
  scene.objects[tall].to_world = glm::dmat4(glm::dvec4(0.95, 0, 0.31, 0), glm::dvec4(0, 1, 0, 0),
                                            glm::dvec4(-0.31, 0, 0.95, 0), glm::dvec4(-0.35, -1, -0.3, 1));
  add_box(scene, {0.1, -1, 0.0}, {0.65, -0.4, 0.6}, white);
  if (lamp_is_object) {
    const std::uint32_t lamp = add_material(scene, emissive({18.0F, 12.0F, 6.0F}));
    add_rectangle(scene, {-0.25, 0.98, -0.25}, {0.5, 0, 0}, {0, 0, 0.5}, lamp);
  } else {
    Light& light = add_area_light(scene, {-0.25, 0.98, -0.25}, {0.5, 0, 0}, {0, 0, 0.5}, {18.0F, 12.0F, 6.0F});
    light.samples_u = 4;
    light.samples_v = 3;
    light.jitter = false;
  }
  return scene;
}

Scene glass_and_mirrors() {
  Scene scene = empty_scene({0.5, 1.4, 6}, {0, 0.8, 0}, 42.0);
  scene.background = {0.6F, 0.7F, 0.9F};
  add_checker_floor(scene);
  add_rectangle(scene, {-3, 0, -2}, {6, 0, 0}, {0, 3, 0.3}, add_material(scene, mirror(0.9F)));
  Material tinted = glass(1.33F);
  tinted.kt = {0.9F, 0.95F, 0.7F};
  add_box(scene, {-2.1, 0.3, -0.2}, {-0.9, 1.6, 0.8}, add_material(scene, tinted));
  const std::uint32_t clear = add_material(scene, glass(1.5F));
  add_sphere(scene, {0.4, 0.9, 0.5}, 0.8, clear);
  Material constant = glass(1.5F);  // the source's constant weights, with total internal reflection
  constant.fresnel = false;
  constant.kr = Vec3(0.2F);
  constant.kt = Vec3(0.7F);
  add_box(scene, {1.5, 0.1, 0.0}, {2.3, 1.2, 1.0}, add_material(scene, constant));
  Light& sun = add_point_light(scene, {0, 0, 0}, Vec3(2.5F));
  sun.kind = LightKind::directional;
  sun.direction = glm::normalize(DVec3(-0.4, -1.0, -0.5));
  return scene;
}

Scene light_arrays(Shading shading) {
  Scene scene = empty_scene({0, 3, 7}, {0, 0.6, 0}, 45.0);
  scene.shading = shading;
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, add_material(scene, glossy({0.7F, 0.7F, 0.6F}, 0.3F, 40.0F)));
  add_sphere(scene, {-1.5, 0.8, 0}, 0.8, add_material(scene, glossy({0.2F, 0.5F, 0.7F}, 0.5F, 80.0F)));
  add_box(scene, {0.8, 0.0, -0.8}, {1.9, 1.4, 0.5}, add_material(scene, diffuse({0.7F, 0.3F, 0.2F})));
  const float unit = shading == Shading::phong ? 0.1F : 1.0F;
  Light& regular = add_area_light(scene, {-2.5, 3.5, -1}, {1, 0, 0}, {0, 0, 1}, Vec3(8.0F * unit));
  regular.samples_u = regular.samples_v = 2;
  regular.jitter = false;
  Light& jittered = add_area_light(scene, {1, 3, 0.5}, {1, 0.2, 0}, {0, 0, 1.5}, Vec3(4.0F, 5.0F, 6.0F) * unit);
  jittered.samples_u = 5;
  jittered.samples_v = 3;
  add_area_light(scene, {-0.5, 4, 2}, {0.5, 0, 0}, {0, 0, 0.5}, Vec3(10.0F) * unit).visible = false;
  Light& spot = add_point_light(scene, {0, 4, 3}, Vec3(20.0F) * unit);
  spot.kind = LightKind::spot;
  spot.direction = glm::normalize(DVec3(0, -1, -0.7));
  spot.inner_angle_deg = 12.0;
  spot.outer_angle_deg = 30.0;
  return scene;
}

Scene textured_meshes() {
  Scene scene = empty_scene({0, 1.5, 6}, {0, 0.9, 0}, 40.0);
  scene.ambient = Vec3(0.05F);
  const int bumps = add_texture(scene, 16, ColorSpace::linear, [](int x, int y) {
    return glm::u8vec3(128 + (x % 4 - 1) * 30, 128 + (y % 4 - 2) * 30, 230);
  });
  const int patches = add_texture(scene, 4, ColorSpace::srgb,
                                  [](int x, int y) { return glm::u8vec3(60 + 60 * x, 60 + 60 * y, 240 - 50 * x); });
  const int rough =
      add_texture(scene, 4, ColorSpace::linear, [](int x, int y) { return glm::u8vec3(0, 130 + 30 * x, 60 * y); });
  Material metal = diffuse({0.9F, 0.8F, 0.7F});
  metal.metallic_roughness = true;
  metal.metallic = 0.8F;
  metal.roughness = 0.7F;
  metal.kd_texture = patches;
  metal.metallic_roughness_texture = rough;
  metal.normal_texture = bumps;
  metal.normal_scale = 0.8F;
  const std::size_t ball = add_smooth_ball(scene, {0, 0, 0}, 1.0, 12, add_material(scene, metal));
  scene.objects[ball].to_world =
      glm::dmat4(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, 0.8, 0, 0), glm::dvec4(0, 0, 1.2, 0), glm::dvec4(-1.2, 1, 0, 1));
  Object second = scene.objects[ball];  // the same mesh, mirrored, with a material of its own
  second.to_world[0][0] = -0.9;
  second.to_world[3][0] = 1.3;
  Material plain = glossy(Vec3(0.8F), 0.3F, 30.0F);
  plain.kd_texture = patches;
  plain.normal_texture = bumps;
  second.material = static_cast<int>(add_material(scene, plain));
  scene.objects.push_back(second);
  add_rectangle(scene, {-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, add_material(scene, diffuse(Vec3(1.0F))));
  scene.meshes.back().colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  scene.textures[static_cast<std::size_t>(patches)].wrap_u = Wrap::mirror;
  add_point_light(scene, {2, 5, 4}, Vec3(90.0F));
  add_point_light(scene, {-4, 3, 3}, {20.0F, 30.0F, 40.0F});
  return scene;
}

Scene emitters() {
  Scene scene = empty_scene({0, 2, 6}, {0, 0.8, 0}, 45.0);
  scene.emitter_samples = 12;
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, add_material(scene, diffuse(Vec3(0.7F))));
  add_plane(scene, {0, 0, -2.5}, {0, 0, 1}, add_material(scene, glossy({0.5F, 0.6F, 0.7F}, 0.2F, 20.0F)));
  const std::uint32_t warm = add_material(scene, emissive({8.0F, 5.0F, 2.0F}));
  add_sphere(scene, {-1.5, 1.6, -0.5}, 0.35, warm);
  const std::uint32_t cold = add_material(scene, emissive({2.0F, 4.0F, 7.0F}));
  add_box(scene, {1.2, 1.4, -1.0}, {1.8, 2.0, -0.4}, cold);
  Material screen = emissive(Vec3(6.0F));
  screen.emission_texture = add_texture(scene, 4, ColorSpace::linear,
                                        [](int x, int y) { return glm::u8vec3(60 * x + 50, 60 * y + 50, 128); });
  add_rectangle(scene, {-0.5, 0.4, -2.0}, {1, 0, 0}, {0, 0.8, 0}, add_material(scene, screen));
  add_sphere(scene, {0.2, 0.5, 0.6}, 0.5, add_material(scene, diffuse(Vec3(0.8F))));
  return scene;
}

Scene map_view() {
  Scene scene = empty_scene({4, 5, 6}, {0, 0, 0});
  scene.camera.kind = CameraKind::orthographic;
  scene.camera.height_m = 6.0;
  scene.ambient = {0.1F, 0.15F, 0.2F};
  Material floor = diffuse({0.5F, 0.5F, 0.4F});
  floor.ka = Vec3(1.0F, 0.5F, 0.25F);
  floor.kr = Vec3(0.3F);
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, add_material(scene, floor));
  add_box(scene, {-1, 0, -1}, {0, 1.5, 0}, add_material(scene, diffuse({0.8F, 0.2F, 0.2F})));
  add_smooth_ball(scene, {1, 0.9, 0.6}, 0.9, 10, add_material(scene, glass(1.4F)));
  add_point_light(scene, {2, 6, -1}, Vec3(60.0F));
  return scene;
}

Shape placed_shape(ShapeKind kind, const DMat4& to_world, std::uint32_t material) {
  Shape shape;
  shape.kind = kind;
  shape.to_world = to_world;
  shape.material = material;
  return shape;
}

/// A frame with z along `axis`, at `place`.
DMat4 upright(const DVec3& place, const DVec3& axis) {
  const DVec3 z = glm::normalize(axis), x = glm::normalize(glm::cross(DVec3(0.3, 0.2, 0.9), z));
  return {glm::dvec4(x, 0.0), glm::dvec4(glm::cross(z, x), 0.0), glm::dvec4(z, 0.0), glm::dvec4(place, 1.0)};
}

/// Every kind of shape, in glass, mirror and plain; open ones seen from inside.
Scene analytic_shapes() {
  Scene scene = empty_scene({0.4, 2.6, 7.5}, {0.1, 0.8, 0}, 38.0);
  scene.background = {0.3F, 0.45F, 0.7F};
  scene.ambient = Vec3(0.15F);
  const std::uint32_t floor = add_material(scene, glossy(Vec3(0.6F), 0.2F, 20.0F));
  const std::uint32_t clear = add_material(scene, glass(1.5F));
  const std::uint32_t silver = add_material(scene, mirror(0.85F));
  const std::uint32_t red = add_material(scene, glossy({0.7F, 0.15F, 0.1F}, 0.3F, 50.0F));
  const DVec3 up(0, 1, 0);
  const auto add = [&scene](Shape shape) -> Shape& { return scene.shapes.emplace_back(std::move(shape)); };
  add(placed_shape(ShapeKind::disk, upright({0, 0, 0}, up), floor)).radius = 4.0;
  add(placed_shape(ShapeKind::disk, upright({0, 1.4, -2.5}, {0.1, 0.05, 1}), silver)).radius = 1.3;
  Shape& column = add(placed_shape(ShapeKind::cylinder, upright({-0.3, 0.62, 1.5}, {0.1, 1, 0.05}), clear));
  column.radius = column.upper_radius = 0.4;
  column.half_height = 0.55;
  Shape& pipe = add(placed_shape(ShapeKind::cylinder, upright({1.7, 0.4, 1.6}, {1.0, 0.1, -0.9}), red));
  pipe.radius = pipe.upper_radius = 0.35;
  pipe.half_height = 0.6;
  pipe.capped = false;
  Shape& cone = add(placed_shape(ShapeKind::cone, upright({-2.2, 0.75, 0.2}, up), red));
  cone.radius = 0.6;
  cone.upper_radius = 0.0;
  cone.half_height = 0.7;
  Shape& frustum = add(placed_shape(ShapeKind::cone, upright({2.3, 0.7, -0.4}, {-0.1, 1, 0.1}), silver));
  frustum.radius = 0.6;
  frustum.upper_radius = 0.25;
  frustum.half_height = 0.6;
  Shape& egg = add(placed_shape(ShapeKind::quadric, upright({-1.3, 0.5, 2.0}, {0.3, 1, 0.2}), clear));
  egg.coefficients = {1.0, 2.0, 1.5, 0.2, 0, 0, 0, 0, 0, -0.16};
  Shape& tower = add(placed_shape(ShapeKind::quadric, upright({-0.9, 0.76, -0.7}, up), floor));
  tower.coefficients = {1, 1, -0.5, 0, 0, 0, 0, 0, 0, -0.09};
  tower.clip = Clip::box;
  tower.clip_half = {1, 1, 0.75};
  Shape& bowl = add(placed_shape(ShapeKind::quadric, upright({0.9, 0.05, 0.3}, {0.1, 1, 0}), silver));
  bowl.coefficients = {1, 1.2, 0, 0, 0, 0, 0, 0, -0.6, 0};
  bowl.clip = Clip::sphere;
  bowl.clip_center = {0, 0, 0.4};
  bowl.clip_radius = 0.7;
  add_point_light(scene, {3.5, 5.5, 4.5}, Vec3(150.0F, 140.0F, 130.0F));
  Light& sun = add_point_light(scene, {0, 0, 0}, Vec3(0.6F));
  sun.kind = LightKind::directional;
  sun.direction = glm::normalize(DVec3(0.5, -1.0, -0.6));
  return scene;
}

/// A mirror of degree 4, a heart of degree 6 and a torus of glass.
Scene implicit_surfaces() {
  Scene scene = empty_scene({0.3, 2.2, 6.5}, {0, 0.6, 0}, 36.0);
  scene.background = {0.4F, 0.5F, 0.7F};
  scene.ambient = Vec3(0.1F);
  add_checker_floor(scene);
  const auto add = [&scene](const std::string& text, double clip, const DMat4& to_world, const Material& material) {
    Shape& shape =
        scene.shapes.emplace_back(placed_shape(ShapeKind::implicit, to_world, add_material(scene, material)));
    shape.expression = parse_expression(text, {{"R", 0.6}, {"r", 0.25}});
    shape.clip = Clip::box;
    shape.clip_half = DVec3(clip);
  };
  add("x^4 + y^4 + z^4 - 0.25", 0.8, upright({-1.3, 0.9, -0.6}, {0.3, 1, 0.4}), mirror(0.85F));
  add("(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3", 1.4, upright({1.2, 1.1, -0.8}, {0.05, 1, 0.1}),
      glossy({0.7F, 0.1F, 0.1F}, 0.3F, 40.0F));
  add("(x^2+y^2+z^2+R^2-r^2)^2 - 4*R^2*(x^2+y^2)", 0.9, upright({0.2, 0.55, 1.3}, {0.2, 0.8, 0.6}), glass(1.5F));
  add_point_light(scene, {3, 6, 5}, Vec3(140.0F));
  Light& sun = add_point_light(scene, {0, 0, 0}, Vec3(0.8F));
  sun.kind = LightKind::directional;
  sun.direction = glm::normalize(DVec3(0.5, -1.0, -0.3));
  return scene;
}

/// The spheres again, scaled and moved: offsets that suit one size and place show here.
Scene moved(Scene scene, double scale, const DVec3& offset) {
  const DVec3 eye(scene.camera.to_world[3]);
  scene.camera.to_world[3] = glm::dvec4(eye * scale + offset, 1.0);
  for (Object& object : scene.objects) {
    object.to_world = glm::dmat4(glm::dvec4(scale, 0, 0, 0), glm::dvec4(0, scale, 0, 0), glm::dvec4(0, 0, scale, 0),
                                 glm::dvec4(offset, 1.0)) *
                      object.to_world;
  }
  for (Sphere& sphere : scene.spheres) {
    sphere.center = sphere.center * scale + offset;
    sphere.radius *= scale;
  }
  for (Shape& shape : scene.shapes) {
    shape.to_world = glm::dmat4(glm::dvec4(scale, 0, 0, 0), glm::dvec4(0, scale, 0, 0), glm::dvec4(0, 0, scale, 0),
                                glm::dvec4(offset, 1.0)) *
                     shape.to_world;
  }
  for (Light& light : scene.lights) {
    light.position = light.position * scale + offset;
    light.intensity *= static_cast<float>(scale * scale);
  }
  return scene;
}

}  // namespace

std::vector<ComparisonScene> comparison_scenes() {
  std::vector<ComparisonScene> list;
  const auto add = [&list](const std::string& name, Scene scene, const ReferenceOptions& options) {
    list.push_back({name, std::move(scene), options});
  };
  add("whitted spheres", whitted_spheres(), {64, 48, 1, 6, 0});
  add("whitted spheres, 4 samples, seed 5", whitted_spheres(), {32, 24, 4, 4, 5});
  add("whitted spheres, depth 0", whitted_spheres(), {32, 24, 1, 0, 0});
  add("whitted spheres, 1000 times as large", moved(whitted_spheres(), 1000.0, DVec3(0.0)), {48, 32, 1, 6, 0});
  add("whitted spheres, 50 m from the origin", moved(whitted_spheres(), 1.0, {50, -20, 35}), {48, 32, 1, 6, 0});
  add("cornell box, emissive rectangle", cornell(true), {48, 48, 2, 2, 1});
  add("cornell box, regular array", cornell(false), {48, 48, 1, 2, 1});
  add("glass and mirrors", glass_and_mirrors(), {64, 48, 1, 5, 0});
  add("light arrays", light_arrays(Shading::physical), {48, 32, 2, 1, 3});
  add("light arrays, phong", light_arrays(Shading::phong), {48, 32, 1, 1, 3});
  add("textured meshes", textured_meshes(), {64, 48, 1, 1, 0});
  add("emitters", emitters(), {48, 32, 1, 1, 2});
  add("map view", map_view(), {48, 48, 1, 4, 0});
  add("analytic shapes", analytic_shapes(), {64, 40, 1, 5, 0});
  add("analytic shapes, 50 m from the origin", moved(analytic_shapes(), 1.0, {50, -20, 35}), {48, 32, 1, 4, 0});
  add("implicit surfaces", implicit_surfaces(), {48, 32, 1, 4, 0});
  return list;
}

}  // namespace hemiray::reference

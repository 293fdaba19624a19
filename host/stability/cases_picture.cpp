// Small scenes rendered: rooms closed all around before a background that can be seen through a leak alone, in which
// every pixel's value is known. Walls shine by the ambient term, 1; a surface that is passed halves the light.
#include <cmath>
#include <span>
#include <utility>

#include "host/path/render.hpp"
#include "host/scene/look_at.hpp"
#include "host/stability/rung.hpp"

namespace hemiray::stability {
namespace {

constexpr float kOutside = 1000.0F;  // radiance of the background

Material wall() {
  Material material;
  material.kd = Vec3(0.0F);
  material.ka = Vec3(1.0F);
  return material;
}

Material mirror() {
  Material material = wall();
  material.kr = Vec3(1.0F);
  return material;
}

// Halves what passes; reflects nothing.
Material glass(float ior) {
  Material material;
  material.kd = Vec3(0.0F);
  material.kt = Vec3(0.5F);
  material.fresnel = false;
  material.ior = ior;
  return material;
}

// The cube from -half to half about `center`, seen from inside, without its ceiling if so wanted.
void add_room(Scene& scene, double half, DVec3 center, std::uint32_t material, bool ceiling = true) {
  Mesh mesh;
  for (unsigned corner = 0; corner < 8; corner++) {
    mesh.positions.emplace_back(((corner & 1U) != 0 ? half : -half), ((corner & 2U) != 0 ? half : -half),
                                ((corner & 4U) != 0 ? half : -half));
  }
  const auto face = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.emplace_back(a, b, c);
    mesh.triangles.emplace_back(a, c, d);
  };
  face(0, 2, 6, 4);
  face(1, 5, 7, 3);
  face(0, 4, 5, 1);
  if (ceiling) face(2, 3, 7, 6);
  face(0, 1, 3, 2);
  face(4, 6, 7, 5);
  mesh.triangle_materials.assign(mesh.triangles.size(), material);
  Object object;
  object.mesh = static_cast<std::uint32_t>(scene.meshes.size());
  object.to_world[3] = glm::dvec4(center, 1.0);
  scene.meshes.push_back(std::move(mesh));
  scene.objects.push_back(object);
}

void add_sphere(Scene& scene, DVec3 center, double radius, std::uint32_t material) {
  Sphere sphere;
  sphere.center = center;
  sphere.radius = radius;
  sphere.material = material;
  scene.spheres.push_back(sphere);
}

Scene empty_room() {
  Scene scene;
  scene.background = Vec3(kOutside);
  scene.ambient = Vec3(1.0F);
  scene.has_camera = scene.has_lights = true;
  scene.materials.push_back(wall());
  return scene;
}

void look(Scene& scene, DVec3 from, DVec3 to, double fov_deg) {
  const DVec3 up = std::abs(glm::normalize(to - from).y) > 0.9 ? DVec3(0, 0, 1) : DVec3(0, 1, 0);
  scene.camera.to_world = look_at_matrix(from, to, up);
  scene.camera.fov_y_deg = fov_deg;
}

// The red values of a square picture of about so many pixels, an odd number a side.
std::vector<float> render(const PictureRun& run, const Scene& scene, int depth) {
  RenderOptions options;
  options.double_precision = run.double_precision;
  options.strict = run.strict;
  options.width = options.height = static_cast<int>(std::sqrt(static_cast<double>(run.pixels))) | 1;
  options.spp = 1;
  options.depth = depth;
  const RenderResult result = render_scene(run.context, scene, options);
  const Layer& layer = *result.image.find("");
  std::vector<float> red;
  for (std::size_t i = 0; i < result.image.pixel_count(); i++) red.push_back(layer.data[i * layer.channels.size()]);
  run.answers.add(std::span<const float>(red));
  return red;
}

// What became of the light that passed surfaces: its value is a power of 1/2.
struct Passed {
  bool leaked = false;  // or lost, or no power
  int surfaces = 0;
};
Passed surfaces_passed(float value) {
  if (!(value > 0.0F) || value > 1.5F) return {true, 0};
  const double power = -std::log2(static_cast<double>(value));
  return {std::abs(power - std::round(power)) > 1e-3, static_cast<int>(std::round(power))};
}

// Three spheres in each other, denser inwards, so that nothing is reflected totally and each is passed twice or not at
// all.
Tally nested(const PictureRun& run, double gap) {
  Scene scene = empty_room();
  add_room(scene, 4.0, DVec3(0.0), 0);
  const DVec3 center(0.1, 0.2, -0.3);
  for (int i = 0; i < 3; i++) {
    scene.materials.push_back(glass(1.2F));
    add_sphere(scene, center, 1.0 - i * gap, static_cast<std::uint32_t>(i + 1));
  }
  look(scene, {0.3, 0.4, 3.2}, center, 36.0);
  Tally tally;
  for (const float value : render(run, scene, 12)) {
    const Passed passed = surfaces_passed(value);
    tally.rays++;
    if (value == 0.0F) {
      tally.borderline++;  // just touched: rounding reflects it totally
    } else if (passed.leaked || passed.surfaces > 6) {
      tally.missed++;
    } else if (passed.surfaces % 2 != 0) {
      tally.tunnelled++;
    }
  }
  return tally;
}

// Every path meets a wall 65 times.
Tally mirrors(const PictureRun& run, double at) {
  constexpr int kDepth = 64;
  Scene scene = empty_room();
  scene.materials.push_back(mirror());
  const DVec3 center = at * DVec3(1.0, -0.7, 0.3);
  add_room(scene, 4.0, center, 1);
  look(scene, center, center + DVec3(1.0), 100.0);
  Tally tally;
  for (const float value : render(run, scene, kDepth)) {
    tally.rays++;
    tally.missed += value == static_cast<float>(kDepth + 1) ? 0 : 1;
  }
  return tally;
}

// The camera stands `share` of a radius from the centre of a glass ball. What is not reflected totally passes one
// surface.
Tally inside_glass(const PictureRun& run, double share) {
  constexpr float kIndex = 1.5F;
  Scene scene = empty_room();
  scene.materials.push_back(glass(kIndex));
  add_room(scene, 4.0, DVec3(0.0), 0);
  const DVec3 center(0.1, 0.2, -0.3), way = glm::normalize(DVec3(1.0, 0.3, -0.4));
  add_sphere(scene, center, 1.0, 1);
  look(scene, center + share * way, center + 2.0 * way, 100.0);
  Tally tally;
  for (const float value : render(run, scene, 12)) {
    tally.rays++;
    if (value == 0.0F && share > 1.0 / kIndex) continue;  // reflected totally
    const Passed passed = surfaces_passed(value);
    if (passed.leaked) {
      tally.missed++;
    } else if (passed.surfaces != 1) {
      tally.tunnelled++;
    }
  }
  return tally;
}

// The floor under a lamp so far below the ceiling, with and without that.
Tally lamp(const PictureRun& run, double gap) {
  std::vector<float> with, without;
  for (const bool ceiling : {true, false}) {
    Scene scene = empty_room();
    scene.ambient = Vec3(0.0F);
    scene.background = Vec3(0.0F);
    scene.materials[0].kd = Vec3(0.8F);
    add_room(scene, 4.0, DVec3(0.0), 0, ceiling);
    Light light;
    light.kind = LightKind::area;
    light.position = {-1.3, 4.0 - gap, -0.9};
    light.edge_u = {2.1, 0.0, 0.0};
    light.edge_v = {0.0, 0.0, 1.7};
    light.intensity = Vec3(10.0F);
    light.jitter = false;
    scene.lights.push_back(light);
    look(scene, {0.0, 3.0, 0.0}, {0.0, -4.0, 0.0}, 60.0);
    (ceiling ? with : without) = render(run, scene, 1);
  }
  Tally tally;
  for (std::size_t i = 0; i < with.size(); i++) {
    tally.rays++;
    // Nothing is in the way in either; sums may be in another order.
    tally.false_hit += std::abs(with[i] - without[i]) <= 1e-5F * without[i] && without[i] > 0.0F ? 0 : 1;
  }
  return tally;
}

template <typename Judge>
std::function<Rung()> picture(std::string name, double value, Judge judge) {
  return [=] {
    Rung rung;
    rung.name = name;
    rung.kind = RungKind::picture;
    rung.picture = [=](const PictureRun& run) { return judge(run, value); };
    return rung;
  };
}

}  // namespace

std::vector<Case> picture_cases() {
  Case glasses{"nested dielectrics",
               "Three glass balls in each other, so far apart, rendered in a closed room: each is "
               "passed twice or not at all.",
               {}};
  constexpr std::pair<const char*, double> kGaps[] = {{"1e-1", 1e-1}, {"1e-2", 1e-2}, {"1e-3", 1e-3},
                                                      {"1e-4", 1e-4}, {"1e-5", 1e-5}, {"1e-6", 1e-6}};
  for (const auto& [name, value] : kGaps) glasses.rungs.push_back(picture(name, value, nested));
  Case corner{"corner cube of mirrors",
              "A closed room of mirrors, so far from the origin, looked at along its diagonal, "
              "64 reflections: every path meets 65 walls.",
              {}};
  constexpr std::pair<const char*, double> kPlaces[] = {{"0", 0.0}, {"1e2", 1e2}, {"1e4", 1e4}, {"1e6", 1e6}};
  for (const auto& [name, value] : kPlaces) corner.rungs.push_back(picture(name, value, mirrors));
  Case camera{"camera inside glass",
              "So much of the radius of a glass ball from its centre, looking at the near side: "
              "one surface is passed.",
              {}};
  constexpr std::pair<const char*, double> kShares[] = {{"0", 0.0},       {"0.5", 0.5},         {"0.9", 0.9},
                                                        {"0.999", 0.999}, {"0.99999", 0.99999}, {"0.999999", 0.999999}};
  for (const auto& [name, value] : kShares) camera.rungs.push_back(picture(name, value, inside_glass));
  Case light{"light on a surface",
             "The floor under a lamp so far below the ceiling, 0 being in it: the ceiling shades "
             "nothing.",
             {}};
  constexpr std::pair<const char*, double> kLamps[] = {{"1e-3", 1e-3}, {"1e-5", 1e-5}, {"5e-7", 5e-7}, {"0", 0.0}};
  for (const auto& [name, value] : kLamps) light.rungs.push_back(picture(name, value, lamp));
  return {std::move(glasses), std::move(corner), std::move(camera), std::move(light)};
}

}  // namespace hemiray::stability

#include "host/bench/procedural_scenes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "host/base/error.hpp"
#include "host/base/spelling.hpp"
#include "host/bench/flat_mesh.hpp"
#include "host/bench/interior_scene.hpp"
#include "host/bench/leak_meshes.hpp"

namespace hemiray::bench {
namespace {

constexpr std::array<std::string_view, 4> kNames{"interior", "terrain", "hair", "instances"};
constexpr float kPi = std::numbers::pi_v<float>;

Vec3 random_direction(Dice& dice) {
  const float z = dice.in(-1, 1), phi = dice.in(0, 2 * kPi);
  const float r = std::sqrt(std::max(0.0F, 1 - z * z));
  return {r * std::cos(phi), r * std::sin(phi), z};
}

// Seven octaves of turned waves: hills of 20 m down to bumps of a few centimetres.
float terrain_height(Vec2 p) {
  float height = 0.0F, amplitude = 6.0F;
  for (int octave = 0; octave < 7; octave++) {
    height += amplitude * std::sin(p.x * 0.13F + 1.7F * static_cast<float>(octave)) * std::cos(p.y * 0.11F);
    amplitude *= 0.45F;
    p = 2.1F * Vec2(0.8F * p.x - 0.6F * p.y, 0.6F * p.x + 0.8F * p.y);
  }
  return height;
}

FlatScene terrain_scene(std::uint32_t triangles) {
  constexpr float kWidth = 100.0F;  // [m]
  const double cells = triangles / 2.0;
  const auto rows = static_cast<std::uint32_t>(std::lround(std::sqrt(cells)));
  const auto columns = static_cast<std::uint32_t>(std::lround(cells / rows));
  FlatMesh mesh;
  const auto place = [](std::uint32_t i, std::uint32_t n) {
    return kWidth * (static_cast<float>(i) / static_cast<float>(n) - 0.5F);
  };
  for (std::uint32_t row = 0; row <= rows; row++) {
    for (std::uint32_t column = 0; column <= columns; column++) {
      const Vec2 p(place(column, columns), place(row, rows));
      mesh.vertex({p.x, terrain_height(p), p.y});
    }
  }
  mesh.grid(0, rows + 1, columns + 1);
  return std::move(mesh).take();
}

// A ribbon that leaves the ball along `out` and bends down as it goes.
void add_strand(FlatMesh& mesh, Dice& dice, std::uint32_t segments) {
  constexpr float kBall = 0.2F, kLength = 0.25F, kWidth = 0.0005F;  // [m]
  const Vec3 out = random_direction(dice);
  const Vec3 side = glm::normalize(glm::cross(out, random_direction(dice) + Vec3(1e-3F, 2e-3F, 0)));
  const float fall = dice.in(0.2F, 1.2F), step = kLength / static_cast<float>(segments);
  Vec3 p = kBall * out;
  const std::uint32_t first = mesh.vertex_count();
  for (std::uint32_t i = 0; i <= segments; i++) {
    mesh.vertex(p - 0.5F * kWidth * side);
    mesh.vertex(p + 0.5F * kWidth * side);
    const float along = static_cast<float>(i) / static_cast<float>(segments);
    p += step * glm::normalize(out + fall * along * Vec3(0, -1, 0) + 0.1F * random_direction(dice));
  }
  mesh.grid(first, segments + 1, 2);
}

FlatScene hair_scene(std::uint32_t triangles) {
  constexpr std::uint32_t kSegments = 8;
  FlatMesh mesh;
  Dice dice(2);
  const auto strands = static_cast<std::uint32_t>(std::lround(triangles / (2.0 * kSegments)));
  for (std::uint32_t strand = 0; strand < strands; strand++) add_strand(mesh, dice, kSegments);
  return std::move(mesh).take();
}

Mesh bumpy_ball() {
  constexpr std::uint32_t kCells = 4;  // 12 * 4^2 = 192 triangles
  const FlatScene ball = closed_mesh(kCells, true, Vec3(0.0F));
  Mesh mesh;
  mesh.name = "ball";
  for (std::uint32_t i = 0; i < ball.positions.size() / 3; i++) {
    const Vec3 p = vertex_of(ball, i);
    mesh.positions.push_back(p * (1.0F + 0.15F * std::sin(9 * p.x + 5 * p.y) * std::cos(7 * p.z)));
  }
  for (const shared::uint4& t : ball.triangles) mesh.triangles.emplace_back(t.x, t.y, t.z);
  mesh.triangle_materials.assign(mesh.triangles.size(), 0);
  return mesh;
}

}  // namespace

std::span<const std::string_view> procedural_scene_names() { return kNames; }

Scene instanced_scene(std::uint32_t triangles) {
  Scene scene;
  scene.title = "instances";
  scene.materials.emplace_back();
  scene.meshes.push_back(bumpy_ball());
  const auto copies = std::lround(triangles / static_cast<double>(scene.meshes[0].triangles.size()));
  // The room grows with the number of copies, so that they are as close for any.
  const float half = 1.2F * static_cast<float>(std::cbrt(static_cast<double>(copies)));
  Dice dice(3);
  for (long copy = 0; copy < copies; copy++) {
    const Vec3 place(dice.in(-half, half), dice.in(-half, half), dice.in(-half, half));
    const Vec3 axis = random_direction(dice);
    const double angle = dice.in(0, 2 * kPi), size = dice.in(0.3F, 1.0F);
    Object object;
    object.to_world = glm::translate(DMat4(1.0), DVec3(place));
    object.to_world = glm::rotate(object.to_world, angle, glm::normalize(DVec3(axis)));
    object.to_world = glm::scale(object.to_world, DVec3(size));
    scene.objects.push_back(object);
  }
  return scene;
}

BenchScene procedural_scene(std::string_view name, std::uint32_t triangles) {
  if (std::find(kNames.begin(), kNames.end(), name) == kNames.end()) {
    throw InputError("SCENE", in_quotes(name) + " is not a scene of the benchmark" + spelling_hint(name, kNames));
  }
  if (triangles < kLeastTriangles || triangles > kMostTriangles) {
    throw InputError("--triangles", fmt::format("{} triangles; scenes are made from {} to {}", triangles,
                                                kLeastTriangles, kMostTriangles));
  }
  BenchScene scene{std::string(name), {}, {}};
  if (name == "interior") {
    scene.flat = interior_scene(triangles);
    scene.view = interior_view();
    return scene;
  }
  if (name == "instances") {
    const Scene copies = instanced_scene(triangles);
    scene.flat = flatten_scene(copies);
    scene.instanced = flatten_scene(copies, Instancing::always);
  } else {
    scene.flat = name == "terrain" ? terrain_scene(triangles) : hair_scene(triangles);
  }
  scene.view = framing_view(scene.flat);
  return scene;
}

}  // namespace hemiray::bench

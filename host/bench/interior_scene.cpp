// The order of the random numbers is part of the scene: the bars hold for this very room.
#include "host/bench/interior_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/bench/flat_mesh.hpp"

namespace hemiray::bench {
namespace {

constexpr float kHalfWidth = 10.0F, kHeight = 6.0F;  // [m]
constexpr double kFloorShare = 0.25, kSphereShare = 0.40;
constexpr std::uint32_t kSpheres = 14;
constexpr std::size_t kBoxTriangles = 12;
constexpr float kPi = std::numbers::pi_v<float>;

void add_walls(FlatMesh& mesh) {
  const float w = kHalfWidth, h = kHeight;
  mesh.quad({-w, 0, -w}, {w, 0, -w}, {w, 0, w}, {-w, 0, w});
  mesh.quad({-w, h, -w}, {-w, h, w}, {w, h, w}, {w, h, -w});
  mesh.quad({-w, 0, -w}, {-w, h, -w}, {w, h, -w}, {w, 0, -w});
  mesh.quad({-w, 0, w}, {w, 0, w}, {w, h, w}, {-w, h, w});
  mesh.quad({-w, 0, -w}, {-w, 0, w}, {-w, h, w}, {-w, h, -w});
  mesh.quad({w, 0, -w}, {w, h, -w}, {w, h, w}, {w, 0, w});
}

void add_tables(FlatMesh& mesh, Dice& dice) {
  constexpr int kTables = 30;
  for (int table = 0; table < kTables; table++) {
    const float x = dice.in(-8, 8), top = dice.in(0.8F, 1.6F), z = dice.in(-8, 8);
    const float turn = dice.in(0, 6), half_x = dice.in(0.5F, 1.2F), half_z = dice.in(0.4F, 0.8F);
    mesh.box({x, top, z}, {half_x, 0.04F, half_z}, turn);
    for (const float leg_z : {-0.3F, 0.3F}) {
      for (const float leg_x : {-0.35F, 0.35F}) {
        mesh.box({x + leg_x, top * 0.5F, z + leg_z}, {0.03F, top * 0.5F, 0.03F}, 0.3F);
      }
    }
  }
}

// From floor to ceiling in one piece: 48 strips a column, up to 250 times as high as wide.
void add_columns(FlatMesh& mesh, Dice& dice) {
  constexpr int kColumns = 40;
  constexpr std::uint32_t kStrips = 48;
  for (int column = 0; column < kColumns; column++) {
    const float x = dice.in(-9, 9), z = dice.in(-9, 9), radius = dice.in(0.03F, 0.3F);
    const std::uint32_t first = mesh.vertex_count();
    for (std::uint32_t strip = 0; strip < kStrips; strip++) {
      const float angle = static_cast<float>(strip) * 2.0F * kPi / static_cast<float>(kStrips);
      const float edge_x = x + radius * std::cos(angle), edge_z = z + radius * std::sin(angle);
      mesh.vertex({edge_x, 0, edge_z});
      mesh.vertex({edge_x, kHeight, edge_z});
    }
    for (std::uint32_t strip = 0; strip < kStrips; strip++) {
      const std::uint32_t here = first + 2 * strip, next = first + 2 * ((strip + 1) % kStrips);
      mesh.triangle(here, here + 1, next);
      mesh.triangle(next, here + 1, next + 1);
    }
  }
}

float floor_height(float x, float z) {
  const float swell = 0.12F * std::sin(x * 1.7F) * std::cos(z * 2.1F);
  const float waves = 0.03F * std::sin(x * 13) * std::sin(z * 17);
  const float ripples = 0.01F * std::sin(x * 57 + z * 41);
  return 0.15F + swell + waves + ripples;
}

void add_floor(FlatMesh& mesh, double triangles) {
  const auto cells = static_cast<std::uint32_t>(std::sqrt(triangles / 2));
  const std::uint32_t first = mesh.vertex_count();
  const auto place = [cells](std::uint32_t i) {
    return -kHalfWidth + 2 * kHalfWidth * static_cast<float>(i) / static_cast<float>(cells);
  };
  for (std::uint32_t row = 0; row <= cells; row++) {
    for (std::uint32_t column = 0; column <= cells; column++) {
      mesh.vertex({place(column), floor_height(place(column), place(row)), place(row)});
    }
  }
  mesh.grid(first, cells + 1, cells + 1);
}

void add_sphere(FlatMesh& mesh, Dice& dice, std::uint32_t slices) {
  const std::uint32_t stacks = slices / 2;
  const float x = dice.in(-8, 8), y = dice.in(0.8F, 4.5F), z = dice.in(-8, 8), radius = dice.in(0.3F, 1.3F);
  const float lumps_theta = dice.in(3, 9), lumps_phi = dice.in(3, 9);
  const std::uint32_t first = mesh.vertex_count();
  for (std::uint32_t stack = 0; stack <= stacks; stack++) {
    for (std::uint32_t slice = 0; slice <= slices; slice++) {
      const float theta = kPi * static_cast<float>(stack) / static_cast<float>(stacks);
      const float phi = 2.0F * kPi * static_cast<float>(slice) / static_cast<float>(slices);
      const float lumps = 0.12F * std::sin(lumps_theta * theta * 2) * std::sin(lumps_phi * phi);
      const float bumps = 0.02F * std::sin(31 * theta) * std::sin(29 * phi);
      const float r = radius * (1 + lumps + bumps + 0.004F * dice.in(-1, 1));
      mesh.vertex(
          {x + r * std::sin(theta) * std::cos(phi), y + r * std::cos(theta), z + r * std::sin(theta) * std::sin(phi)});
    }
  }
  mesh.grid(first, stacks + 1, slices + 1);
}

void add_spheres(FlatMesh& mesh, Dice& dice, double triangles) {
  const auto cells_each = static_cast<std::uint32_t>(triangles / kSpheres / 2);
  const auto slices = static_cast<std::uint32_t>(std::sqrt(cells_each * 2.0));
  for (std::uint32_t sphere = 0; sphere < kSpheres; sphere++) add_sphere(mesh, dice, slices);
}

// One small box in a cluster around `center`; one in fifty is six times as large.
void add_clutter_box(FlatMesh& mesh, Dice& dice, Vec3 center, float spread) {
  float size = dice.in(0.004F, 0.03F);
  if (dice.one_in(50)) size *= 6.0F;
  const float turn = dice.in(0, 6);
  const float half_x = size * dice.in(0.3F, 2), half_y = size * dice.in(0.3F, 2), half_z = size * dice.in(0.3F, 2);
  const float x = center.x + spread * dice.in(-1, 1);
  const float y = std::max(0.05F, center.y + 0.3F * spread * dice.in(-1, 1));
  const float z = center.z + spread * dice.in(-1, 1);
  mesh.box({x, y, z}, {half_x, half_y, half_z}, turn);
}

void add_clutter(FlatMesh& mesh, Dice& dice, std::size_t until) {
  const auto has_room = [&] { return mesh.triangle_count() + kBoxTriangles <= until; };
  while (has_room()) {
    const float x = dice.in(-9, 9), y = dice.in(0.3F, 5), z = dice.in(-9, 9), spread = dice.in(0.1F, 1.5F);
    const int boxes = static_cast<int>(dice.in(20, 300));
    for (int box = 0; box < boxes && has_room(); box++) add_clutter_box(mesh, dice, {x, y, z}, spread);
  }
}

}  // namespace

FlatScene interior_scene(std::uint32_t triangles) {
  FlatMesh mesh;
  Dice dice(1);
  add_walls(mesh);
  add_tables(mesh, dice);
  add_columns(mesh, dice);
  // Tables and columns are most of a small scene: then floor and spheres leave a tenth for the clutter.
  const double rest = 0.9 * (static_cast<double>(triangles) - static_cast<double>(mesh.triangle_count()));
  const double wanted = (kFloorShare + kSphereShare) * triangles;
  const double scale = std::min(1.0, rest / wanted);
  add_floor(mesh, kFloorShare * triangles * scale);
  add_spheres(mesh, dice, kSphereShare * triangles * scale);
  add_clutter(mesh, dice, triangles);
  return std::move(mesh).take();
}

View interior_view() {
  View view;
  view.eye = {-8.5F, 3.2F, -8.5F};
  view.forward = glm::normalize(Vec3(1.0F, 1.5F, 1.0F) - view.eye);
  view.light = {0.5F, 5.6F, 0.7F};
  return view;
}

}  // namespace hemiray::bench

#include "host/stability/shapes.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "host/bench/flat_mesh.hpp"

namespace hemiray::stability {
namespace {

DVec3 turned(DVec3 p) {
  constexpr double kFirst = 0.61, kSecond = 1.13;  // [rad]
  const double x = p.x * std::cos(kFirst) - p.y * std::sin(kFirst), y = p.x * std::sin(kFirst) + p.y * std::cos(kFirst);
  return {x, y * std::cos(kSecond) - p.z * std::sin(kSecond), y * std::sin(kSecond) + p.z * std::cos(kSecond)};
}

template <typename Move>
FlatScene each_vertex(FlatScene flat, const Move& move) {
  for (std::size_t i = 0; i < flat.positions.size(); i += 3) {
    const Vec3 p(move(DVec3(flat.positions[i], flat.positions[i + 1], flat.positions[i + 2])));
    for (int axis = 0; axis < 3; axis++) flat.positions[i + static_cast<std::size_t>(axis)] = p[axis];
  }
  return flat;
}

}  // namespace

FlatScene moved(FlatScene flat, DVec3 scale, DVec3 offset) {
  return each_vertex(std::move(flat), [&](DVec3 p) { return scale * p + offset; });
}

FlatScene askew(FlatScene flat) { return each_vertex(std::move(flat), turned); }

FlatScene icosahedron() {
  bench::FlatMesh mesh;
  const double golden = (1.0 + std::sqrt(5.0)) / 2.0, length = std::sqrt(1.0 + golden * golden);
  for (int axis = 0; axis < 3; axis++) {
    for (const double small : {-1.0, 1.0}) {
      for (const double large : {-golden, golden}) {
        DVec3 p(0.0);
        p[(axis + 1) % 3] = small / length;
        p[(axis + 2) % 3] = large / length;
        mesh.vertex(Vec3(turned(p)));
      }
    }
  }
  const FlatScene points = bench::FlatMesh(mesh).take();
  const auto at = [&](std::uint32_t i) { return DVec3(bench::vertex_of(points, i)); };
  // Neighbours are nearest: 2 / length apart. Three of them are a face.
  const double side = 2.0 / length * 1.01;
  for (std::uint32_t a = 0; a < 12; a++) {
    for (std::uint32_t b = a + 1; b < 12; b++) {
      for (std::uint32_t c = b + 1; c < 12; c++) {
        if (glm::length(at(a) - at(b)) > side || glm::length(at(b) - at(c)) > side || glm::length(at(a) - at(c)) > side)
          continue;
        const bool outward = glm::dot(glm::cross(at(b) - at(a), at(c) - at(a)), at(a)) > 0;
        mesh.triangle(a, outward ? b : c, outward ? c : b);
      }
    }
  }
  return std::move(mesh).take();
}

FlatScene sheet(std::uint32_t cells) {
  bench::FlatMesh mesh;
  bench::Dice dice(17);
  for (std::uint32_t row = 0; row <= cells; row++) {
    for (std::uint32_t column = 0; column <= cells; column++) {
      const auto place = [&](std::uint32_t i) {
        const bool inner = i > 0 && i < cells;
        const float even = 2.0F * static_cast<float>(i) / static_cast<float>(cells) - 1.0F;
        return even + (inner ? dice.in(-0.3F, 0.3F) / static_cast<float>(cells) : 0.0F);
      };
      const float x = place(column), y = place(row);
      mesh.vertex({x, y, 0.0F});
    }
  }
  mesh.grid(0, cells + 1, cells + 1);
  return std::move(mesh).take();
}

FlatScene slivers(std::uint32_t count, double aspect) {
  bench::FlatMesh mesh;
  for (std::uint32_t i = 0; i <= count / 2; i++) {
    for (const double x : {-0.5, 0.5}) mesh.vertex(Vec3(turned({x, i / aspect, 0.1 * x})));
  }
  for (std::uint32_t i = 0; i < count / 2; i++) {
    mesh.triangle(2 * i, 2 * i + 1, 2 * i + 3);
    mesh.triangle(2 * i, 2 * i + 3, 2 * i + 2);
  }
  return std::move(mesh).take();
}

void append(FlatScene& flat, const FlatScene& more) {
  const auto first = static_cast<std::uint32_t>(flat.positions.size() / 3);
  flat.positions.insert(flat.positions.end(), more.positions.begin(), more.positions.end());
  for (shared::uint4 t : more.triangles) {
    flat.triangles.push_back({t.x + first, t.y + first, t.z + first, t.w});
  }
  flat.triangle_objects.insert(flat.triangle_objects.end(), more.triangle_objects.begin(), more.triangle_objects.end());
  const auto spheres = more.spheres;
  flat.spheres.insert(flat.spheres.end(), spheres.begin(), spheres.end());
}

}  // namespace hemiray::stability

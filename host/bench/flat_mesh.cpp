#include "host/bench/flat_mesh.hpp"

#include <array>
#include <cmath>
#include <utility>

namespace hemiray::bench {

shared::Material FlatMesh::grey() {
  shared::Material material{};
  material.kd = {0.5F, 0.5F, 0.5F, 0.0F};
  material.ks.w = 1.5F;
  material.kd_texture = material.metallic_roughness_texture = HR_NO_TEXTURE;
  material.emission_texture = material.normal_texture = HR_NO_TEXTURE;
  return material;
}

void FlatMesh::quad(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const std::uint32_t first = vertex(a);
  vertex(b);
  vertex(c);
  vertex(d);
  triangle(first, first + 1, first + 2);
  triangle(first, first + 2, first + 3);
}

void FlatMesh::box(Vec3 center, Vec3 half_size, float turn) {
  const float cosine = std::cos(turn), sine = std::sin(turn);
  // Bit 0, 1, 2 of a corner's number: on the far side in x, y, z.
  const std::uint32_t first = vertex_count();
  for (unsigned corner = 0; corner < 8; corner++) {
    const float x = (corner & 1U) != 0 ? half_size.x : -half_size.x;
    const float y = (corner & 2U) != 0 ? half_size.y : -half_size.y;
    const float z = (corner & 4U) != 0 ? half_size.z : -half_size.z;
    vertex({center.x + x * cosine - z * sine, center.y + y, center.z + x * sine + z * cosine});
  }
  constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces{
      {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}};
  for (const auto& [a, b, c, d] : kFaces) {
    triangle(first + a, first + b, first + c);
    triangle(first + a, first + c, first + d);
  }
}

void FlatMesh::grid(std::uint32_t first, std::uint32_t rows, std::uint32_t columns) {
  for (std::uint32_t row = 0; row + 1 < rows; row++) {
    for (std::uint32_t column = 0; column + 1 < columns; column++) {
      const std::uint32_t here = first + row * columns + column, below = here + columns;
      triangle(here, below, here + 1);
      triangle(here + 1, below, below + 1);
    }
  }
}

FlatScene FlatMesh::take() && {
  flat_.triangle_objects.assign(flat_.triangles.size(), 0);
  return std::move(flat_);
}

}  // namespace hemiray::bench

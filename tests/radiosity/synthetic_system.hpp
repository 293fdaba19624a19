// Radiosity systems without geometry: sides, areas and factors as a test gives them, and their solution by elimination.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/radiosity/solver.hpp"

namespace hemiray::test {

using Rgb = std::array<float, 3>;

/// A patch whose back is black and sees nothing.
struct SyntheticPatch {
  float area;
  Rgb rho, e;
};

inline PatchMesh synthetic_mesh(const std::vector<SyntheticPatch>& patches) {
  PatchMesh mesh;
  for (const SyntheticPatch& p : patches) {
    mesh.flat.triangles.push_back({0, 0, 0, 0});
    mesh.flat.triangle_objects.push_back(0);
    mesh.normals.push_back({0.0F, 0.0F, 1.0F, p.area});
    mesh.faces.push_back(mesh.face_count++);
    const float most = std::max({p.rho[0], p.rho[1], p.rho[2]});
    mesh.reflectance.insert(mesh.reflectance.end(), {{p.rho[0], p.rho[1], p.rho[2], most}, {0, 0, 0, 0}});
    mesh.transmittance.insert(mesh.transmittance.end(), {{0, 0, 0, 0}, {0, 0, 0, 0}});
    mesh.emission.insert(mesh.emission.end(), {{p.e[0], p.e[1], p.e[2], 1.0F}, {0, 0, 0, 1.0F}});
  }
  return mesh;
}

/// Blocks of so many rows, of the sides whose rows are not empty.
inline FactorMatrix matrix_of(Context& context, const std::vector<FactorRow>& rows, std::uint32_t block_rows = 4096) {
  FactorMatrix matrix;
  matrix.side_count = static_cast<std::uint32_t>(rows.size());
  SideRows some;
  const auto flush = [&] {
    if (!some.sides.empty()) matrix.blocks.push_back(make_block(context, some));
    some = {};
  };
  for (std::uint32_t s = 0; s < rows.size(); s++) {
    if (rows[s].empty()) continue;
    some.sides.push_back(s);
    some.rows.push_back(rows[s]);
    if (some.sides.size() == block_rows) flush();
  }
  flush();
  return matrix;
}

/// The inside of a sphere cut into patches: F_ij = A_j / sum of A, a patch's own factor included.
inline std::vector<FactorRow> sphere_rows(const PatchMesh& mesh) {
  double area = 0.0;
  for (const shared::float4& n : mesh.normals) area += static_cast<double>(n.w);
  std::vector<FactorRow> rows(mesh.side_count());
  for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
    for (std::uint32_t j = 0; j < mesh.patch_count(); j++) {
      rows[2 * i].emplace_back(2 * j, static_cast<float>(static_cast<double>(mesh.normals[j].w) / area));
    }
  }
  return rows;
}

/// Rows with A_i F_ij replaced by its mean with A_j F_ji, all scaled so that none sums to more than 1.
inline std::vector<FactorRow> symmetric_rows(const PatchMesh& mesh, const std::vector<FactorRow>& rows) {
  const std::size_t n = rows.size();
  std::vector<double> exchange(n * n, 0.0);
  for (std::size_t i = 0; i < n; i++) {
    for (const auto& [j, value] : rows[i]) {
      const double half = 0.5 * static_cast<double>(mesh.normals[i / 2].w) * static_cast<double>(value);
      exchange[i * n + j] += half;
      exchange[j * n + i] += half;
    }
  }
  double most = 1.0;
  for (std::size_t i = 0; i < n; i++) {
    double sum = 0.0;
    for (std::size_t j = 0; j < n; j++) sum += exchange[i * n + j] / static_cast<double>(mesh.normals[i / 2].w);
    most = std::max(most, sum * (1.0 + 1e-6));
  }
  std::vector<FactorRow> result(n);
  for (std::size_t i = 0; i < n; i++) {
    for (std::size_t j = 0; j < n; j++) {
      const double value = exchange[i * n + j] / static_cast<double>(mesh.normals[i / 2].w) / most;
      if (value > 0.0) result[i].emplace_back(static_cast<std::uint32_t>(j), static_cast<float>(value));
    }
  }
  return result;
}

/// F_ki = F_ik A_i / A_k: what southwell solves with.
inline std::vector<std::vector<std::pair<std::uint32_t, double>>> by_reciprocity(const PatchMesh& mesh,
                                                                                 const std::vector<FactorRow>& rows) {
  std::vector<std::vector<std::pair<std::uint32_t, double>>> result(rows.size());
  const auto area = [&mesh](std::uint32_t side) { return static_cast<double>(mesh.normals[side / 2].w); };
  for (std::uint32_t i = 0; i < rows.size(); i++) {
    for (const auto& [k, value] : rows[i]) result[k].emplace_back(i, static_cast<double>(value) * area(i) / area(k));
  }
  return result;
}

/// B of all sides for one colour, by Gaussian elimination with pivots.
template <typename Row>
std::vector<double> eliminate(const PatchMesh& mesh, const std::vector<Row>& rows, std::size_t color) {
  const std::size_t n = rows.size();
  const auto of = [color](const shared::float4& v) {
    return static_cast<double>(color == 0 ? v.x : (color == 1 ? v.y : v.z));
  };
  std::vector<std::vector<double>> a(n, std::vector<double>(n + 1, 0.0));
  for (std::size_t i = 0; i < n; i++) {
    a[i][i] += 1.0;
    a[i][n] = of(mesh.emission[i]);
    for (const auto& [j, value] : rows[i]) {
      a[i][j] -= of(mesh.reflectance[i]) * static_cast<double>(value);
      a[i ^ 1U][j] -= of(mesh.transmittance[i ^ 1U]) * static_cast<double>(value);
    }
  }
  for (std::size_t k = 0; k < n; k++) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; i++) {
      if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
    }
    std::swap(a[k], a[pivot]);
    for (std::size_t i = k + 1; i < n; i++) {
      const double factor = a[i][k] / a[k][k];
      for (std::size_t j = k; factor != 0.0 && j <= n; j++) a[i][j] -= factor * a[k][j];
    }
  }
  std::vector<double> b(n);
  for (std::size_t k = n; k-- > 0;) {
    double sum = a[k][n];
    for (std::size_t j = k + 1; j < n; j++) sum -= a[k][j] * b[j];
    b[k] = sum / a[k][k];
  }
  return b;
}

}  // namespace hemiray::test

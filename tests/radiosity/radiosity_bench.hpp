// What radiosity's tests share: meshes, and their factors on the default device.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "host/radiosity/hemicubes.hpp"
#include "host/radiosity/patch_mesh.hpp"
#include "host/radiosity/solver.hpp"
#include "tests/bvh/flat_shapes.hpp"

namespace hemiray::test {

/// A material that reflects rho and emits E [W/m^2].
inline std::uint32_t add_material(FlatScene& flat, Vec3 rho, Vec3 e) {
  shared::Material m{};
  m.kd = {rho.x, rho.y, rho.z, 0.0F};
  const Vec3 radiance = e * 0.318309886F;
  m.emission = {radiance.x, radiance.y, radiance.z, 0.0F};
  m.kd_texture = m.metallic_roughness_texture = m.emission_texture = m.normal_texture = HR_NO_TEXTURE;
  flat.materials.push_back(m);
  return static_cast<std::uint32_t>(flat.materials.size() - 1);
}

inline FlatScene flat_without_materials() { return {}; }

/// Two triangles that form a parallelogram, front to cross(u, v), an object of its own.
inline void add_quad(FlatScene& flat, Vec3 corner, Vec3 u, Vec3 v, std::uint32_t material) {
  const std::uint32_t a = add_vertex(flat, corner), b = add_vertex(flat, corner + u),
                      c = add_vertex(flat, corner + u + v), d = add_vertex(flat, corner + v);
  const std::uint32_t object = flat.triangle_objects.empty() ? 0 : flat.triangle_objects.back() + 1;
  flat.triangles.push_back({a, b, c, material});
  flat.triangles.push_back({a, c, d, material});
  flat.triangle_objects.insert(flat.triangle_objects.end(), {object, object});
}

/// The faces of [0, size]^3 seen from inside, in the order x = 0, x = 1, y = 0, y = 1, z = 0, z = 1.
inline void add_room(FlatScene& flat, Vec3 size, std::uint32_t material) {
  const Vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
  add_quad(flat, Vec3(0), y, z, material);
  add_quad(flat, x, z, y, material);
  add_quad(flat, Vec3(0), z, x, material);
  add_quad(flat, y, x, z, material);
  add_quad(flat, Vec3(0), x, y, material);
  add_quad(flat, z, y, x, material);
}

/// Six faces of a box seen from outside.
inline void add_box(FlatScene& flat, Vec3 lo, Vec3 hi, std::uint32_t material) {
  const Vec3 d = hi - lo, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
  add_quad(flat, lo, z, y, material);
  add_quad(flat, lo + x, y, z, material);
  add_quad(flat, lo, x, z, material);
  add_quad(flat, lo + y, z, x, material);
  add_quad(flat, lo, y, x, material);
  add_quad(flat, lo + z, x, y, material);
}

struct RadiosityBench {
  Context context{choose_device("")};
  Parallel parallel{context};
  AccelBuilder builder{context, parallel};
};

/// The rows of all fronts, whether light comes to them or not.
inline FactorMatrix factors_of_fronts(RadiosityBench& bench, const PatchMesh& mesh, const HemicubeOptions& options) {
  Hemicubes hemicubes(bench.context, bench.parallel, bench.builder, mesh, options);
  std::vector<std::uint32_t> fronts;
  for (std::uint32_t i = 0; i < mesh.patch_count(); i++) fronts.push_back(2 * i);
  FactorMatrix matrix;
  hemicubes.add_rows(fronts, matrix);
  return matrix;
}

/// From one set of patches (by what their triangles were cut from) to another, the patches' rows weighted by area.
inline double area_factor(const PatchMesh& mesh, const std::vector<FactorRow>& rows,
                          const std::function<bool(std::uint32_t face)>& from,
                          const std::function<bool(std::uint32_t face)>& to) {
  double sum = 0.0, area = 0.0;
  for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
    if (!from(mesh.faces[i])) continue;
    const auto a = static_cast<double>(mesh.normals[i].w);
    area += a;
    for (const auto& [side, value] : rows[std::size_t{2} * i]) {
      if (to(mesh.faces[side / 2])) sum += a * static_cast<double>(value);
    }
  }
  return sum / area;
}

}  // namespace hemiray::test

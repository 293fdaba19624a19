// What tests ask of a patch mesh.
#pragma once

#include <fmt/format.h>

#include <array>
#include <map>
#include <string>
#include <utility>

#include "host/radiosity/patch_mesh.hpp"
#include "host/scene/load.hpp"
#include "tests/bvh/flat_shapes.hpp"
#include "tests/support/temp_folder.hpp"

namespace hemiray::test {

/// The scene of one object, given as JSON; its material is "m".
inline FlatScene flat_from_json(const std::string& object) {
  const TempFolder folder;
  const std::string text =
      fmt::format(R"({{ "hemiray": 1, "materials": {{ "m": {{ "kd": 0.5 }} }}, "objects": [ {} ] }})", object);
  return flatten_scene(load_scene(folder.write("s.json", text)));
}

inline double area_of(const PatchMesh& mesh) {
  double sum = 0.0;
  for (const shared::float4& n : mesh.normals) sum += static_cast<double>(n.w);
  return sum;
}

using Place = std::array<float, 3>;

/// How many triangles have an edge, by its ends' places.
inline std::map<std::pair<Place, Place>, int> edges_of(const PatchMesh& mesh) {
  std::map<std::pair<Place, Place>, int> uses;
  for (const shared::uint4& t : mesh.flat.triangles) {
    const std::array<std::uint32_t, 3> v = {t.x, t.y, t.z};
    for (std::size_t i = 0; i < 3; i++) {
      const Vec3 a = vertex(mesh.flat, v[i]), b = vertex(mesh.flat, v[(i + 1) % 3]);
      Place p = {a.x, a.y, a.z}, q = {b.x, b.y, b.z};
      if (q < p) std::swap(p, q);
      uses[{p, q}]++;
    }
  }
  return uses;
}

/// Edges that only one triangle has, or more than two.
inline std::size_t lonely_edges(const PatchMesh& mesh) {
  std::size_t lonely = 0;
  for (const auto& [edge, count] : edges_of(mesh)) lonely += count != 2;
  return lonely;
}

}  // namespace hemiray::test

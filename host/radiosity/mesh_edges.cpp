#include "host/radiosity/mesh_edges.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <utility>

#include "host/radiosity/cut_patches.hpp"

namespace hemiray {

std::vector<std::uint32_t> number_places(const FlatScene& flat) {
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> places;
  std::vector<std::uint32_t> numbers;
  for (std::size_t v = 0; v < flat.positions.size(); v += 3) {
    std::array<std::uint32_t, 3> bits{};
    for (std::size_t i = 0; i < 3; i++) bits[i] = std::bit_cast<std::uint32_t>(flat.positions[v + i] + 0.0F);
    numbers.push_back(places.try_emplace(bits, static_cast<std::uint32_t>(places.size())).first->second);
  }
  return numbers;
}

double cosine_of(const shared::float4& a, const shared::float4& b) {
  return static_cast<double>(a.x) * static_cast<double>(b.x) + static_cast<double>(a.y) * static_cast<double>(b.y) +
         static_cast<double>(a.z) * static_cast<double>(b.z);
}

MeshEdges::MeshEdges(const PatchMesh& mesh) {
  const std::vector<std::uint32_t> places = number_places(mesh.flat);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> numbers;
  std::vector<std::vector<std::uint32_t>> patches;  // by edge
  for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
    const shared::uint4& t = mesh.flat.triangles[i];
    const std::array<std::uint32_t, 3> v = {t.x, t.y, t.z};
    for (std::size_t k = 0; k < 3; k++) {
      const std::uint32_t a = v[k], b = v[(k + 1) % 3];
      const std::pair<std::uint32_t, std::uint32_t> key = std::minmax(places[a], places[b]);
      const auto [found, is_new] = numbers.try_emplace(key, static_cast<std::uint32_t>(numbers.size()));
      if (is_new) {
        const DVec3 along = DVec3(position_of(mesh.flat, b)) - DVec3(position_of(mesh.flat, a));
        lengths2.push_back(glm::dot(along, along));
        patches.emplace_back();
      }
      of_patches.push_back(found->second);
      patches[found->second].push_back(i);
    }
  }
  for (std::size_t at = 0; at < of_patches.size(); at++) {
    const std::vector<std::uint32_t>& both = patches[of_patches[at]];
    neighbours.push_back(both.size() != 2 ? HR_NO_SIDE : both[0] == at / 3 ? both[1] : both[0]);
  }
}

}  // namespace hemiray

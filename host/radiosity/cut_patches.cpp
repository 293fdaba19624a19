#include "host/radiosity/cut_patches.hpp"

#include <algorithm>

namespace hemiray {

Vec3 position_of(const FlatScene& flat, std::uint32_t vertex) {
  const float* p = &flat.positions[std::size_t{3} * vertex];
  return {p[0], p[1], p[2]};
}

std::uint32_t append_vertex(FlatScene& flat, const Vec3& p, const Vec3& normal) {
  const auto index = static_cast<std::uint32_t>(flat.positions.size() / 3);
  flat.positions.insert(flat.positions.end(), {p.x, p.y, p.z});
  if (!flat.normals.empty()) flat.normals.insert(flat.normals.end(), {normal.x, normal.y, normal.z});
  if (!flat.uvs.empty()) flat.uvs.push_back({0.0F, 0.0F});
  if (!flat.colors.empty()) flat.colors.insert(flat.colors.end(), {1.0F, 1.0F, 1.0F});
  return index;
}

std::optional<shared::float4> plane_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  const DVec3 cross = glm::cross(DVec3(b) - DVec3(a), DVec3(c) - DVec3(a));
  const double twice = glm::length(cross);
  if (!(twice > 0.0)) return std::nullopt;
  const Vec3 n(cross / twice);
  return shared::float4{n.x, n.y, n.z, static_cast<float>(0.5 * twice)};
}

std::uint32_t EdgeMiddles::halfway(std::uint32_t a, std::uint32_t b, const Vec3& place, const RoundSurface* round) {
  const std::pair<std::uint32_t, std::uint32_t> key = std::minmax(a, b);
  const auto found = middles_.find(key);
  if (found != middles_.end()) return found->second;
  FlatScene& flat = *flat_;
  Vec3 normal(0.0F);
  if (round != nullptr) {
    normal = Vec3(round->normal(DVec3(place)));
  } else if (!flat.normals.empty()) {
    const float *na = &flat.normals[std::size_t{3} * a], *nb = &flat.normals[std::size_t{3} * b];
    const Vec3 va(na[0], na[1], na[2]), vb(nb[0], nb[1], nb[2]);
    const Vec3 sum = va + vb;
    if (va != Vec3(0.0F) && vb != Vec3(0.0F) && glm::length(sum) > 0.0F) normal = glm::normalize(sum);
  }
  const std::uint32_t vertex = append_vertex(flat, place, normal);
  if (!flat.uvs.empty()) {
    flat.uvs[vertex] = {0.5F * (flat.uvs[a].x + flat.uvs[b].x), 0.5F * (flat.uvs[a].y + flat.uvs[b].y)};
  }
  for (std::size_t i = 0; i < 3 && !flat.colors.empty(); i++) {
    flat.colors[std::size_t{3} * vertex + i] =
        0.5F * (flat.colors[std::size_t{3} * a + i] + flat.colors[std::size_t{3} * b + i]);
  }
  middles_.emplace(key, vertex);
  return vertex;
}

}  // namespace hemiray

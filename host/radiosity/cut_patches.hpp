// What cutting surfaces into patches is made of: vertices in the middles of edges, and planes of triangles.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "host/base/vec.hpp"
#include "host/radiosity/round_surface.hpp"
#include "host/scene/flat_scene.hpp"

namespace hemiray {

Vec3 position_of(const FlatScene& flat, std::uint32_t vertex);

/// A new vertex, white and at texture coordinates 0; its normal is kept if vertices have normals.
std::uint32_t append_vertex(FlatScene& flat, const Vec3& position, const Vec3& normal);

/// Unit normal to the front, w = area [m^2]; nothing if there is no area.
std::optional<shared::float4> plane_of(const Vec3& a, const Vec3& b, const Vec3& c);

/// Vertices of a scene, which must outlive it.
class EdgeMiddles {
 public:
  explicit EdgeMiddles(FlatScene& flat) : flat_(&flat) {}

  /// The vertex between two, at `place`, made once: with the mean of their attributes, or the normal of the round
  /// surface, if there is one.
  std::uint32_t halfway(std::uint32_t a, std::uint32_t b, const Vec3& place, const RoundSurface* round);

 private:
  FlatScene* flat_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles_;
};

}  // namespace hemiray

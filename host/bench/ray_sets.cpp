#include "host/bench/ray_sets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "host/base/error.hpp"
#include "host/bench/flat_mesh.hpp"

namespace hemiray::bench {
namespace {

constexpr std::uint32_t kTile = 4;      // pixels on a side
constexpr std::size_t kPacket = 64;     // rays with one origin, at least
constexpr float kPrimaryStart = 1e-4F;  // [m]
constexpr float kEndless = 1e30F;
constexpr float kLift = 1e-3F;             // off the surface [m]
constexpr float kBeforeLight = 0.999F;     // of the way from the surface to the light
constexpr float kFromLightStart = 0.001F;  // of the way back
constexpr float kBeforeSurface = 0.9999F;
constexpr std::uint32_t kHemicubes = 8;

shared::QueryRay make_ray(Vec3 origin, Vec3 direction, float t_min, float t_max) {
  return {{origin.x, origin.y, origin.z, t_min}, {direction.x, direction.y, direction.z, t_max}};
}

Vec3 origin_of(const shared::QueryRay& ray) { return {ray.origin.x, ray.origin.y, ray.origin.z}; }
Vec3 direction_of(const shared::QueryRay& ray) { return {ray.direction.x, ray.direction.y, ray.direction.z}; }

// A picture plane: directions are forward + x right + y up for x, y in its extent.
struct Face {
  Vec3 forward, right, up;
  float half_width = 1.0F, bottom = -1.0F;
  std::uint32_t columns = 0, rows = 0;
};

// All rays through a face's pixels, tile by tile.
void append_face(std::vector<shared::QueryRay>& rays, Vec3 origin, const Face& face) {
  const float pixel = 2.0F / static_cast<float>(face.columns);
  for (std::uint32_t tile_y = 0; tile_y < face.rows; tile_y += kTile) {
    for (std::uint32_t tile_x = 0; tile_x < face.columns; tile_x += kTile) {
      for (std::uint32_t i = 0; i < kTile * kTile; i++) {
        const float x = (static_cast<float>(tile_x + i % kTile) + 0.5F) * pixel - 1.0F;
        const float y = (static_cast<float>(tile_y + i / kTile) + 0.5F) * pixel + face.bottom;
        const Vec3 direction = face.forward + face.right * (x * face.half_width) + face.up * (y * face.half_width);
        rays.push_back(make_ray(origin, glm::normalize(direction), kPrimaryStart, kEndless));
      }
    }
  }
}

// A point on a surface that primary rays met, lifted off it, and the normal on the side they came from.
struct SurfacePoint {
  Vec3 position, normal;
};

SurfacePoint surface_point(const FlatScene& flat, const shared::QueryRay& ray, const shared::QueryHit& hit) {
  const shared::uint4 t = flat.triangles[hit.primitive];
  const Vec3 a = vertex_of(flat, t.x), b = vertex_of(flat, t.y), c = vertex_of(flat, t.z);
  const Vec3 across = glm::cross(b - a, c - a);
  const float length = glm::length(across);
  Vec3 normal = length > 0 ? across / length : Vec3(0, 1, 0);
  if (glm::dot(normal, direction_of(ray)) > 0) normal = -normal;
  return {origin_of(ray) + direction_of(ray) * hit.t + normal * kLift, normal};
}

// Two vectors that complete the normal to a frame.
std::array<Vec3, 2> tangents(Vec3 normal) {
  const Vec3 helper = std::abs(normal.x) > 0.9F ? Vec3(0, 1, 0) : Vec3(1, 0, 0);
  const Vec3 tangent = glm::normalize(glm::cross(normal, helper));
  return {tangent, glm::cross(normal, tangent)};
}

Vec3 cosine_direction(Vec3 normal, Dice& dice) {
  const float angle = dice.unit() * 2.0F * std::numbers::pi_v<float>;
  const float r = std::sqrt(dice.unit());
  const auto [tangent, bitangent] = tangents(normal);
  // Not quite down to the horizon, where rays would graze the triangle they start from.
  const float height = std::sqrt(std::max(0.001F, 1 - r * r));
  return glm::normalize(tangent * (r * std::cos(angle)) + bitangent * (r * std::sin(angle)) + normal * height);
}

void append_hemicube(std::vector<shared::QueryRay>& rays, const SurfacePoint& point, std::uint32_t side) {
  const auto [tangent, bitangent] = tangents(point.normal);
  append_face(rays, point.position, {point.normal, tangent, bitangent, 1.0F, -1.0F, side, side});
  for (const Vec3 outward : {tangent, -tangent, bitangent, -bitangent}) {
    const Vec3 right = glm::cross(outward, point.normal);
    append_face(rays, point.position, {outward, right, point.normal, 1.0F, 0.0F, side, side / 2});
  }
}

}  // namespace

RaySet primary_rays(const View& view, std::uint32_t resolution) {
  const Vec3 helper = std::abs(view.forward.y) > 0.999F ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  const Vec3 right = glm::normalize(glm::cross(view.forward, helper));
  const Vec3 up = glm::cross(right, view.forward);
  RaySet set{"primary", {}, false, true};
  set.rays.reserve(std::size_t{resolution} * resolution);
  append_face(set.rays, view.eye, {view.forward, right, up, view.half_extent, -1.0F, resolution, resolution});
  return set;
}

std::vector<RaySet> make_ray_sets(const BenchScene& scene, std::uint32_t resolution, const ClosestHits& closest_hits) {
  if (resolution < 32 || resolution > 4096 || resolution % 32 != 0) {
    throw InputError("--resolution", fmt::format("{} is not a multiple of 32 from 32 to 4096", resolution));
  }
  const RaySet primary = primary_rays(scene.view, resolution);
  const std::vector<shared::QueryHit> hits = closest_hits(primary.rays);
  std::vector<SurfacePoint> points;
  for (std::size_t i = 0; i < hits.size(); i++) {
    if (hits[i].primitive == HR_NO_PRIMITIVE) continue;
    points.push_back(surface_point(scene.flat, primary.rays[i], hits[i]));
  }
  points.resize(points.size() / kPacket * kPacket);
  if (points.empty()) {
    throw InputError(scene.name,
                     fmt::format("its camera sees {} pixels of {}: too few to measure", points.size(), hits.size()));
  }

  RaySet shadow{"shadow", {}, true, false}, from_light{"shadow_from_light", {}, true, true};
  RaySet diffuse{"diffuse", {}, false, false}, hemicube{"hemicube", {}, false, true};
  const Vec3 light = scene.view.light;
  Dice dice(7);
  for (const SurfacePoint& point : points) {
    const Vec3 p = point.position;
    shadow.rays.push_back(make_ray(p, light - p, 0.0F, kBeforeLight));
    from_light.rays.push_back(make_ray(light, p - light, kFromLightStart, kBeforeSurface));
    diffuse.rays.push_back(make_ray(p, cosine_direction(point.normal, dice), 0.0F, kEndless));
  }
  for (std::uint32_t i = 0; i < kHemicubes; i++) {
    // Knuth's multiplicative hash: points far from each other.
    append_hemicube(hemicube.rays, points[(i * 2654435761U) % points.size()], resolution / 4);
  }
  return {primary, std::move(shadow), std::move(from_light), std::move(diffuse), std::move(hemicube)};
}

}  // namespace hemiray::bench

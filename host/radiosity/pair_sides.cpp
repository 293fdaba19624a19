#include "host/radiosity/pair_sides.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace hemiray {
namespace {

// Half an ulp a coordinate, and what rotations and the rules' own sums add.
constexpr float kFlatnessUlps = 4.0F;

std::array<DVec3, 3> corners_of(const PatchMesh& mesh, std::uint32_t side) {
  const shared::uint4 t = mesh.flat.triangles[side / 2];
  const auto at = [&mesh](std::uint32_t v) {
    const float* p = &mesh.flat.positions[std::size_t{3} * v];
    return DVec3(p[0], p[1], p[2]);
  };
  if (side % 2 == 0) return {at(t.x), at(t.y), at(t.z)};
  return {at(t.x), at(t.z), at(t.y)};
}

// Sides that share an edge, seen from the same side of the surface: one runs along it forwards, the other back.
std::vector<std::uint32_t> neighbours_of(const PatchMesh& mesh, const std::vector<std::uint32_t>& ids,
                                         std::uint32_t stride) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> by_edge[2];
  const auto vertices = [&mesh](std::uint32_t side) -> std::array<std::uint32_t, 3> {
    const shared::uint4 t = mesh.flat.triangles[side / 2];
    if (side % 2 == 0) return {t.x, t.y, t.z};
    return {t.x, t.z, t.y};
  };
  for (std::uint32_t i = 0; i < ids.size(); i++) {
    const auto v = vertices(ids[i]);
    for (std::size_t k = 0; k < 3; k++) by_edge[ids[i] % 2].emplace(std::pair(v[k], v[(k + 1) % 3]), i);
  }
  std::vector<std::uint32_t> neighbours(std::size_t{3} * stride, HR_NO_SIDE);
  for (std::uint32_t i = 0; i < ids.size(); i++) {
    const auto v = vertices(ids[i]);
    for (std::size_t k = 0; k < 3; k++) {
      const auto& edges = by_edge[ids[i] % 2];
      const auto found = edges.find(std::pair(v[(k + 1) % 3], v[k]));
      if (found != edges.end()) neighbours[std::size_t{3} * i + k] = found->second;
    }
  }
  return neighbours;
}

}  // namespace

PairSides::PairSides(Context& context, const PatchMesh& mesh, std::span<const std::uint32_t> sides,
                     std::uint32_t rows_wanted, std::uint32_t rows_traced)
    : count(static_cast<std::uint32_t>(sides.size())),
      stride((count + HR_SIDE_PADDING - 1) / HR_SIDE_PADDING * HR_SIDE_PADDING),
      rows(rows_wanted),
      traced(rows_traced),
      ids(sides.begin(), sides.end()) {
  float largest = 0.0F;
  for (const float p : mesh.flat.positions) largest = std::max(largest, std::abs(p));
  flatness = kFlatnessUlps * std::numeric_limits<float>::epsilon() * largest;

  std::vector<float> values(std::size_t{HR_SIDE_ROWS} * stride, 0.0F);
  std::vector<shared::float4> all_corners(std::size_t{3} * stride);
  std::vector<std::uint32_t> own_blockers(stride, HR_NO_SIDE), numbers(mesh.side_count(), HR_NO_SIDE);
  for (std::uint32_t i = 0; i < count; i++) {
    const auto put = [&](std::uint32_t row, double value) {
      values[std::size_t{row} * stride + i] = static_cast<float>(value);
    };
    const auto put3 = [&](std::uint32_t row, const DVec3& v) {
      put(row, v.x);
      put(row + 1, v.y);
      put(row + 2, v.z);
    };
    const std::array<DVec3, 3> v = corners_of(mesh, ids[i]);
    const DVec3 center = (v[0] + v[1] + v[2]) / 3.0;
    const DVec3 cross = glm::cross(v[1] - v[0], v[2] - v[0]);
    const double twice = glm::length(cross);
    double radius = 0.0, longest = 0.0;
    put3(HR_SIDE_CENTER, center);
    for (std::uint32_t k = 0; k < 3; k++) {
      put3(HR_SIDE_CORNERS + 3 * k, v[k] - center);
      radius = std::max(radius, glm::length(v[k] - center));
      longest = std::max(longest, glm::length(v[(k + 1) % 3] - v[k]));
      all_corners[std::size_t{3} * i + k] = {static_cast<float>(v[k].x), static_cast<float>(v[k].y),
                                             static_cast<float>(v[k].z), 0.0F};
    }
    put3(HR_SIDE_NORMAL, cross / twice);
    put(HR_SIDE_AREA, 0.5 * twice);
    put(HR_SIDE_RADIUS, radius);
    put(HR_SIDE_SLOPE, static_cast<double>(flatness) * longest / twice);
    own_blockers[i] = mesh.blocker_of[ids[i] / 2];
    numbers[ids[i]] = i;
  }
  table = Buffer<float>(context, "pair sides", std::span<const float>(values));
  corners = Buffer<shared::float4>(context, "pair corners", std::span<const shared::float4>(all_corners));
  blockers = Buffer<std::uint32_t>(context, "pair blockers", std::span<const std::uint32_t>(own_blockers));
  const std::vector<std::uint32_t> around = neighbours_of(mesh, ids, stride);
  neighbours = Buffer<std::uint32_t>(context, "pair neighbours", std::span(around));
  active = Buffer<std::uint32_t>(context, "numbers of sides", std::span<const std::uint32_t>(numbers));
  std::vector<std::uint32_t> padded = ids;
  padded.resize(stride, HR_NO_SIDE);
  sides_by_number = Buffer<std::uint32_t>(context, "sides by number", std::span<const std::uint32_t>(padded));
}

}  // namespace hemiray

// Flat scenes for the tests of the tree: soups of triangles and spheres, closed meshes, and how a tree is made of them.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "host/base/vec.hpp"
#include "host/bvh/accel.hpp"
#include "host/scene/features.hpp"
#include "host/scene/flat_scene.hpp"
#include "shared/features.h"

namespace hemiray::test {

/// Primitives of all kinds, whether the scene has them or not: one query program serves all tests.
inline constexpr std::uint32_t kAllPrimitives =
    HR_FEATURE_TRIANGLES | HR_FEATURE_SPHERES | HR_FEATURE_SHAPES | HR_FEATURE_PLANES;

inline FlatScene empty_flat_scene() {
  FlatScene flat;
  flat.materials.emplace_back();
  return flat;
}

inline std::uint32_t add_vertex(FlatScene& flat, Vec3 p) {
  flat.positions.insert(flat.positions.end(), {p.x, p.y, p.z});
  return static_cast<std::uint32_t>(flat.positions.size() / 3 - 1);
}

inline void add_triangle(FlatScene& flat, Vec3 a, Vec3 b, Vec3 c) {
  const std::uint32_t i = add_vertex(flat, a), j = add_vertex(flat, b), k = add_vertex(flat, c);
  flat.triangles.push_back({i, j, k, 0});
  flat.triangle_objects.push_back(0);
}

inline void add_sphere(FlatScene& flat, Vec3 center, float radius) {
  shared::Sphere sphere{};
  sphere.center_radius = {center.x, center.y, center.z, radius};
  flat.spheres.push_back(sphere);
}

inline void add_plane(FlatScene& flat, Vec3 point, Vec3 normal) {
  shared::Plane plane{};
  plane.point = {point.x, point.y, point.z, 0.0F};
  plane.normal = {normal.x, normal.y, normal.z, 0.0F};
  flat.planes.push_back(plane);
}

inline Vec3 vertex(const FlatScene& flat, std::uint32_t i) {
  const float* p = &flat.positions[std::size_t{3} * i];
  return {p[0], p[1], p[2]};
}

/// Random numbers for places.
class Places {
 public:
  explicit Places(std::uint32_t seed) : random_(seed) {}
  float in(float least, float most) { return std::uniform_real_distribution<float>(least, most)(random_); }
  Vec3 in_cube(float half) { return {in(-half, half), in(-half, half), in(-half, half)}; }
  Vec3 direction() {
    const double z = in(-1.0F, 1.0F), phi = in(0.0F, 1.0F) * 2.0 * std::numbers::pi;
    const double r = std::sqrt(1.0 - z * z);
    return {static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi)), static_cast<float>(z)};
  }
  std::uint32_t below(std::uint32_t n) { return std::uniform_int_distribution<std::uint32_t>(0, n - 1)(random_); }

 private:
  std::mt19937 random_;
};

/// `triangles` triangles with edges of about `size` and `spheres` spheres of up to that radius, in [-1, 1]^3.
inline FlatScene soup(std::uint32_t triangles, std::uint32_t spheres, float size, std::uint32_t seed) {
  FlatScene flat = empty_flat_scene();
  Places places(seed);
  for (std::uint32_t i = 0; i < triangles; i++) {
    const Vec3 a = places.in_cube(1.0F);
    add_triangle(flat, a, a + size * places.direction(), a + size * places.direction());
  }
  for (std::uint32_t i = 0; i < spheres; i++) {
    const Vec3 center = places.in_cube(1.0F);
    add_sphere(flat, center, size * places.in(0.1F, 1.0F));
  }
  return flat;
}

/// Triangles around the origin whose boxes are concentric cubes, each a fixed factor larger than the one before: half
/// sizes from 2^-40 to 2^40. Trees of them are as deep as trees get.
inline FlatScene nested_triangles(std::uint32_t count, std::uint32_t seed) {
  FlatScene flat = empty_flat_scene();
  Places places(seed);
  for (std::uint32_t i = 0; i < count; i++) {
    const float half = std::exp2(80.0F * static_cast<float>(i) / static_cast<float>(count) - 40.0F);
    add_triangle(flat, Vec3(-half), Vec3(half), half * places.in_cube(1.0F));
  }
  return flat;
}

/// A closed mesh: each face of a cube is a grid of n x n cells of two triangles; `round` puts the vertices on the unit
/// sphere. Vertices on the cube's edges are shared. Moved by `offset`.
inline FlatScene closed_mesh(int n, bool round, Vec3 offset) {
  FlatScene flat = empty_flat_scene();
  std::map<std::array<int, 3>, std::uint32_t> indices;  // by place on the cube's integer lattice
  const auto lattice_vertex = [&](std::array<int, 3> place) {
    const auto [found, is_new] = indices.try_emplace(place, static_cast<std::uint32_t>(flat.positions.size() / 3));
    if (is_new) {
      DVec3 p = DVec3(place[0], place[1], place[2]) * (2.0 / n) - 1.0;
      if (round) p = glm::normalize(p);
      add_vertex(flat, Vec3(p + DVec3(offset)));
    }
    return found->second;
  };
  for (std::size_t axis = 0; axis < 3; axis++) {
    for (const int side : {0, n}) {
      for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
          const auto corner = [&](int u, int v) {
            std::array<int, 3> place{};
            place[axis] = side;
            place[(axis + 1) % 3] = i + u;
            place[(axis + 2) % 3] = j + v;
            return lattice_vertex(place);
          };
          std::array<std::uint32_t, 4> q = {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
          if (side == 0) std::swap(q[1], q[3]);  // outward front
          flat.triangles.push_back({q[0], q[1], q[2], 0});
          flat.triangles.push_back({q[0], q[2], q[3], 0});
        }
      }
    }
  }
  flat.triangle_objects.assign(flat.triangles.size(), 0);
  return flat;
}

/// What is needed to build trees on the default device.
struct TreeWorkshop {
  Context context{choose_device("")};
  Parallel parallel{context};
  AccelBuilder builder{context, parallel};
};

/// A flat scene on the device with its tree.
struct BuiltTree {
  BuiltTree(TreeWorkshop& workshop, const FlatScene& flat, const AccelOptions& options = {})
      : scene(workshop.context, flat, kAllPrimitives | triangle_features(flat)),
        accel(workshop.builder, scene, options) {}
  DeviceScene scene;
  Accel accel;
};

/// One way to build and lay out a tree.
struct TreeKind {
  const char* name;
  AccelOptions options;
};

/// Every width, number of lanes, builder, triangle test, form of vectors and size of leaves is in here, each compiled
/// once. The first of each triangle test is what CPUs get by default.
inline const std::vector<TreeKind>& tree_kinds() {
  constexpr auto kQuality = TreeBuilder::quality;
  constexpr auto kRadix = TreeBuilder::fast;
  constexpr auto kTight = TriangleTest::watertight;
  constexpr auto kFast = TriangleTest::fast;
  static const std::vector<TreeKind> kKinds = {
      {"quality, watertight, 8 wide, 8 lanes, leaves of 16", {kQuality, kTight, 0, 8, 8, 16, 1}},
      {"quality, fast, 8 wide, 8 lanes, leaves of 16", {kQuality, kFast, 0, 8, 8, 16, 1}},
      {"radix, fast, 8 wide, 4 lanes, leaves of 16", {kRadix, kFast, 63, 8, 4, 16, 1}},
      {"radix, watertight, 4 wide, 8 lanes, leaves of 4, loops", {kRadix, kTight, 30, 4, 8, 4, 0}},
      {"quality, fast, 4 wide, 2 lanes, leaves of 1, loops", {kQuality, kFast, 0, 4, 2, 1, 0}},
      {"radix, watertight, 2 wide, 1 lane, leaves of 1", {kRadix, kTight, 0, 2, 1, 1, 1}},
      {"quality, watertight, 2 wide, 2 lanes, leaves of 8", {kQuality, kTight, 30, 2, 2, 8, 1}},
      {"quality, watertight, 4 wide, 4 lanes, leaves of 4", {kQuality, kTight, 63, 4, 4, 4, 1}},
  };
  return kKinds;
}

}  // namespace hemiray::test

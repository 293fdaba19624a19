// Nearest-neighbour searches against brute force: closest points in double precision by other formulas, k nearest
// points to the bit.
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "host/base/error.hpp"
#include "host/bvh/nearest_queries.hpp"
#include "tests/bvh/flat_shapes.hpp"

namespace hemiray {
namespace {

using test::add_sphere;
using test::add_triangle;
using test::empty_flat_scene;
using test::Places;
using test::soup;
using test::TreeWorkshop;
using test::vertex;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr double kForeverDouble = std::numeric_limits<double>::infinity();
// Of distances and points, per metre of the coordinates at hand: a few dozen roundings of 6e-8.
constexpr double kTolerance = 2e-6;

// By minimising over barycentric coordinates region by region (Eberly's quadratic), unlike the kernels, which project
// onto edges.
double triangle_distance(const DVec3& p, const DVec3& a, const DVec3& b, const DVec3& c) {
  const DVec3 e0 = b - a, e1 = c - a, v = a - p;
  const double q00 = glm::dot(e0, e0), q01 = glm::dot(e0, e1), q11 = glm::dot(e1, e1);
  const double l0 = glm::dot(e0, v), l1 = glm::dot(e1, v), det = q00 * q11 - q01 * q01;
  double least = kForeverDouble;
  const auto consider = [&](double s, double t) { least = std::min(least, glm::length(v + s * e0 + t * e1)); };
  const double s = (q01 * l1 - q11 * l0) / det, t = (q01 * l0 - q00 * l1) / det;
  if (s >= 0.0 && t >= 0.0 && s + t <= 1.0) consider(s, t);
  consider(std::clamp(-l0 / q00, 0.0, 1.0), 0.0);
  consider(0.0, std::clamp(-l1 / q11, 0.0, 1.0));
  const double u = std::clamp((q00 - q01 + l0 - l1) / (q00 - 2.0 * q01 + q11), 0.0, 1.0);  // b + u (c - b)
  consider(1.0 - u, u);
  return least;
}

double primitive_distance(const FlatScene& flat, std::size_t i, const DVec3& p) {
  if (i < flat.triangles.size()) {
    const shared::uint4 t = flat.triangles[i];
    return triangle_distance(p, vertex(flat, t.x), vertex(flat, t.y), vertex(flat, t.z));
  }
  const shared::float4 s = flat.spheres[i - flat.triangles.size()].center_radius;
  return std::abs(glm::length(p - DVec3(s.x, s.y, s.z)) - static_cast<double>(s.w));
}

std::vector<QueryPoint> random_queries(std::size_t count, float half, std::uint32_t seed, float farthest = kInf) {
  Places places(seed);
  std::vector<QueryPoint> queries;
  while (queries.size() < count) {
    const Vec3 p = places.in_cube(half);
    queries.push_back({p.x, p.y, p.z, farthest});
  }
  return queries;
}

// On vertices, on edges, in faces and a little off them.
std::vector<QueryPoint> near_queries(const FlatScene& flat, std::size_t count, std::uint32_t seed) {
  Places places(seed);
  std::vector<QueryPoint> queries;
  while (queries.size() < count) {
    const shared::uint4 t = flat.triangles[places.below(static_cast<std::uint32_t>(flat.triangles.size()))];
    const Vec3 a = vertex(flat, t.x), b = vertex(flat, t.y), c = vertex(flat, t.z);
    float u = places.in(0.0F, 1.0F), v = places.in(0.0F, 1.0F - u);
    if (queries.size() % 3 == 0) u = v = 0.0F;
    if (queries.size() % 3 == 1) v = 0.0F;
    Vec3 p = a + u * (b - a) + v * (c - a);
    if (queries.size() % 2 == 0) p += 1e-3F * places.direction();
    queries.push_back({p.x, p.y, p.z, kInf});
  }
  return queries;
}

void check_closest(TreeWorkshop& workshop, const std::string& name, const FlatScene& flat,
                   const std::vector<QueryPoint>& queries, unsigned width = 0) {
  INFO(name << ", width " << width);
  AccelOptions options;
  options.width = width;
  const test::BuiltTree tree(workshop, flat, options);
  NearestQueries nearest(workshop.context, tree.scene, tree.accel);
  const ClosestPoints answers = nearest.closest(queries);
  REQUIRE(answers.points.size() == queries.size());
  REQUIRE(answers.primitives.size() == queries.size());
  const std::size_t count = flat.triangles.size() + flat.spheres.size();
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < queries.size(); i++) {
    const DVec3 p(queries[i].x, queries[i].y, queries[i].z);
    double least = kForeverDouble;
    for (std::size_t k = 0; k < count; k++) least = std::min(least, primitive_distance(flat, k, p));
    const shared::float4 q = answers.points[i];
    const double distance = static_cast<double>(q.w), slack = kTolerance * (1.0 + glm::length(p) + least);
    bool right = false;
    if (count == 0 || least > static_cast<double>(queries[i].w)) {
      right = answers.primitives[i] == HR_NO_PRIMITIVE && std::isinf(q.w);
    } else if (answers.primitives[i] < count) {
      const double own = primitive_distance(flat, answers.primitives[i], p);
      right = std::abs(distance - least) <= slack && own <= least + slack &&
              std::abs(glm::length(DVec3(q.x, q.y, q.z) - p) - distance) <= slack &&
              primitive_distance(flat, answers.primitives[i], DVec3(q.x, q.y, q.z)) <= slack;
    }
    if (!right && wrong++ == 0) {
      UNSCOPED_INFO("query " << i << " at " << p.x << ' ' << p.y << ' ' << p.z << ": primitive "
                             << answers.primitives[i] << " at distance " << q.w << ", expected " << least);
    }
  }
  CHECK(wrong == 0);
}

// Squared distance as the kernel computes it: no step is fused.
float distance2(const QueryPoint& q, const Vec3& p) {
  const volatile float dx = q.x - p.x, dy = q.y - p.y, dz = q.z - p.z;
  const volatile float xx = dx * dx, yy = dy * dy, zz = dz * dz;
  const volatile float xy = xx + yy;
  return xy + zz;
}

void check_neighbours(TreeWorkshop& workshop, const std::string& name, const std::vector<Vec3>& points,
                      const std::vector<QueryPoint>& queries, unsigned k, const AccelOptions& options = {}) {
  INFO(name << ", " << k << " nearest of " << points.size());
  PointTree tree(workshop.context, workshop.builder, points, options);
  const Neighbours answers = tree.nearest(queries, k);
  REQUIRE(answers.distances.size() == k * queries.size());
  REQUIRE(answers.indices.size() == k * queries.size());
  std::size_t wrong = 0;
  std::vector<std::pair<float, std::uint32_t>> all;
  for (std::size_t i = 0; i < queries.size(); i++) {
    all.clear();
    for (std::uint32_t n = 0; n < points.size(); n++) {
      const float d2 = distance2(queries[i], points[n]);
      if (d2 <= queries[i].w * queries[i].w) all.emplace_back(d2, n);
    }
    const std::size_t found = std::min<std::size_t>(k, all.size());
    std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(found), all.end());
    bool right = true;
    for (std::size_t n = 0; n < k; n++) {
      const float distance = answers.distances[i * k + n];
      const std::uint32_t index = answers.indices[i * k + n];
      if (n >= found) {
        right = right && std::isinf(distance) && index == HR_NO_PRIMITIVE;
      } else {
        const float expected = std::sqrt(all[n].first);
        right = right && index == all[n].second && std::abs(distance - expected) <= 3e-7F * expected;
      }
    }
    if (!right && wrong++ == 0) {
      UNSCOPED_INFO("query " << i << ": first neighbour " << answers.indices[i * k] << " at "
                             << answers.distances[i * k]);
    }
  }
  CHECK(wrong == 0);
}

std::vector<Vec3> random_points(std::size_t count, float half, std::uint32_t seed) {
  Places places(seed);
  std::vector<Vec3> points;
  while (points.size() < count) points.push_back(places.in_cube(half));
  return points;
}

}  // namespace

TEST_CASE("the closest point on a scene is what brute force in double says") {
  TreeWorkshop workshop;
  const FlatScene both = soup(500, 150, 0.2F, 50);
  for (const unsigned width : {2U, 4U, 8U}) {
    check_closest(workshop, "both", both, random_queries(2000, 2.0F, 51), width);
  }
  check_closest(workshop, "within bounds", both, random_queries(2000, 2.0F, 52, 0.1F));
  check_closest(workshop, "spheres", soup(0, 300, 0.3F, 53), random_queries(2000, 1.5F, 54));
  const FlatScene ball = test::closed_mesh(8, true, Vec3(0.0F));
  check_closest(workshop, "ball", ball, random_queries(2000, 2.0F, 55));
  check_closest(workshop, "on the ball", ball, near_queries(ball, 2000, 56));
  const FlatScene triangles = soup(500, 0, 0.3F, 57);
  check_closest(workshop, "on triangles", triangles, near_queries(triangles, 2000, 58));
}

TEST_CASE("the closest point is found in scenes that are hard on a search") {
  TreeWorkshop workshop;
  Places places(59);
  FlatScene slivers = empty_flat_scene(), sizes = empty_flat_scene(), planar = empty_flat_scene();
  for (int i = 0; i < 300; i++) {
    const Vec3 a = places.in_cube(1.0F), d = places.direction();
    add_triangle(slivers, a, a + 1.5F * d, a + 0.75F * d + 1e-3F * places.direction());
    const float size = std::exp2(places.in(-15.0F, 2.0F));
    add_triangle(sizes, a, a + size * places.direction(), a + size * places.direction());
    if (i % 3 == 0) add_sphere(sizes, places.in_cube(1.0F), std::exp2(places.in(-15.0F, 1.0F)));
    add_triangle(planar, {a.x, 0.5F, a.z}, {a.x + 0.1F, 0.5F, a.z}, {a.x, 0.5F, a.z + 0.1F});
  }
  check_closest(workshop, "slivers", slivers, near_queries(slivers, 1500, 60));
  check_closest(workshop, "sizes", sizes, random_queries(1500, 1.0F, 61));
  check_closest(workshop, "planar", planar, random_queries(1500, 1.0F, 62));
  check_closest(workshop, "one triangle", soup(1, 0, 1.0F, 63), random_queries(500, 2.0F, 64));
  check_closest(workshop, "nothing", empty_flat_scene(), random_queries(10, 1.0F, 65));
}

TEST_CASE("equally close primitives: the smaller index, wherever it stands in the tree") {
  TreeWorkshop workshop;
  FlatScene flat = empty_flat_scene();
  Places places(66);
  std::vector<std::array<Vec3, 3>> shapes;
  for (int i = 0; i < 60; i++) {
    const Vec3 a = places.in_cube(1.0F);
    shapes.push_back({a, a + 0.3F * places.direction(), a + 0.3F * places.direction()});
  }
  for (int copy = 0; copy < 5; copy++) {
    for (const auto& [a, b, c] : shapes) add_triangle(flat, a, b, c);
  }
  const test::BuiltTree tree(workshop, flat);
  NearestQueries nearest(workshop.context, tree.scene, tree.accel);
  for (const std::uint32_t primitive : nearest.closest(random_queries(5000, 2.0F, 67)).primitives) {
    REQUIRE(primitive < 60);
  }
}

TEST_CASE("closest points are exact where arithmetic is") {
  TreeWorkshop workshop;
  FlatScene flat = empty_flat_scene();
  add_triangle(flat, {0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  add_sphere(flat, {10, 0, 0}, 1.0F);
  const test::BuiltTree tree(workshop, flat);
  NearestQueries nearest(workshop.context, tree.scene, tree.accel);
  const auto check = [&](const QueryPoint& query, const shared::float4& expected, std::uint32_t primitive) {
    const ClosestPoints answer = nearest.closest(std::vector<QueryPoint>{query});
    INFO("query " << query.x << ' ' << query.y << ' ' << query.z << ' ' << query.w);
    CHECK(answer.points[0].x == expected.x);
    CHECK(answer.points[0].y == expected.y);
    CHECK(answer.points[0].z == expected.z);
    CHECK(answer.points[0].w == expected.w);
    CHECK(answer.primitives[0] == primitive);
  };
  check({1, 1, 3, kInf}, {1, 1, 0, 3}, 0);          // face
  check({1, 1, -3, kInf}, {1, 1, 0, 3}, 0);         // from behind
  check({1, -2, 0, kInf}, {1, 0, 0, 2}, 0);         // edge
  check({-3, -4, 0, kInf}, {0, 0, 0, 5}, 0);        // vertex
  check({10, 0, 3, kInf}, {10, 0, 1, 2}, 1);        // sphere from outside
  check({10, 0.5F, 0, kInf}, {10, 1, 0, 0.5F}, 1);  // from inside
  check({10, 0, 0, kInf}, {11, 0, 0, 1}, 1);        // from its centre: along x
  check({1, 1, 3, 3}, {1, 1, 0, 3}, 0);             // as far as allowed
  check({1, 1, 3, 2.9F}, {1, 1, 3, kInf}, HR_NO_PRIMITIVE);
  check({1, 1, 0, 0}, {1, 1, 0, 0}, 0);
  CHECK(nearest.closest(std::vector<QueryPoint>{}).points.empty());
}

TEST_CASE("the k nearest points are those of brute force, in its order") {
  TreeWorkshop workshop;
  const std::vector<Vec3> points = random_points(3000, 1.0F, 68);
  const std::vector<QueryPoint> queries = random_queries(1500, 1.5F, 69);
  for (const unsigned k : {1U, 2U, 5U, 16U}) check_neighbours(workshop, "random", points, queries, k);
  for (const unsigned width : {2U, 4U}) {
    AccelOptions options;
    options.width = width;
    options.leaf_lanes = width;
    check_neighbours(workshop, "narrow", points, queries, 4, options);
  }
  check_neighbours(workshop, "within bounds", points, random_queries(1500, 1.0F, 70, 0.1F), 8);
  std::vector<QueryPoint> at_points;
  for (std::size_t i = 0; i < 1000; i++) at_points.push_back({points[i].x, points[i].y, points[i].z, kInf});
  check_neighbours(workshop, "at the points", points, at_points, 3);
}

TEST_CASE("the k nearest points: few, equal, on a lattice, not finite") {
  TreeWorkshop workshop;
  const std::vector<QueryPoint> queries = random_queries(500, 1.5F, 71);
  for (const std::size_t count : {0U, 1U, 2U, 5U, 16U, 17U}) {
    check_neighbours(workshop, "few", random_points(count, 1.0F, 72), queries, 16);
  }
  check_neighbours(workshop, "all equal", std::vector<Vec3>(200, Vec3(0.3F, 0.2F, 0.1F)), queries, 7);
  std::vector<Vec3> lattice;  // many equal distances
  std::vector<QueryPoint> lattice_queries;
  for (int i = 0; i < 1000; i++) {
    lattice.emplace_back(i % 10, i / 10 % 10, i / 100);
    lattice_queries.push_back(
        {static_cast<float>(i % 10) + 0.5F, static_cast<float>(i / 10 % 10), static_cast<float>(i / 100) + 0.5F, kInf});
  }
  check_neighbours(workshop, "lattice", lattice, lattice_queries, 16);
  std::vector<Vec3> holed = random_points(100, 1.0F, 73);
  holed[7].x = std::numeric_limits<float>::quiet_NaN();
  holed[50].z = kInf;
  check_neighbours(workshop, "not finite", holed, queries, 9);
  CHECK(PointTree(workshop.context, workshop.builder, holed).statistics().non_finite == 2);
}

TEST_CASE("nearest-neighbour searches say what they cannot do") {
  TreeWorkshop workshop;
  PointTree tree(workshop.context, workshop.builder, random_points(10, 1.0F, 74));
  CHECK_THROWS_AS(tree.nearest(random_queries(1, 1.0F, 75), 0), InputError);
  CHECK_THROWS_AS(tree.nearest(random_queries(1, 1.0F, 75), 17), InputError);
  AccelOptions options;
  options.kind = AccelKind::octree;
  const test::BuiltTree cells(workshop, soup(10, 0, 0.1F, 76), options);
  CHECK_THROWS_AS(NearestQueries(workshop.context, cells.scene, cells.accel), InputError);
}

}  // namespace hemiray

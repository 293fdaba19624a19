// Triangle, parallelogram, sphere and plane against a ray; the box tree.
#include "tests/reference/reference_intersect.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "tests/reference/reference_shape.hpp"

namespace hemiray::reference {

namespace {

constexpr std::size_t kBruteForceTriangles = 2000;
constexpr std::size_t kLeafTriangles = 4;
constexpr double kPointError = 0x1p-40;       // thousands of double roundings, far below one float ulp
constexpr double kShadowEnd = 1.0 - 0x1p-30;  // a surface that coincides with the light does not hide it
constexpr double kBoxSlack = 1.0 + 0x1p-45;   // the slabs' own roundings
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double largest(const DVec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// A ray cannot leave a flat surface and hit it again.
bool starts_on_plane(const Ray& ray, const DVec3& point, const DVec3& normal) {
  if (ray.origin_error_m <= 0.0) return false;
  const double tolerance = std::max(ray.origin_error_m, kPointError * largest(point));
  return std::abs(glm::dot(ray.origin - point, normal)) <= tolerance;
}

/// Distance to the plane through `point`; empty if the ray is parallel to it or starts on it, or it lies behind.
std::optional<double> plane_distance(const Ray& ray, const DVec3& point, const DVec3& normal) {
  const double slope = glm::dot(ray.direction, normal);
  if (slope == 0.0 || starts_on_plane(ray, point, normal)) return std::nullopt;
  const double t = glm::dot(point - ray.origin, normal) / slope;
  if (!(t > 0.0)) return std::nullopt;
  return t;
}

std::optional<Hit> intersect_triangle(const WorldTriangle& triangle, const Ray& ray) {
  if (starts_on_plane(ray, triangle.corners[0], triangle.normal)) return std::nullopt;
  const DVec3 a = triangle.corners[0] - ray.origin;
  const DVec3 b = triangle.corners[1] - ray.origin;
  const DVec3 c = triangle.corners[2] - ray.origin;
  // Signed volumes of the ray with each edge: neighbours compute the same value with the opposite sign, so that no ray
  // slips between them.
  const double u = glm::dot(ray.direction, glm::cross(c, b));
  const double v = glm::dot(ray.direction, glm::cross(a, c));
  const double w = glm::dot(ray.direction, glm::cross(b, a));
  if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) return std::nullopt;
  const double sum = u + v + w;
  if (sum == 0.0) return std::nullopt;
  const DVec3 weights = DVec3(u, v, w) / sum;
  const double slope = glm::dot(ray.direction, triangle.normal);
  if (slope == 0.0) return std::nullopt;
  const double t = glm::dot(a, triangle.normal) / slope;
  if (!(t > 0.0)) return std::nullopt;
  return Hit{t, {}, weights};
}

std::optional<Hit> intersect_quad(const WorldQuad& quad, const Ray& ray) {
  const auto t = plane_distance(ray, quad.corner, quad.normal);
  if (!t) return std::nullopt;
  const DVec3 offset = ray.origin + ray.direction * *t - quad.corner;
  const DVec3 full = glm::cross(quad.edge_u, quad.edge_v);
  const double area_squared = glm::dot(full, full);
  const double u = glm::dot(glm::cross(offset, quad.edge_v), full) / area_squared;
  const double v = glm::dot(glm::cross(quad.edge_u, offset), full) / area_squared;
  if (u < 0.0 || u > 1.0 || v < 0.0 || v > 1.0) return std::nullopt;
  return Hit{*t, {}, DVec3(0.0)};
}

std::optional<Hit> intersect_sphere(const Sphere& sphere, const Ray& ray) {
  const DVec3 to_origin = ray.origin - sphere.center;
  const double along = glm::dot(to_origin, ray.direction);
  if (ray.origin_error_m > 0.0) {
    const double tolerance =
        std::max(ray.origin_error_m, kPointError * std::max(sphere.radius, largest(sphere.center)));
    if (std::abs(glm::length(to_origin) - sphere.radius) <= tolerance) {
      // One root is the origin itself; the chord's other end is the hit.
      if (along < 0.0) return Hit{-2.0 * along, {}, DVec3(0.0)};
      return std::nullopt;
    }
  }
  const DVec3 closest = to_origin - along * ray.direction;
  const double half_chord_squared = sphere.radius * sphere.radius - glm::dot(closest, closest);
  if (half_chord_squared < 0.0) return std::nullopt;
  const double half_chord = std::sqrt(half_chord_squared);
  if (-along - half_chord > 0.0) return Hit{-along - half_chord, {}, DVec3(0.0)};
  if (-along + half_chord > 0.0) return Hit{-along + half_chord, {}, DVec3(0.0)};
  return std::nullopt;
}

bool meets_box(const Ray& ray, const DVec3& low, const DVec3& high, double t_max) {
  double enter = 0.0;
  double leave = t_max;
  for (int axis = 0; axis < 3; ++axis) {
    const double o = ray.origin[axis];
    const double d = ray.direction[axis];
    if (d == 0.0) {
      if (o < low[axis] || o > high[axis]) return false;
      continue;
    }
    const double t0 = (low[axis] - o) / d;
    const double t1 = (high[axis] - o) / d;
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  // Symmetric slack: a near-zero `leave` of either sign must not lose a flat box.
  return enter <= leave * kBoxSlack + kPointError * largest(ray.origin);
}

}  // namespace

double point_error(const DVec3& point, double t_m) { return kPointError * std::max(largest(point), t_m); }

std::optional<Hit> intersect(const World& world, const PrimitiveId& primitive, const Ray& ray) {
  std::optional<Hit> hit;
  switch (primitive.kind) {
    case Kind::triangle:
      hit = intersect_triangle(world.triangles[primitive.index], ray);
      break;
    case Kind::quad:
      hit = intersect_quad(world.quads[primitive.index], ray);
      break;
    case Kind::sphere:
      hit = intersect_sphere(world.scene.spheres[primitive.index], ray);
      break;
    case Kind::shape:
      hit = intersect_shape(world.scene.shapes[primitive.index], ray);
      break;
    case Kind::plane: {
      const Plane& plane = world.scene.planes[primitive.index];
      if (const auto t = plane_distance(ray, plane.point, plane.normal)) hit = Hit{*t, {}, DVec3(0.0)};
      break;
    }
    case Kind::none:
      break;
  }
  if (hit) hit->primitive = primitive;
  return hit;
}

Intersector::Intersector(const World& world, Method method) : world_(world), order_(world.triangles.size()) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  const bool many = order_.size() > kBruteForceTriangles;
  if (!order_.empty() && (method == Method::tree || (method == Method::automatic && many))) build(0, order_.size());
}

std::size_t Intersector::build(std::size_t begin, std::size_t end) {
  const std::size_t index = nodes_.size();
  Node node{DVec3(kInfinity), DVec3(-kInfinity), begin, end, 0, 0};
  for (std::size_t i = begin; i < end; ++i) {
    for (const DVec3& corner : world_.triangles[order_[i]].corners) {
      node.low = glm::min(node.low, corner);
      node.high = glm::max(node.high, corner);
    }
  }
  nodes_.push_back(node);
  if (end - begin <= kLeafTriangles) return index;
  const DVec3 extent = node.high - node.low;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : (extent.y >= extent.z ? 1 : 2);
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [this](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end), [&](std::size_t i, std::size_t j) {
    const auto& p = world_.triangles[i].corners;
    const auto& q = world_.triangles[j].corners;
    return p[0][axis] + p[1][axis] + p[2][axis] < q[0][axis] + q[1][axis] + q[2][axis];
  });
  const std::size_t left = build(begin, middle);
  const std::size_t right = build(middle, end);
  nodes_[index].left = left;
  nodes_[index].right = right;
  return index;
}

template <class Visit>
void Intersector::for_each_triangle(const Ray& ray, double& t_max, const Visit& visit) const {
  if (nodes_.empty()) {
    for (const std::size_t triangle : order_) visit(triangle);
    return;
  }
  std::vector<std::size_t> stack{0};
  while (!stack.empty()) {
    const Node& node = nodes_[stack.back()];
    stack.pop_back();
    if (!meets_box(ray, node.low, node.high, t_max)) continue;
    if (node.left != 0) {
      stack.push_back(node.right);
      stack.push_back(node.left);
      continue;
    }
    for (std::size_t i = node.begin; i < node.end; ++i) visit(order_[i]);
  }
}

std::optional<Hit> Intersector::nearest(const Ray& ray) const {
  std::optional<Hit> best;
  double t_max = kInfinity;
  const auto consider = [&](const PrimitiveId& primitive) {
    const auto hit = intersect(world_, primitive, ray);
    if (!hit) return;
    const bool tie_won = best && hit->t_m == best->t_m && primitive.kind == best->primitive.kind &&
                         primitive.index < best->primitive.index;
    if (!best || hit->t_m < best->t_m || tie_won) {
      best = hit;
      t_max = hit->t_m;
    }
  };
  for_each_triangle(ray, t_max, [&](std::size_t i) { consider({Kind::triangle, i}); });
  for (std::size_t i = 0; i < world_.quads.size(); ++i) consider({Kind::quad, i});
  for (std::size_t i = 0; i < world_.scene.spheres.size(); ++i) consider({Kind::sphere, i});
  for (std::size_t i = 0; i < world_.scene.shapes.size(); ++i) consider({Kind::shape, i});
  for (std::size_t i = 0; i < world_.scene.planes.size(); ++i) consider({Kind::plane, i});
  return best;
}

bool Intersector::occluded(const Ray& ray, double distance_m, const std::vector<PrimitiveId>& ignored) const {
  double t_max = distance_m * kShadowEnd;
  bool blocked = false;
  const auto consider = [&](const PrimitiveId& primitive) {
    if (blocked || std::find(ignored.begin(), ignored.end(), primitive) != ignored.end()) return;
    const auto hit = intersect(world_, primitive, ray);
    blocked = hit && hit->t_m < t_max;
    if (blocked) t_max = 0.0;
  };
  for (std::size_t i = 0; i < world_.quads.size(); ++i) consider({Kind::quad, i});
  for (std::size_t i = 0; i < world_.scene.spheres.size(); ++i) consider({Kind::sphere, i});
  for (std::size_t i = 0; i < world_.scene.shapes.size(); ++i) consider({Kind::shape, i});
  for (std::size_t i = 0; i < world_.scene.planes.size(); ++i) consider({Kind::plane, i});
  for_each_triangle(ray, t_max, [&](std::size_t i) { consider({Kind::triangle, i}); });
  return blocked;
}

}  // namespace hemiray::reference

#include "host/stability/shape_oracle.hpp"

#include <cmath>
#include <limits>

namespace hemiray::stability {

double ulp_along(const shared::QueryRay& ray, double t) {
  const Wide o = glm::abs(wide(ray.origin));
  const auto far = static_cast<double>(std::max({o.x, o.y, o.z}) / glm::length(wide(ray.direction)));
  const double size = std::max(std::abs(t), far);
  return size > 0.0 ? std::exp2(std::floor(std::log2(size))) * 0x1p-23 : 0x1p-149;
}

std::vector<SurfaceHit> ShapeOracle::hits(const Wide& o_world, const Wide& d_world, long double slack) const {
  std::vector<SurfaceHit> all;
  const Wide o = own(o_world), d = to_own_ * d_world;
  const auto add = [&](long double t, int part, long double depth) {
    if (!std::isfinite(t)) return;
    const Wide p = o_world + d_world * t;
    const long double m = std::min(margin(part, p), depth);
    if (m < -slack) return;
    all.push_back({t, std::abs(glm::dot(normal(part, p), glm::normalize(d_world))), m, part});
  };
  const auto add_plane = [&](long double z, int part) {
    if (d.z != 0) add((z - o.z) / d.z, part, reach());
  };
  if (shape_.kind == HR_SHAPE_DISK) {
    add_plane(0, HR_PART_SIDE);
    return all;
  }
  if (shape_.kind == HR_SHAPE_CONE) {
    add_plane(-shape_.form.z, HR_PART_LOWER_CAP);
    add_plane(shape_.form.z, HR_PART_UPPER_CAP);
  }
  // The side's or quadric's polynomial about the ray's point nearest to the shape.
  const long double start = -glm::dot(o, d) / glm::dot(d, d);
  const Wide m = o + d * start;
  const auto [a, b, c] = polynomial(m, d);
  const long double disc = b * b - a * c;
  const long double size = glm::length(d) * (glm::length(m) + reach());
  if (std::abs(a) * size < 1e-16L * std::abs(b) * glm::length(d)) {
    if (b != 0) add(start - c / (2 * b), HR_PART_SIDE, reach());
  } else {
    // Where it nearly touches: the depth of the chord's middle, or how far from it the ray passes.
    const Wide middle = o_world + d_world * (start - b / a);
    const long double depth = distance(HR_PART_SIDE, middle) * (disc < 0 ? -1 : 1);
    const long double root = std::sqrt(std::max(disc, 0.0L));
    const long double q = -(b + (b < 0 ? -root : root));
    add(start + q / a, HR_PART_SIDE, depth);
    add(start + (q != 0 ? c / q : q / a), HR_PART_SIDE, depth);
  }
  if (shape_.kind == HR_SHAPE_CONE) cut_short(o_world, d_world, &all);
  return all;
}

void ShapeOracle::cut_short(const Wide& o_world, const Wide& d_world, std::vector<SurfaceHit>* hits) const {
  long double in = std::numeric_limits<long double>::infinity(), out = -in;
  for (const SurfaceHit& hit : *hits) {
    if (hit.margin < 0) continue;
    in = std::min(in, hit.t);
    out = std::max(out, hit.t);
  }
  const Wide middle = o_world + d_world * ((in + out) / 2);
  for (SurfaceHit& hit : *hits) {
    if (hit.margin < 0) continue;
    for (const int part : {HR_PART_SIDE, HR_PART_LOWER_CAP, HR_PART_UPPER_CAP}) {
      hit.margin = std::min(hit.margin, 2 * distance(part, middle));
    }
  }
  if ((shape_.flags & HR_SHAPE_CAPPED) != 0) return;
  std::erase_if(*hits, [](const SurfaceHit& hit) { return hit.part != HR_PART_SIDE; });
}

long double ShapeOracle::distance(int part, const Wide& p_world) const {
  const Wide p = own(p_world);
  const Wide g = world_gradient(gradient(part, p));
  const long double f = value(part, p), steep = glm::length(g);
  if (f == 0) return 0;
  const long double curved = shape_.kind == HR_SHAPE_QUADRIC ? curvature() : 0;
  // The distance x at which steep x + curved x^2 = |f|, at least.
  const long double root = std::sqrt(steep * steep + 4 * curved * std::abs(f));
  return 2 * std::abs(f) / (steep + root);
}

Wide ShapeOracle::normal(int part, const Wide& p_world) const {
  return glm::normalize(world_gradient(gradient(part, own(p_world))));
}

long double ShapeOracle::margin(int part, const Wide& p_world) const {
  const Wide p = own(p_world);
  const long double distance = std::hypot(p.x, p.y), unit = scale();
  if (shape_.kind == HR_SHAPE_DISK) return (shape_.form.x - distance) * unit;
  if (shape_.kind == HR_SHAPE_CONE) {
    if (part == HR_PART_SIDE) return (shape_.form.z - std::abs(p.z)) * unit;
    return (radius_at(part == HR_PART_UPPER_CAP ? shape_.form.z : -shape_.form.z) - distance) * unit;
  }
  if ((shape_.flags & HR_SHAPE_CLIP_SPHERE) != 0) return (shape_.clip.w - glm::length(p)) * unit;
  if ((shape_.flags & HR_SHAPE_CLIP_BOX) == 0) return reach();
  const Wide room = wide(shape_.clip) - glm::abs(p);
  return std::min({room.x, room.y, room.z}) * unit;
}

WideMatrix ShapeOracle::matrix() const {
  const shared::float4 &k = shape_.form, &m = shape_.mixed;
  return {Wide(k.x, m.x, m.z), Wide(m.x, k.y, m.y), Wide(m.z, m.y, k.z)};
}

long double ShapeOracle::curvature() const {
  const WideMatrix a = rows_ * matrix() * to_own_;
  return glm::length(a[0]) + glm::length(a[1]) + glm::length(a[2]);
}

long double ShapeOracle::value(int part, const Wide& p) const {
  if (shape_.kind == HR_SHAPE_DISK) return p.z;
  if (part != HR_PART_SIDE) return part == HR_PART_UPPER_CAP ? p.z - shape_.form.z : -p.z - shape_.form.z;
  if (shape_.kind == HR_SHAPE_CONE) return std::hypot(p.x, p.y) - radius_at(p.z);
  return glm::dot(p, matrix() * p) + 2 * glm::dot(wide(shape_.linear), p) + shape_.form.w;
}

Wide ShapeOracle::gradient(int part, const Wide& p) const {
  if (shape_.kind == HR_SHAPE_DISK) return {0, 0, 1};
  if (part != HR_PART_SIDE) return {0, 0, part == HR_PART_UPPER_CAP ? 1 : -1};
  if (shape_.kind == HR_SHAPE_CONE) {
    const long double distance = std::hypot(p.x, p.y);
    return distance > 0 ? Wide(p.x / distance, p.y / distance, -shape_.form.y) : Wide(0, 0, 1);
  }
  return 2.0L * (matrix() * p + wide(shape_.linear));
}

std::array<long double, 3> ShapeOracle::polynomial(const Wide& m, const Wide& d) const {
  if (shape_.kind == HR_SHAPE_CONE) {
    const long double r = radius_at(m.z), k = shape_.form.y * d.z;
    return {d.x * d.x + d.y * d.y - k * k, m.x * d.x + m.y * d.y - r * k, m.x * m.x + m.y * m.y - r * r};
  }
  return {glm::dot(d, matrix() * d), glm::dot(d, matrix() * m + wide(shape_.linear)), value(HR_PART_SIDE, m)};
}

long double shape_tolerance(const ShapeOracle& shape, const Wide& d, long double t) {
  constexpr long double kOfReach = 4e-6L;  // a few dozen roundings in the shape's frame
  constexpr long double kOfWay = 1.2e-7L;  // two of t
  return kOfReach * shape.reach() + kOfWay * std::abs(t) * glm::length(d);
}

ShapeVerdict judge_shapes(std::span<const ShapeOracle> shapes, std::uint32_t first, const shared::QueryRay& ray,
                          const shared::QueryHit& answer) {
  constexpr long double kNever = std::numeric_limits<long double>::infinity();
  const Wide o = wide(ray.origin), d = wide(ray.direction);
  const long double length = glm::length(d), t_min = ray.origin.w, t = answer.t;
  const bool found = answer.primitive != HR_NO_PRIMITIVE;
  ShapeVerdict verdict;
  if (found) {
    if (answer.primitive - first >= shapes.size()) return {ShapeFault::off_surface, true, false, 0.0};
    const ShapeOracle& named = shapes[answer.primitive - first];
    const long double tolerance = shape_tolerance(named, d, t);
    const Wide p = o + d * t;
    const int part = static_cast<int>(answer.u);
    if (named.distance(part, p) > tolerance) verdict.fault = ShapeFault::off_surface;
    if (named.margin(part, p) < -tolerance) verdict.fault = ShapeFault::beyond_rim;
    if (!(t > t_min)) verdict.fault = ShapeFault::before_start;
  }
  long double nearest = kNever, exact = kNever, exact_along = 0;
  bool doubt = false;  // a hit that float may or may not see
  for (const ShapeOracle& shape : shapes) {
    const long double rim = 4 * shape_tolerance(shape, d, 0);
    for (const SurfaceHit& hit : shape.hits(o, d, rim)) {
      // Of t.
      const long double along = shape_tolerance(shape, d, hit.t) / std::max(hit.cosine, 1e-9L) / length;
      if (hit.margin >= 0 && hit.t > t_min && hit.t < exact) {
        exact = hit.t;
        exact_along = along;
      }
      // The rounding of t leads along the ray: it does not decide whether a rim or a silhouette is passed.
      const bool certain = hit.margin > rim && hit.cosine > 1e-3L;
      if (hit.t < t_min - along) continue;
      if (!certain || hit.t <= t_min + along) {
        doubt = true;
        continue;
      }
      nearest = std::min(nearest, hit.t + along);
    }
  }
  if (!found && nearest < kNever) verdict.fault = ShapeFault::missed;
  if (found && t > nearest && verdict.fault == ShapeFault::none) verdict.fault = ShapeFault::not_nearest;
  verdict.sure = !doubt;
  verdict.exact = found ? std::abs(t - exact) <= exact_along : exact == kNever;
  verdict.t = static_cast<double>(exact);
  return verdict;
}

}  // namespace hemiray::stability

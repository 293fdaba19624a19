#include "host/stability/oracle.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "host/stability/exact.hpp"
#include "host/stability/passage.hpp"

namespace hemiray::stability {
namespace {

using Real = long double;

constexpr std::uint32_t kNoTriangle = 0xffffffffU;
// Bounds of the rounding of a determinant of three factors, relative to its largest products: 8 operations in a row.
constexpr double kDoubleFilter = 16 * std::numeric_limits<double>::epsilon();
constexpr Real kLongFilter = 16 * std::numeric_limits<Real>::epsilon();
constexpr Real kSureOfT = 0x1p-40L;  // t is computed without rounding where it may be off by more

Vec3 point_of(const shared::float4& v) { return {v.x, v.y, v.z}; }

bool is_finite(Vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

struct Real3 {
  Real x, y, z;
};
Real3 minus(Vec3 a, Vec3 b) {
  return {static_cast<Real>(a.x) - b.x, static_cast<Real>(a.y) - b.y, static_cast<Real>(a.z) - b.z};
}
Real3 cross(const Real3& a, const Real3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Real dot(const Real3& a, const Real3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Real size(const Real3& a) { return std::abs(a.x) + std::abs(a.y) + std::abs(a.z); }

// On which side of an edge a ray passes, exactly.
int edge_sign(Vec3 o, Vec3 d, Vec3 p, Vec3 q) {
  const Real3 from = minus(p, o), to = minus(q, o), direction{d.x, d.y, d.z};
  const Real volume = dot(direction, cross(from, to));
  if (std::abs(volume) > kLongFilter * size(direction) * size(from) * size(to)) return volume > 0 ? 1 : -1;
  return exact_edge_sign(o, d, p, q);
}

// Where the ray, which does not lie along it, meets the plane.
double plane_t(Vec3 o, Vec3 d, const std::array<Vec3, 3>& corner) {
  const Real3 e1 = minus(corner[1], corner[0]), e2 = minus(corner[2], corner[0]), n = cross(e1, e2);
  const Real3 from = minus(corner[0], o), direction{d.x, d.y, d.z};
  const Real above = dot(from, n), below = dot(direction, n), rounding = kLongFilter * size(e1) * size(e2);
  if (rounding * size(from) < kSureOfT * std::abs(above) && rounding * size(direction) < kSureOfT * std::abs(below)) {
    return static_cast<double>(above / below);
  }
  return static_cast<double>(exact_plane_t(o, d, corner[0], corner[1], corner[2]));
}

double in_ulps(double off, double t) {
  const float of = static_cast<float>(std::abs(t));
  const double ulp = std::nextafter(of, std::numeric_limits<float>::infinity()) - static_cast<double>(of);
  return std::abs(off) / ulp;
}

}  // namespace

Oracle::Oracle(const FlatScene& flat) : flat_(&flat) {
  std::map<std::tuple<float, float, float>, std::uint32_t> places;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> known;
  triangle_of_.assign(flat.triangles.size(), kNoTriangle);
  for (std::uint32_t i = 0; i < flat.triangles.size(); i++) {
    const shared::uint4 index = flat.triangles[i];
    Triangle triangle{};
    triangle.primitive = i;
    bool finite = true;
    for (std::size_t k = 0; k < 3; k++) {
      const float* p = &flat.positions[std::size_t{3} * (k == 0 ? index.x : k == 1 ? index.y : index.z)];
      triangle.corner[k] = {p[0], p[1], p[2]};
      finite = finite && is_finite(triangle.corner[k]);
    }
    if (!finite) continue;
    for (std::size_t k = 0; k < 3; k++) {
      const Vec3 p = triangle.corner[k] + 0.0F;  // no negative zero
      triangle.place[k] = places.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(places.size())).first->second;
    }
    std::array<std::uint32_t, 3> key = triangle.place;
    std::sort(key.begin(), key.end());
    const auto [found, is_new] = known.try_emplace(key, kNoTriangle);
    if (is_new && !exact_collinear(triangle.corner[0], triangle.corner[1], triangle.corner[2])) {
      found->second = static_cast<std::uint32_t>(triangles_.size());
      triangles_.push_back(triangle);
    }
    triangle_of_[i] = found->second;
  }
  for (std::uint32_t i = 0; i < triangles_.size(); i++) {
    for (std::size_t k = 0; k < 3; k++) {
      const auto [least, most] = std::minmax(triangles_[i].place[(k + 1) % 3], triangles_[i].place[(k + 2) % 3]);
      sides_.push_back({{least, most}, i});
    }
  }
  std::sort(sides_.begin(), sides_.end(),
            [](const Side& a, const Side& b) { return std::tie(a.ends, a.triangle) < std::tie(b.ends, b.triangle); });
}

std::span<const Oracle::Side> Oracle::sides_at(const std::array<std::uint32_t, 2>& ends) const {
  const auto first = std::lower_bound(sides_.begin(), sides_.end(), ends,
                                      [](const Side& side, const auto& key) { return side.ends < key; });
  auto last = first;
  while (last != sides_.end() && last->ends == ends) ++last;
  return {first, last};
}

// Whether no vertices within the bound of the true ones would let the ray, which meets the triangle, pass by: it and
// those around it leave no outline near the ray. Goes from neighbour to neighbour through sides that the ray is near.
bool Oracle::is_sure(std::uint32_t triangle, const shared::QueryRay& ray) const {
  std::vector<std::uint32_t> reached{triangle};
  for (std::size_t next = 0; next < reached.size(); next++) {
    const Triangle& here = triangles_[reached[next]];
    const Passage passage(ray, here.corner);
    for (int k = 0; k < 3; k++) {
      if (!passage.is_near_side(k)) continue;
      const auto i = static_cast<std::size_t>(k);
      const auto [least, most] = std::minmax(here.place[(i + 1) % 3], here.place[(i + 2) % 3]);
      bool goes_on = false;
      for (const Side& side : sides_at({least, most})) {
        if (side.triangle == reached[next]) continue;
        const Triangle& other = triangles_[side.triangle];
        const Passage beside(ray, other.corner);
        // On the other side of the common side: both turn the same way round where their windings agree.
        std::size_t corner = 0;
        while (other.place[corner] == least || other.place[corner] == most) corner++;
        const bool same_way = other.place[(corner + 1) % 3] == here.place[(i + 2) % 3];
        if ((passage.area() > 0) != ((beside.area() > 0) == same_way)) continue;
        goes_on = true;
        if (std::find(reached.begin(), reached.end(), side.triangle) == reached.end()) reached.push_back(side.triangle);
      }
      if (!goes_on) return false;
    }
  }
  return true;
}

void Oracle::Session::move_to(const shared::QueryRay& ray) {
  const Vec3 origin = point_of(ray.origin);
  if (at_origin_ && origin == origin_) return;
  origin_ = origin;
  at_origin_ = true;
  const std::size_t count = oracle_->triangles_.size();
  for (auto& row : normals_) row.resize(count);
  reach_.resize(count);
  near_.resize(count);
  for (std::size_t i = 0; i < count; i++) {
    std::array<DVec3, 3> v;
    double reach = 0.0;
    for (std::size_t k = 0; k < 3; k++) {
      v[k] = DVec3(oracle_->triangles_[i].corner[k]) - DVec3(origin);
      reach = std::max(reach, std::abs(v[k].x) + std::abs(v[k].y) + std::abs(v[k].z));
    }
    reach_[i] = reach * reach;
    for (std::size_t k = 0; k < 3; k++) {
      const DVec3 n = glm::cross(v[(k + 1) % 3], v[(k + 2) % 3]);
      for (int axis = 0; axis < 3; axis++) normals_[3 * k + static_cast<std::size_t>(axis)][i] = n[axis];
    }
  }
}

std::optional<Met> Oracle::Session::meet_triangle(std::uint32_t index, const shared::QueryRay& ray) const {
  const Triangle& triangle = oracle_->triangles_[index];
  const Vec3 o = point_of(ray.origin), d = point_of(ray.direction);
  int least = 1, most = -1;
  for (std::size_t k = 0; k < 3; k++) {
    const int sign = edge_sign(o, d, triangle.corner[(k + 1) % 3], triangle.corner[(k + 2) % 3]);
    least = std::min(least, sign);
    most = std::max(most, sign);
    if (least < 0 && most > 0) return std::nullopt;
  }
  if (least == 0 && most == 0) return std::nullopt;  // it lies along the ray
  Met met;
  met.primitive = triangle.primitive;
  met.t = plane_t(o, d, triangle.corner);
  return met;
}

std::optional<Met> Oracle::meet_sphere(std::uint32_t index, const shared::QueryRay& ray, bool& sure) const {
  const shared::float4 s = flat_->spheres[index].center_radius;
  const Vec3 d = point_of(ray.direction);
  const Real3 oc = minus(point_of(ray.origin), {s.x, s.y, s.z}), direction{d.x, d.y, d.z};
  const Real length2 = dot(direction, direction), b = -dot(oc, direction) / length2;
  const Real3 middle{oc.x + b * direction.x, oc.y + b * direction.y, oc.z + b * direction.z};
  const Real beside2 = dot(middle, middle), out2 = dot(oc, oc);
  const Real off = kBoundUlps * 0x1p-23L * (std::sqrt(out2) + s.w);
  // Where a ray that passes at `beside2` meets the sphere of radius r first, beyond t_min.
  const auto enter = [&](Real r, bool& meets) {
    const Real chord2 = (r * r - beside2) / length2;
    meets = r > 0 && chord2 >= 0;
    const Real half = std::sqrt(std::max(chord2, 0.0L));
    // The two roots' product, so that the nearer one does not cancel.
    const Real q = b >= 0 ? b + half : b - half;
    const Real other = q != 0 ? (out2 - r * r) / (length2 * q) : q;
    const Real lo = std::min(q, other), hi = std::max(q, other);
    const Real t = lo > ray.origin.w ? lo : hi;
    meets = meets && t > ray.origin.w;
    return t;
  };
  bool meets = false, meets_larger = false;
  Met met;
  met.primitive = static_cast<std::uint32_t>(flat_->triangles.size()) + index;
  met.t = static_cast<double>(enter(s.w, meets));
  const Real larger = enter(s.w + off, meets_larger), smaller = enter(s.w - off, sure);
  const Real rounding = kBoundUlps * 0x1p-23L * std::abs(larger);
  met.nearest = static_cast<double>(std::min(larger, smaller) - rounding);
  met.farthest = static_cast<double>(std::max(larger, smaller) + rounding);
  if (!meets_larger) return std::nullopt;
  if (!meets) met.primitive = HR_NO_PRIMITIVE;
  return met;
}

Truth Oracle::Session::meet(const shared::QueryRay& ray) {
  move_to(ray);
  const Vec3 d = point_of(ray.direction);
  const double dx = d.x, dy = d.y, dz = d.z;
  const double filter = kDoubleFilter * (std::abs(dx) + std::abs(dy) + std::abs(dz));
  const std::size_t count = near_.size();
  for (std::size_t i = 0; i < count; i++) {
    const double wa = dx * normals_[0][i] + dy * normals_[1][i] + dz * normals_[2][i];
    const double wb = dx * normals_[3][i] + dy * normals_[4][i] + dz * normals_[5][i];
    const double wc = dx * normals_[6][i] + dy * normals_[7][i] + dz * normals_[8][i];
    const double unsure = filter * reach_[i];
    const double least = std::min(std::min(wa, wb), wc), most = std::max(std::max(wa, wb), wc);
    near_[i] = static_cast<unsigned char>((least >= -unsure) | (most <= unsure));
  }
  Truth truth;
  const auto add = [&](const std::optional<Met>& met) {
    if (met && met->t > ray.origin.w && met->t < ray.direction.w) truth.push_back(*met);
  };
  for (std::uint32_t i = 0; i < count; i++) {
    if (near_[i] != 0) add(meet_triangle(i, ray));
  }
  for (std::uint32_t i = 0; i < oracle_->flat_->spheres.size(); i++) {
    bool sure = false;
    const std::optional<Met> met = oracle_->meet_sphere(i, ray, sure);
    if (met && met->primitive != HR_NO_PRIMITIVE) add(met);
  }
  std::sort(truth.begin(), truth.end(),
            [](const Met& a, const Met& b) { return std::tie(a.t, a.primitive) < std::tie(b.t, b.primitive); });
  return truth;
}

void Oracle::Session::judge(const shared::QueryRay& ray, const Truth& truth, const shared::QueryHit& answer,
                            bool inside, Tally& tally) {
  const Oracle& oracle = *oracle_;
  const auto triangles = static_cast<std::uint32_t>(oracle.flat_->triangles.size());
  tally.rays++;
  const auto is_sure = [&](const Met& met) {
    if (inside) return true;
    if (met.primitive < triangles) return oracle.is_sure(oracle.triangle_of_[met.primitive], ray);
    bool sure = false;
    oracle.meet_sphere(met.primitive - triangles, ray, sure);
    return sure;
  };
  const auto interval_of = [&](const Met& met) {
    Met with = met;
    if (met.primitive < triangles) {
      double ignored = 0.0;
      const Passage passage(ray, oracle.triangles_[oracle.triangle_of_[met.primitive]].corner);
      passage.interval(&ignored, &with.nearest, &with.farthest);
    }
    return with;
  };
  if (answer.primitive == HR_NO_PRIMITIVE) {
    if (truth.empty()) return;
    const bool sure = std::any_of(truth.begin(), truth.end(), is_sure);
    (sure ? tally.missed : tally.borderline)++;
    return;
  }
  // Nearly all answers are these: the right one, well within the bound.
  const bool first_named = !truth.empty() && truth.front().primitive == answer.primitive;
  if (first_named && std::abs(answer.t - truth.front().t) <= kBoundUlps * 0x1p-23 * std::abs(truth.front().t)) {
    tally.worst_ulps = std::max(tally.worst_ulps, in_ulps(answer.t - truth.front().t, truth.front().t));
    return;
  }
  // The primitive that is named, as the oracle knows it.
  Met named;
  named.primitive = answer.primitive;
  bool known = false, met_exactly = false;
  if (answer.primitive < triangles) {
    const std::uint32_t index = oracle.triangle_of_[answer.primitive];
    if (index != kNoTriangle) {
      named.primitive = oracle.triangles_[index].primitive;
      const Passage passage(ray, oracle.triangles_[index].corner);
      known = passage.is_met_within_bound();
      passage.interval(&named.t, &named.nearest, &named.farthest);
    }
  } else if (answer.primitive - triangles < oracle.flat_->spheres.size()) {
    bool sure = false;
    if (const auto met = oracle.meet_sphere(answer.primitive - triangles, ray, sure)) {
      named = *met;
      named.primitive = answer.primitive;
      known = true;
    }
  }
  const double t = answer.t;
  for (const Met& met : truth) {
    if (met.primitive != named.primitive) continue;
    met_exactly = true;
    tally.worst_ulps = std::max(tally.worst_ulps, in_ulps(t - met.t, met.t));
  }
  if (!known || !(t >= named.nearest && t <= named.farthest)) {
    tally.false_hit++;
    return;
  }
  if (!truth.empty() && truth.front().primitive != named.primitive) {
    const Met first = interval_of(truth.front());
    if (first.farthest < named.nearest) {
      if (!is_sure(truth.front())) {
        tally.borderline++;
        return;
      }
      tally.missed++;
      tally.wrong_surface++;
      return;
    }
    if (first.nearest <= named.farthest) return;  // they cannot be told apart
  }
  if (!met_exactly) tally.borderline++;
}

}  // namespace hemiray::stability

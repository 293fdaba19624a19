// Ear clipping (Meisters 1975), with ear status kept per vertex so that n corners take O(n^2).
#include "host/scene/triangulate.hpp"

#include <cmath>

namespace hemiray {

namespace {

using DVec2 = glm::dvec2;

DVec3 newell_normal(std::span<const Vec3> corners) {
  DVec3 normal(0.0);
  const DVec3 origin(corners[0]);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const DVec3 a = DVec3(corners[i]) - origin;
    const DVec3 b = DVec3(corners[(i + 1) % corners.size()]) - origin;
    normal += glm::cross(a, b);
  }
  return normal;
}

// Dropping the dominant axis is exact, a rotation into the plane would round.
std::vector<DVec2> project(std::span<const Vec3> corners, const DVec3& normal) {
  const DVec3 size = glm::abs(normal);
  const int drop = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  const int u = (drop + 1) % 3;
  const int v = (drop + 2) % 3;
  const double sign = normal[drop] < 0.0 ? -1.0 : 1.0;
  std::vector<DVec2> flat;
  flat.reserve(corners.size());
  for (const Vec3& corner : corners) {
    flat.emplace_back(sign * static_cast<double>(corner[u]), static_cast<double>(corner[v]));
  }
  return flat;
}

double orient(const DVec2& a, const DVec2& b, const DVec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// The polygon that is left, as a ring of corners.
class Ring {
 public:
  explicit Ring(std::vector<DVec2> flat) : flat_(std::move(flat)), size_(static_cast<std::uint32_t>(flat_.size())) {
    links_.resize(flat_.size());
    turn_.resize(flat_.size());
    ear_.resize(flat_.size());
    for (std::uint32_t i = 0; i < size_; ++i) links_[i] = {(i + size_ - 1) % size_, (i + 1) % size_};
    for (std::uint32_t i = 0; i < size_; ++i) update_turn(i);
    for (std::uint32_t i = 0; i < size_; ++i) update_ear(i);
  }

  [[nodiscard]] std::uint32_t size() const { return size_; }
  [[nodiscard]] std::uint32_t previous(std::uint32_t i) const { return links_[i].previous; }
  [[nodiscard]] std::uint32_t next(std::uint32_t i) const { return links_[i].next; }

  // The first ear at or after i. A self-intersecting rest may have none: then a straight corner, a convex one, or i.
  [[nodiscard]] std::uint32_t find_ear(std::uint32_t i) const {
    std::uint32_t straight = i;
    std::uint32_t convex = i;
    std::uint32_t at = i;
    for (std::uint32_t n = 0; n < size_; ++n, at = next(at)) {
      if (ear_[at]) return at;
      if (turn_[at] == 0.0) straight = at;
      if (turn_[at] > 0.0) convex = at;
    }
    return turn_[straight] == 0.0 ? straight : convex;
  }

  void clip(std::uint32_t i) {
    const Link link = links_[i];
    links_[link.previous].next = link.next;
    links_[link.next].previous = link.previous;
    --size_;
    update_turn(link.previous);
    update_turn(link.next);
    update_ear(link.previous);
    update_ear(link.next);
  }

 private:
  struct Link {
    std::uint32_t previous;
    std::uint32_t next;
  };

  void update_turn(std::uint32_t i) { turn_[i] = orient(flat_[previous(i)], flat_[i], flat_[next(i)]); }

  void update_ear(std::uint32_t i) {
    ear_[i] = false;
    if (!(turn_[i] > 0.0)) return;
    const std::uint32_t before = previous(i);
    const std::uint32_t after = next(i);
    const DVec2& a = flat_[before];
    const DVec2& b = flat_[i];
    const DVec2& c = flat_[after];
    for (std::uint32_t k = next(after); k != before; k = next(k)) {
      if (turn_[k] > 0.0) continue;  // a triangle that holds any corner holds one that is not convex
      const DVec2& p = flat_[k];
      if (p == a || p == b || p == c) continue;  // the two sides of a bridge to a hole
      if (orient(a, b, p) >= 0.0 && orient(b, c, p) >= 0.0 && orient(c, a, p) >= 0.0) return;
    }
    ear_[i] = true;
  }

  std::vector<DVec2> flat_;
  std::uint32_t size_;
  std::vector<Link> links_;
  std::vector<double> turn_;  // > 0 convex, 0 straight, < 0 reflex
  std::vector<bool> ear_;
};

}  // namespace

bool is_degenerate(const Vec3& a, const Vec3& b, const Vec3& c) {
  const DVec3 origin(a);
  const DVec3 cross = glm::cross(DVec3(b) - origin, DVec3(c) - origin);
  return cross.x == 0.0 && cross.y == 0.0 && cross.z == 0.0;
}

std::size_t triangulate(std::span<const Vec3> corners, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::size_t dropped = 0;
  const auto emit = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (is_degenerate(corners[a], corners[b], corners[c])) {
      ++dropped;
    } else {
      triangles.push_back({a, b, c});
    }
  };
  if (corners.size() == 3) {
    emit(0, 1, 2);
    return dropped;
  }
  const DVec3 normal = newell_normal(corners);
  if (normal == DVec3(0.0)) {  // no plane to clip in, as for a bow tie: any triangulation is as good
    for (std::uint32_t i = 1; i + 1 < corners.size(); ++i) emit(0, i, i + 1);
    return dropped;
  }
  Ring ring(project(corners, normal));
  std::uint32_t at = 1;
  while (ring.size() > 3) {
    const std::uint32_t ear = ring.find_ear(at);
    emit(ring.previous(ear), ear, ring.next(ear));
    at = ring.next(ear);
    ring.clip(ear);
  }
  const std::uint32_t before = ring.previous(at);
  emit(before, at, ring.next(at));
  return dropped;
}

}  // namespace hemiray

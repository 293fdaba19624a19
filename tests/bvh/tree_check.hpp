// Checks a built tree against everything that must hold of it, from the scene alone.
#pragma once

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <vector>

#include "tests/bvh/flat_shapes.hpp"

namespace hemiray::test {

/// Entries of the traversal's stack (kernels/lib/traverse.h): no tree may be deeper.
inline constexpr int kMaxTreeDepth = 96;

struct HostBox {
  Vec3 lo{std::numeric_limits<float>::infinity()};
  Vec3 hi{-std::numeric_limits<float>::infinity()};
  void add(const HostBox& other) {
    lo = glm::min(lo, other.lo);
    hi = glm::max(hi, other.hi);
  }
  bool operator==(const HostBox& other) const { return lo == other.lo && hi == other.hi; }
};

enum class PrimitiveStatus { valid, non_finite, degenerate };

/// What the build must make of a primitive, by arithmetic in double.
inline PrimitiveStatus status_of(const FlatScene& flat, std::uint32_t primitive) {
  const auto finite = [](const DVec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); };
  if (primitive >= flat.triangles.size()) {
    const shared::float4 s = flat.spheres[primitive - flat.triangles.size()].center_radius;
    if (!finite({s.x, s.y, s.z}) || !std::isfinite(s.w)) return PrimitiveStatus::non_finite;
    return s.w > 0.0F ? PrimitiveStatus::valid : PrimitiveStatus::degenerate;
  }
  const shared::uint4 t = flat.triangles[primitive];
  const DVec3 a = vertex(flat, t.x), b = vertex(flat, t.y), c = vertex(flat, t.z);
  if (!finite(a) || !finite(b) || !finite(c)) return PrimitiveStatus::non_finite;
  const DVec3 e1 = b - a, e2 = c - a;
  const DVec3 n = glm::cross(e1, e2);
  return glm::dot(n, n) > 0.0 ? PrimitiveStatus::valid : PrimitiveStatus::degenerate;
}

/// A triangle's box is exact; a sphere's, with the kernels' padding of an ulp.
inline HostBox box_of(const FlatScene& flat, std::uint32_t primitive) {
  if (primitive >= flat.triangles.size()) {
    const shared::float4 s = flat.spheres[primitive - flat.triangles.size()].center_radius;
    const Vec3 center(s.x, s.y, s.z);
    const Vec3 pad = (glm::abs(center) + s.w) * 0x1p-23F;
    return {center - s.w - pad, center + s.w + pad};
  }
  const shared::uint4 t = flat.triangles[primitive];
  const Vec3 a = vertex(flat, t.x), b = vertex(flat, t.y), c = vertex(flat, t.z);
  return {glm::min(glm::min(a, b), c), glm::max(glm::max(a, b), c)};
}

/// Valid primitives in the order of their Morton codes, equal codes by index.
inline std::vector<std::uint32_t> morton_order(const FlatScene& flat, const std::vector<std::uint32_t>& valid,
                                               unsigned bits) {
  std::vector<Vec3> centers;
  HostBox bounds;
  for (const std::uint32_t primitive : valid) {
    const HostBox box = box_of(flat, primitive);
    centers.push_back(0.5F * box.lo + 0.5F * box.hi);
    bounds.add({centers.back(), centers.back()});
  }
  const unsigned axis_bits = bits / 3;
  const Vec3 extent = bounds.hi - bounds.lo;
  std::vector<std::uint64_t> codes;
  for (const Vec3& center : centers) {
    std::uint64_t code = 0;
    std::array<std::uint64_t, 3> cell{};
    for (int k = 0; k < 3; k++) {
      if (!(extent[k] > 0.0F)) continue;
      const float cells = static_cast<float>(1U << axis_bits);
      cell[static_cast<std::size_t>(k)] =
          std::min<std::uint64_t>(static_cast<std::uint64_t>((center[k] - bounds.lo[k]) / extent[k] * cells),
                                  (std::uint64_t{1} << axis_bits) - 1);
    }
    for (unsigned bit = axis_bits; bit-- > 0;) {
      for (const std::uint64_t c : cell) code = code << 1U | (c >> bit & 1U);
    }
    codes.push_back(code);
  }
  std::vector<std::uint32_t> places(valid.size());
  std::iota(places.begin(), places.end(), 0U);
  std::stable_sort(places.begin(), places.end(), [&](auto a, auto b) { return codes[a] < codes[b]; });
  std::vector<std::uint32_t> order;
  for (const std::uint32_t place : places) order.push_back(valid[place]);
  return order;
}

/// Walks one tree and compares it with its scene.
class TreeCheck {
 public:
  TreeCheck(const FlatScene& flat, const Accel& accel)
      : flat_(flat), accel_(accel), nodes_(accel.nodes().read()), leaves_(accel.leaves().read()) {}

  /// `exact_order`: the device divides as the host does, so Morton codes are equal to the bit.
  void run(bool exact_order) {
    check_statistics();
    if (valid_.size() < 2) {
      check_lone_leaf();
    } else {
      REQUIRE(nodes_.size() == valid_.size() - 1);
      REQUIRE(leaves_.size() == valid_.size());
      check_leaves(exact_order);
      node_seen_.assign(nodes_.size(), false);
      leaf_seen_.assign(leaves_.size(), false);
      walk(0, 1);
      CHECK(std::count(node_seen_.begin(), node_seen_.end(), true) == static_cast<std::ptrdiff_t>(nodes_.size()));
      CHECK(std::count(leaf_seen_.begin(), leaf_seen_.end(), true) == static_cast<std::ptrdiff_t>(leaves_.size()));
      CHECK(deepest_ <= kMaxTreeDepth);
      CHECK(wrong_boxes_ == 0);
    }
  }

 private:
  void check_statistics() {
    std::uint32_t non_finite = 0, degenerate = 0;
    HostBox bounds;
    const auto count = static_cast<std::uint32_t>(flat_.triangles.size() + flat_.spheres.size());
    for (std::uint32_t i = 0; i < count; i++) {
      const PrimitiveStatus status = status_of(flat_, i);
      non_finite += status == PrimitiveStatus::non_finite;
      degenerate += status == PrimitiveStatus::degenerate;
      if (status != PrimitiveStatus::valid) continue;
      valid_.push_back(i);
      bounds.add(box_of(flat_, i));
    }
    const AccelStatistics& statistics = accel_.statistics();
    CHECK(statistics.primitives == valid_.size());
    CHECK(statistics.non_finite == non_finite);
    CHECK(statistics.degenerate == degenerate);
    CHECK(Vec3(statistics.lo.x, statistics.lo.y, statistics.lo.z) == bounds.lo);
    CHECK(Vec3(statistics.hi.x, statistics.hi.y, statistics.hi.z) == bounds.hi);
  }

  // One primitive lies on both sides of the only node; for none there is a leaf of NaNs.
  void check_lone_leaf() const {
    REQUIRE(nodes_.size() == 1);
    REQUIRE(leaves_.size() == 1);
    CHECK(nodes_[0].child.x == ~0U);
    CHECK(nodes_[0].child.y == ~0U);
    if (valid_.empty()) {
      CHECK(primitive_of(0) == HR_NO_PRIMITIVE);
      CHECK(std::isnan(leaves_[0].a.x));
      CHECK(std::isnan(leaves_[0].b.x));
      return;
    }
    CHECK(primitive_of(0) == valid_[0]);
    CHECK(is_true_leaf(0));
    CHECK(side_box(0, 0) == box_of(flat_, valid_[0]));
    CHECK(side_box(0, 1) == box_of(flat_, valid_[0]));
  }

  void check_leaves(bool exact_order) const {
    std::vector<std::uint32_t> order;
    std::size_t untrue = 0;
    for (std::size_t i = 0; i < leaves_.size(); i++) {
      order.push_back(primitive_of(i));
      untrue += is_true_leaf(i) ? 0 : 1;
    }
    CHECK(untrue == 0);
    if (exact_order) {
      const bool sorted = order == morton_order(flat_, valid_, accel_.statistics().morton_bits);
      CHECK(sorted);
    }
    std::sort(order.begin(), order.end());
    const bool each_once = order == valid_;
    CHECK(each_once);
  }

  // Visits a node; its boxes must be the exact unions of what lies below. Returns that union.
  HostBox walk(std::uint32_t node, int depth) {
    REQUIRE(node < nodes_.size());
    REQUIRE_FALSE(node_seen_[node]);
    node_seen_[node] = true;
    deepest_ = std::max(deepest_, depth);
    HostBox all;
    for (const int side : {0, 1}) {
      const auto child = static_cast<std::int32_t>(side == 0 ? nodes_[node].child.x : nodes_[node].child.y);
      HostBox below;
      if (child < 0) {
        const auto leaf = static_cast<std::size_t>(~child);
        REQUIRE(leaf < leaves_.size());
        REQUIRE_FALSE(leaf_seen_[leaf]);
        leaf_seen_[leaf] = true;
        below = box_of(flat_, primitive_of(leaf));
      } else {
        below = walk(static_cast<std::uint32_t>(child), depth + 1);
      }
      wrong_boxes_ += side_box(node, side) == below ? 0 : 1;
      all.add(below);
    }
    return all;
  }

  [[nodiscard]] HostBox side_box(std::size_t node, int side) const {
    const shared::BvhNode& n = nodes_[node];
    return side == 0 ? HostBox{{n.x.x, n.y.x, n.z.x}, {n.x.y, n.y.y, n.z.y}}
                     : HostBox{{n.x.z, n.y.z, n.z.z}, {n.x.w, n.y.w, n.z.w}};
  }

  [[nodiscard]] std::uint32_t primitive_of(std::size_t leaf) const {
    return std::bit_cast<std::uint32_t>(leaves_[leaf].a.w);
  }

  // Does the leaf hold the geometry of the primitive it names?
  [[nodiscard]] bool is_true_leaf(std::size_t i) const {
    const std::uint32_t primitive = primitive_of(i);
    const shared::BvhLeaf& leaf = leaves_[i];
    const auto is = [](const shared::float4& v, const Vec3& p) { return v.x == p.x && v.y == p.y && v.z == p.z; };
    if (primitive < flat_.triangles.size()) {
      const shared::uint4 t = flat_.triangles[primitive];
      return is(leaf.a, vertex(flat_, t.x)) && is(leaf.b, vertex(flat_, t.y)) && is(leaf.c, vertex(flat_, t.z));
    }
    if (primitive - flat_.triangles.size() >= flat_.spheres.size()) return false;
    const shared::float4 s = flat_.spheres[primitive - flat_.triangles.size()].center_radius;
    return is(leaf.a, {s.x, s.y, s.z}) && leaf.b.x == s.w;
  }

  const FlatScene& flat_;
  const Accel& accel_;
  std::vector<shared::BvhNode> nodes_;
  std::vector<shared::BvhLeaf> leaves_;
  std::vector<std::uint32_t> valid_;
  std::vector<bool> node_seen_, leaf_seen_;
  int deepest_ = 0;
  std::size_t wrong_boxes_ = 0;
};

}  // namespace hemiray::test

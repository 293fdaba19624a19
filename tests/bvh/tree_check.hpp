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

/// Bits of Morton codes that a tree of `count` primitives is built with where `asked` are asked for (0: the default).
inline unsigned expected_morton_bits(std::size_t count, unsigned asked) {
  const unsigned index_bits = static_cast<unsigned>(std::bit_width(std::max<std::size_t>(count, 2) - 1));
  return std::min(asked != 0 ? asked : 33U, 63U - index_bits) / 3 * 3;
}

/// The place of each valid primitive in the order of their Morton codes, equal codes by index; HR_NO_PRIMITIVE for the
/// others. The arithmetic is the kernels' own, which rounds alike everywhere.
inline std::vector<std::uint32_t> morton_places(const FlatScene& flat, const std::vector<std::uint32_t>& valid,
                                                unsigned bits) {
  std::vector<Vec3> centers;
  HostBox bounds;
  for (const std::uint32_t primitive : valid) {
    const HostBox box = box_of(flat, primitive);
    centers.push_back(0.5F * box.lo + 0.5F * box.hi);
    bounds.add({centers.back(), centers.back()});
  }
  const unsigned axis_bits = bits / 3;
  const float last = static_cast<float>((std::uint64_t{1} << axis_bits) - 1);
  std::vector<std::uint64_t> codes;
  for (const Vec3& center : centers) {
    std::array<std::uint64_t, 3> cell{};
    for (int k = 0; k < 3; k++) {
      const float extent = bounds.hi[k] - bounds.lo[k];
      if (!(extent > 0.0F)) continue;
      const float scale = std::min(std::ldexp(1.0F, static_cast<int>(axis_bits)) / extent, 0x1.fffffep127F);
      const float at = (center[k] - bounds.lo[k]) * scale;
      cell[static_cast<std::size_t>(k)] = static_cast<std::uint64_t>(std::max(0.0F, at < last ? at : last));
    }
    std::uint64_t code = 0;
    for (unsigned bit = axis_bits; bit-- > 0;) {
      for (const std::uint64_t c : cell) code = code << 1U | (c >> bit & 1U);
    }
    codes.push_back(code);
  }
  std::vector<std::uint32_t> order(valid.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return codes[a] < codes[b]; });
  std::vector<std::uint32_t> places(flat.triangles.size() + flat.spheres.size(), HR_NO_PRIMITIVE);
  for (std::uint32_t place = 0; place < order.size(); place++) places[valid[order[place]]] = place;
  return places;
}

/// The kernels may round a surface otherwise than the host.
inline constexpr double kWorthError = 1e-5;

/// Walks one tree and compares it with its scene.
class TreeCheck {
 public:
  /// `options`: what the tree was built with, max_leaf and morton_bits among them.
  TreeCheck(const FlatScene& flat, const Accel& accel, const AccelOptions& options)
      : flat_(flat),
        accel_(accel),
        options_(options),
        width_(accel.config().width),
        lanes_(accel.config().leaf_lanes),
        nodes_(accel.nodes().read()),
        blocks_(accel.blocks().read()) {}

  /// `refitted`: the scene's vertices moved since, so its bounds and Morton codes are not those of the build.
  void run(bool refitted = false) {
    check_statistics(refitted);
    const AccelStatistics& statistics = accel_.statistics();
    REQUIRE(nodes_.size() == std::size_t{statistics.nodes} * 8 * width_);
    REQUIRE(blocks_.size() == std::max<std::size_t>(statistics.blocks, 1) * HR_BLOCK_ROWS * lanes_);
    if (valid_.empty()) {
      CHECK(statistics.nodes == 1);
      CHECK(statistics.blocks == 0);
    } else if (!refitted) {
      CHECK(statistics.morton_bits ==
            expected_morton_bits(flat_.triangles.size() + flat_.spheres.size(), options_.morton_bits));
      if (options_.builder == TreeBuilder::fast) places_ = morton_places(flat_, valid_, statistics.morton_bits);
    }
    node_seen_.assign(statistics.nodes, false);
    block_seen_.assign(statistics.blocks, false);
    const Below all = walk(0, 0);
    CHECK(all.box == bounds_);
    CHECK(std::count(node_seen_.begin(), node_seen_.end(), true) == std::ptrdiff_t{statistics.nodes});
    CHECK(std::count(block_seen_.begin(), block_seen_.end(), true) == std::ptrdiff_t{statistics.blocks});
    std::sort(found_.begin(), found_.end());
    const bool each_once = found_ == valid_;
    CHECK(each_once);
    CHECK(wrong_boxes_ == 0);
    CHECK(wrong_lanes_ == 0);
    CHECK(wrong_order_ == 0);
    if (!refitted) CHECK(wrong_worth_ == 0);
    CHECK(wrong_numbers_ == 0);
    CHECK(statistics.stack_depth == std::max(stack_need_, 1U));
    CHECK(accel_.config().stack >= statistics.stack_depth);
  }

 private:
  /// What lies below a child: its box, and its places in Morton order.
  struct Below {
    HostBox box;
    std::uint32_t first = ~0U, last = 0, count = 0;
    void add(const Below& other) {
      box.add(other.box);
      first = std::min(first, other.first);
      last = std::max(last, other.last);
      count += other.count;
    }
  };

  void check_statistics(bool refitted) {
    std::uint32_t non_finite = 0, degenerate = 0;
    const auto count = static_cast<std::uint32_t>(flat_.triangles.size() + flat_.spheres.size());
    for (std::uint32_t i = 0; i < count; i++) {
      const PrimitiveStatus status = status_of(flat_, i);
      non_finite += status == PrimitiveStatus::non_finite;
      degenerate += status == PrimitiveStatus::degenerate;
      if (status != PrimitiveStatus::valid) continue;
      valid_.push_back(i);
      bounds_.add(box_of(flat_, i));
    }
    const AccelStatistics& statistics = accel_.statistics();
    CHECK(statistics.primitives == valid_.size());
    CHECK(statistics.non_finite == non_finite);
    CHECK(statistics.degenerate == degenerate);
    if (refitted) return;
    CHECK(Vec3(statistics.lo.x, statistics.lo.y, statistics.lo.z) == bounds_.lo);
    CHECK(Vec3(statistics.hi.x, statistics.hi.y, statistics.hi.z) == bounds_.hi);
  }

  // Visits a node with `load` entries on the traversal's stack. Its boxes must be the exact unions of what lies below,
  // and what lies below a child of a radix tree is a range of the Morton order.
  Below walk(std::uint32_t node, std::uint32_t load) {
    if (node >= node_seen_.size()) FAIL("a child refers to node " << node << " of " << node_seen_.size());
    if (node_seen_[node]) FAIL("node " << node << " hangs in the tree twice");
    node_seen_[node] = true;
    std::uint32_t children = 0;
    for (unsigned lane = 0; lane < width_; lane++) children += child_of(node, lane) != -1 ? 1 : 0;
    stack_need_ = std::max(stack_need_, load + children);
    if (children == 0 && !valid_.empty()) FAIL("node " << node << " has no children");
    Below all;
    std::array<Below, 8> children_below;
    for (unsigned lane = 0; lane < width_; lane++) {
      const std::int32_t child = child_of(node, lane);
      Below below;
      if (child >= 0) {
        below = walk(static_cast<std::uint32_t>(child), load + children - 1);
      } else if (child != -1) {
        below = visit_leaf(~static_cast<std::uint32_t>(child));
      }
      wrong_boxes_ += box_of_child(node, lane) == below.box ? 0 : 1;
      wrong_lanes_ += word(nodes_, (node * 8 + 7) * std::size_t{width_} + lane) == 0 ? 0 : 1;
      if (child != -1 && !places_.empty()) wrong_order_ += below.last - below.first + 1 == below.count ? 0 : 1;
      all.add(below);
      children_below[lane] = below;
    }
    check_order(node, children_below);
    return all;
  }

  // Rays that ask for any hit look into the last lane first, so it holds the most surface a primitive; siblings are
  // numbered by size.
  void check_order(std::uint32_t node, const std::array<Below, 8>& below) {
    double least = 0.0;
    std::vector<std::pair<std::int32_t, std::uint32_t>> siblings;
    for (unsigned lane = 0; lane < width_; lane++) {
      const std::int32_t child = child_of(node, lane);
      if (child == -1) continue;
      const Vec3 d = below[lane].box.hi - below[lane].box.lo;
      const float worth = (d.x * d.y + (d.x + d.y) * d.z) / static_cast<float>(below[lane].count);
      wrong_worth_ += double{worth} < least * (1.0 - kWorthError) ? 1 : 0;
      least = std::max(least, double{worth});
      if (child >= 0) siblings.emplace_back(child, below[lane].count);
    }
    std::sort(siblings.begin(), siblings.end());
    for (std::size_t i = 1; i < siblings.size(); i++) {
      wrong_numbers_ += siblings[i].second > siblings[i - 1].second ? 1 : 0;
    }
  }

  // `leaf`: first block << 4 | blocks. All blocks but the last are full, and a leaf has no more than max_leaf.
  Below visit_leaf(std::uint32_t leaf) {
    const std::uint32_t first = leaf >> 4U, blocks = leaf & 15U;
    if (blocks == 0 || first + blocks > block_seen_.size()) {
      FAIL("a leaf of " << blocks << " blocks from " << first << " on, of " << block_seen_.size());
    }
    Below all;
    for (std::uint32_t block = first; block < first + blocks; block++) {
      if (block_seen_[block]) FAIL("block " << block << " is in two leaves");
      block_seen_[block] = true;
      for (unsigned lane = 0; lane < lanes_; lane++) {
        const std::uint32_t primitive = word(blocks_, row(block, HR_BLOCK_PRIMITIVE_ROW, lane));
        const bool must_be_used = block + 1 < first + blocks || lane == 0;
        if (primitive == HR_NO_PRIMITIVE) {
          wrong_lanes_ += !must_be_used && is_unused(block, lane) ? 0 : 1;
          continue;
        }
        if (primitive >= flat_.triangles.size() + flat_.spheres.size()) FAIL("a block has primitive " << primitive);
        wrong_lanes_ += is_true_lane(block, lane, primitive) ? 0 : 1;
        found_.push_back(primitive);
        const std::uint32_t place = places_.empty() ? 0 : places_[primitive];
        all.add({box_of(flat_, primitive), place, place, 1});
      }
    }
    CHECK(all.count <= std::min(options_.max_leaf, HR_MAX_LEAF_BLOCKS * lanes_));
    return all;
  }

  [[nodiscard]] static std::uint32_t word(const std::vector<float>& words, std::size_t i) {
    return std::bit_cast<std::uint32_t>(words[i]);
  }
  [[nodiscard]] std::size_t row(std::uint32_t block, unsigned row, unsigned lane) const {
    return (std::size_t{block} * HR_BLOCK_ROWS + row) * lanes_ + lane;
  }
  [[nodiscard]] std::int32_t child_of(std::uint32_t node, unsigned lane) const {
    return std::bit_cast<std::int32_t>(nodes_[(std::size_t{node} * 8 + HR_NODE_CHILD_ROW) * width_ + lane]);
  }
  [[nodiscard]] HostBox box_of_child(std::uint32_t node, unsigned lane) const {
    const float* p = &nodes_[std::size_t{node} * 8 * width_ + lane];
    return {{p[0], p[2 * width_], p[4 * width_]}, {p[width_], p[3 * width_], p[5 * width_]}};
  }
  [[nodiscard]] Vec3 point(std::uint32_t block, unsigned first_row, unsigned lane) const {
    return {blocks_[row(block, first_row, lane)], blocks_[row(block, first_row + 1, lane)],
            blocks_[row(block, first_row + 2, lane)]};
  }

  // An unused lane holds a point, which no ray meets.
  [[nodiscard]] bool is_unused(std::uint32_t block, unsigned lane) const {
    for (unsigned r = 0; r < HR_BLOCK_PRIMITIVE_ROW; r++) {
      if (!std::isnan(blocks_[row(block, r, lane)])) return false;
    }
    return true;
  }

  // Does the lane hold the geometry of the primitive it names?
  [[nodiscard]] bool is_true_lane(std::uint32_t block, unsigned lane, std::uint32_t primitive) const {
    if (primitive >= flat_.triangles.size()) {
      const shared::float4 s = flat_.spheres[primitive - flat_.triangles.size()].center_radius;
      return point(block, 0, lane) == Vec3(s.x, s.y, s.z) && blocks_[row(block, 3, lane)] == s.w;
    }
    const shared::uint4 t = flat_.triangles[primitive];
    const Vec3 a = vertex(flat_, t.x), b = vertex(flat_, t.y), c = vertex(flat_, t.z);
    if (accel_.config().watertight) {
      return point(block, 0, lane) == a && point(block, 3, lane) == b && point(block, 6, lane) == c;
    }
    return point(block, 0, lane) == a && point(block, 3, lane) == a - b && point(block, 6, lane) == c - a;
  }

  const FlatScene& flat_;
  const Accel& accel_;
  AccelOptions options_;
  unsigned width_, lanes_;
  std::vector<float> nodes_, blocks_;
  HostBox bounds_;
  std::vector<std::uint32_t> valid_, found_, places_;
  std::vector<bool> node_seen_, block_seen_;
  std::uint32_t stack_need_ = 0;
  std::size_t wrong_boxes_ = 0, wrong_lanes_ = 0, wrong_order_ = 0, wrong_worth_ = 0, wrong_numbers_ = 0;
};

}  // namespace hemiray::test

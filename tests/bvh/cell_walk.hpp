// Trees of cells for tests: which kinds there are, and a tree read back from the device as cells and lists.
#pragma once

#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/base/vec.hpp"
#include "host/bvh/accel.hpp"

namespace hemiray::test {

struct CellKind {
  const char* name;
  AccelOptions options;
};

inline AccelOptions cell_options(AccelKind kind, unsigned lanes, unsigned max_leaf, int vectors,
                                 TriangleTest triangle_test = TriangleTest::watertight) {
  AccelOptions options;
  options.kind = kind;
  options.triangle_test = triangle_test;
  options.leaf_lanes = lanes;
  options.max_leaf = max_leaf;
  options.explicit_vectors = vectors;
  return options;
}

/// Each kind with the profile's leaves, and one each of other lanes, sizes and forms.
inline const std::vector<CellKind>& cell_kinds() {
  static const std::vector<CellKind> kKinds = {
      {"octree", cell_options(AccelKind::octree, 8, 8, 1)},
      {"k-d tree", cell_options(AccelKind::kdtree, 8, 8, 1)},
      {"median k-d tree", cell_options(AccelKind::kdtree_median, 8, 8, 1)},
      {"octree, 4 lanes, leaves of 1", cell_options(AccelKind::octree, 4, 1, 1)},
      {"k-d tree, 2 lanes, leaves of 3, loops", cell_options(AccelKind::kdtree, 2, 3, 0)},
      {"median k-d tree, 1 lane, leaves of 1, loops", cell_options(AccelKind::kdtree_median, 1, 1, 0)},
  };
  return kKinds;
}

/// The tree read back: its cells, what cuts them and which primitives its leaves list.
class CellWalk {
 public:
  explicit CellWalk(const Accel& accel) : nodes_(accel.nodes().read()), blocks_(accel.blocks().read()) {
    for (int a = 0; a < 3; a++) {
      root_lo[a] = nodes_[static_cast<std::size_t>(a)];
      root_hi[a] = nodes_[static_cast<std::size_t>(a) + 3];
    }
    lanes_ = accel.config().leaf_lanes;
    octree_ = accel.config().kind == AccelKind::octree;
    visit(word(6), root_lo, root_hi, 0);
  }

  Vec3 root_lo{}, root_hi{};
  std::vector<std::pair<int, float>> planes;  // axis, coordinate
  std::size_t nodes = 0, references = 0, deepest = 0;
  struct Leaf {
    Vec3 lo, hi;
    std::vector<std::uint32_t> primitives;
  };
  std::vector<Leaf> leaves;  // without the empty ones

 private:
  [[nodiscard]] std::int32_t word(std::size_t i) const { return std::bit_cast<std::int32_t>(nodes_.at(i)); }

  void visit(std::int32_t reference, Vec3 lo, Vec3 hi, std::size_t depth) {
    if (reference == -1) return;
    if (reference < 0) return visit_leaf(static_cast<std::uint32_t>(~reference), lo, hi, depth);
    nodes++;
    REQUIRE(depth < 64);
    const std::size_t at = 8 + static_cast<std::size_t>(reference) * (octree_ ? 12 : 4);
    if (!octree_) {
      const int axis = word(at + 3);
      REQUIRE((axis >= 0 && axis < 3));
      const float plane = nodes_[at];
      REQUIRE((plane > lo[axis] && plane < hi[axis]));
      planes.emplace_back(axis, plane);
      Vec3 below = hi, above = lo;
      below[axis] = above[axis] = plane;
      visit(word(at + 1), lo, below, depth + 1);
      visit(word(at + 2), above, hi, depth + 1);
      return;
    }
    for (std::size_t octant = 0; octant < 8; octant++) {
      Vec3 part_lo = lo, part_hi = hi;
      for (int a = 0; a < 3; a++) {
        const float plane = std::clamp(nodes_[at + static_cast<std::size_t>(a)], lo[a], hi[a]);
        if (octant == 0 && plane > lo[a] && plane < hi[a]) planes.emplace_back(a, plane);
        (octant >> a & 1U ? part_lo : part_hi)[a] = plane;
      }
      visit(word(at + 4 + octant), part_lo, part_hi, depth + 1);
    }
  }

  void visit_leaf(std::uint32_t code, Vec3 lo, Vec3 hi, std::size_t depth) {
    deepest = std::max(deepest, depth);
    std::size_t first = code >> 4U, count = code & 15U;
    if (count == 15) {
      const std::size_t record = static_cast<std::uint32_t>(word(7)) + 2 * first;
      first = static_cast<std::uint32_t>(word(record));
      count = static_cast<std::uint32_t>(word(record + 1));
      REQUIRE(count >= 15);
    }
    REQUIRE(count > 0);
    Leaf leaf{lo, hi, {}};
    for (std::size_t i = 0; i < count * lanes_; i++) {
      const std::size_t block = (first + i / lanes_) * 10 * lanes_;
      const auto primitive = std::bit_cast<std::uint32_t>(blocks_.at(block + 9 * lanes_ + i % lanes_));
      if (primitive != HR_NO_PRIMITIVE) leaf.primitives.push_back(primitive);
    }
    REQUIRE(leaf.primitives.size() > (count - 1) * lanes_);
    references += leaf.primitives.size();
    leaves.push_back(std::move(leaf));
  }

  std::vector<float> nodes_, blocks_;
  std::size_t lanes_ = 1;
  bool octree_ = false;
};

}  // namespace hemiray::test

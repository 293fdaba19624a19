#include "host/bench/tree_facts.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <vector>

#include "host/base/vec.hpp"
#include "shared/bvh_types.h"

namespace hemiray::bench {
namespace {

struct Bounds {
  DVec3 lo, hi;
  [[nodiscard]] bool empty() const { return !(lo.x <= hi.x); }
  [[nodiscard]] double half_area() const {
    const DVec3 size = hi - lo;
    return size.x * size.y + size.y * size.z + size.z * size.x;
  }
};

// The nodes' words by what they mean.
class Nodes {
 public:
  Nodes(std::span<const float> words, unsigned width) : words_(words), width_(width) {}

  [[nodiscard]] std::size_t size() const { return words_.size() / HR_NODE_WORDS(width_); }
  [[nodiscard]] Bounds bounds(std::size_t node, unsigned lane) const {
    const auto row = [&](unsigned r) { return static_cast<double>(word(node, r, lane)); };
    return {{row(0), row(2), row(4)}, {row(1), row(3), row(5)}};
  }
  [[nodiscard]] std::int32_t child(std::size_t node, unsigned lane) const {
    return std::bit_cast<std::int32_t>(word(node, HR_NODE_CHILD_ROW, lane));
  }

 private:
  [[nodiscard]] float word(std::size_t node, unsigned row, unsigned lane) const {
    return words_[node * HR_NODE_WORDS(width_) + row * width_ + lane];
  }
  std::span<const float> words_;
  unsigned width_;
};

}  // namespace

TreeFacts tree_facts(std::span<const float> nodes, unsigned width, std::uint64_t primitives, std::uint64_t blocks,
                     unsigned lanes) {
  const Nodes tree(nodes, width);
  TreeFacts facts;
  facts.blocks = blocks;
  facts.bytes = nodes.size_bytes() + blocks * HR_BLOCK_ROWS * lanes * sizeof(float);
  if (blocks > 0) facts.block_fill = static_cast<double>(primitives) / static_cast<double>(blocks * lanes);
  if (tree.size() == 0) return facts;

  struct Visit {
    std::size_t node;
    int depth;
  };
  std::vector<Visit> open{{0, 1}};
  std::uint64_t used = 0;
  double area_sum = 0.0;
  Bounds root{DVec3(1e300), DVec3(-1e300)};
  while (!open.empty()) {
    const Visit visit = open.back();
    open.pop_back();
    if (++facts.nodes > tree.size()) throw std::logic_error("a tree whose nodes are met more than once");
    facts.depth = std::max(facts.depth, visit.depth);
    for (unsigned lane = 0; lane < width; lane++) {
      const Bounds box = tree.bounds(visit.node, lane);
      if (box.empty()) continue;
      used++;
      if (visit.node == 0) root = {glm::min(root.lo, box.lo), glm::max(root.hi, box.hi)};
      const std::int32_t child = tree.child(visit.node, lane);
      // A node costs 1; so does each block of a leaf.
      area_sum += box.half_area() * (child >= 0 ? 1.0 : static_cast<double>(~child & HR_MAX_LEAF_BLOCKS));
      if (child < 0) continue;
      if (static_cast<std::size_t>(child) >= tree.size()) throw std::logic_error("a child that is not there");
      open.push_back({static_cast<std::size_t>(child), visit.depth + 1});
    }
  }
  facts.node_fill = static_cast<double>(used) / static_cast<double>(facts.nodes * width);
  if (!root.empty() && root.half_area() > 0.0) facts.sah_cost = 1.0 + area_sum / root.half_area();
  return facts;
}

}  // namespace hemiray::bench

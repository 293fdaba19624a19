// The figures of a tree, on two trees small enough to work them out by hand.
#include <bit>
#include <catch2/catch.hpp>
#include <limits>
#include <vector>

#include "host/bench/tree_facts.hpp"
#include "shared/bvh_types.h"

namespace hemiray {
namespace {

// Nodes of two children.
class Nodes {
 public:
  explicit Nodes(std::size_t count) : words(count * HR_NODE_WORDS(2), 0.0F) {
    for (std::size_t node = 0; node < count; node++) {
      for (unsigned lane = 0; lane < 2; lane++) set(node, lane, kInf, -kInf, 0);
    }
  }
  /// A box from lo to hi on every axis.
  void set(std::size_t node, unsigned lane, float lo, float hi, std::int32_t child) {
    float* first = &words[node * HR_NODE_WORDS(2)];
    for (unsigned axis = 0; axis < 3; axis++) {
      first[4 * axis + lane] = lo;
      first[4 * axis + 2 + lane] = hi;
    }
    first[HR_NODE_CHILD_ROW * 2 + lane] = std::bit_cast<float>(child);
  }
  static constexpr float kInf = std::numeric_limits<float>::infinity();
  std::vector<float> words;
};

std::int32_t leaf(std::int32_t first_block, std::int32_t blocks) { return ~(first_block * 16 + blocks); }

}  // namespace

TEST_CASE("a tree's figures are those worked out by hand") {
  Nodes nodes(2);
  nodes.set(0, 0, 0.0F, 4.0F, 1);           // a node of the root's own box
  nodes.set(0, 1, 0.0F, 2.0F, leaf(0, 3));  // a quarter of its area, three blocks
  nodes.set(1, 0, 2.0F, 4.0F, leaf(3, 1));  // a quarter, one block; the other lane is empty
  const bench::TreeFacts facts = bench::tree_facts(nodes.words, 2, 12, 4, 4);
  CHECK(facts.sah_cost == Approx(1.0 + 1.0 + 3 * 0.25 + 0.25));
  CHECK(facts.depth == 2);
  CHECK(facts.nodes == 2);
  CHECK(facts.blocks == 4);
  CHECK(facts.node_fill == Approx(0.75));
  CHECK(facts.block_fill == Approx(0.75));
  CHECK(facts.bytes == 2 * 16 * 4 + 4 * 4 * 40);
}

TEST_CASE("trees that are none are refused, and no tree has no figures") {
  Nodes cycle(1);
  cycle.set(0, 0, 0.0F, 1.0F, 0);
  CHECK_THROWS_AS(bench::tree_facts(cycle.words, 2, 1, 1, 4), std::logic_error);
  Nodes outside(1);
  outside.set(0, 1, 0.0F, 1.0F, 1);
  CHECK_THROWS_AS(bench::tree_facts(outside.words, 2, 1, 1, 4), std::logic_error);
  CHECK(bench::tree_facts({}, 8, 0, 0, 8).sah_cost == 0.0);
  CHECK(bench::tree_facts(Nodes(1).words, 2, 0, 0, 8).sah_cost == 0.0);
}

}  // namespace hemiray

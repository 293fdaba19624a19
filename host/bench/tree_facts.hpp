// How good a tree is: what a benchmark says about it beside its times.
#pragma once

#include <cstdint>
#include <span>

namespace hemiray::bench {

/// What does not apply is 0.
struct TreeFacts {
  double sah_cost = 0.0;    ///< nodes visited and leaf blocks tested by a random ray through the root's box
  int depth = 0;            ///< nodes on the longest way from the root to a leaf
  double node_fill = 0.0;   ///< used share of the nodes' child slots, [0, 1]
  double block_fill = 0.0;  ///< used share of the leaf blocks' lanes, [0, 1]
  double references = 1.0;  ///< times that a primitive is listed in leaves
  std::uint64_t nodes = 0;
  std::uint64_t blocks = 0;
  std::uint64_t bytes = 0;  ///< of nodes and blocks
};

/// Of a tree as kernels/shared/bvh_types.h lays it out: `nodes` are 8 `width` words each, the root first; `primitives`
/// lie in `blocks` blocks of `lanes`. Throws std::logic_error if a child lies outside, or before its parent's end of
/// the walk (a cycle). The block's bytes are 40 a lane.
TreeFacts tree_facts(std::span<const float> nodes, unsigned width, std::uint64_t primitives, std::uint64_t blocks,
                     unsigned lanes);

}  // namespace hemiray::bench

// How large the parts of a build are, and how much device memory a tree takes, before it is built.
#pragma once

#include <algorithm>
#include <cstdint>

#include "host/bvh/accel_config.hpp"
#include "host/scene/flat_scene.hpp"

namespace hemiray {

inline constexpr std::uint32_t kSmallChunk = 256;  ///< primitives that are not worth a work-item of their own
inline constexpr std::uint32_t kSweepDepth = 130;  ///< HR_SWEEP_DEPTH of bvh/arena.h

/// What the kernels of bvh/arena.h work in. None shrinks where `count` grows.
struct BinaryTreeSizes {
  std::uint32_t groups = 1;           ///< chunks of the sorted primitives
  std::uint32_t limit = 1, keep = 1;  ///< clusters a range holds before, and after, neighbours are merged
  std::uint32_t arena_capacity = 0;   ///< clusters of a chunk
  std::uint32_t join_capacity = 0;    ///< clusters that all chunks together may leave
  std::size_t arena_words = 0;        ///< floats of all chunks' arenas
  std::size_t join_arena_words = 0;
  std::uint32_t top_nodes = 0;  ///< of a quality tree that move to where they cost less; 0: the tree is too small
  std::uint32_t top_first = 0;  ///< the slots of the binary tree that they come back to
  std::uint32_t nodes = 1;      ///< its slots: first those of the chunks, then of the join, then of the top
};

/// For a tree of `count` primitives.
BinaryTreeSizes binary_tree_sizes(std::uint32_t count, TreeBuilder builder, const DeviceProfile& profile);

struct AccelMemory {
  std::uint64_t tree = 0;     ///< bytes of nodes, blocks and regions, which stay
  std::uint64_t peak = 0;     ///< most bytes at any time of the build, the tree included
  std::uint64_t scratch = 0;  ///< what a builder that keeps its working memory holds beside the tree
};

/// For `primitives` triangles, spheres and shapes as they usually lie: how full the blocks get depends on the scene, so
/// the tree is an estimate; what the build works in is known. A tree of cells is an estimate altogether.
AccelMemory predict_accel_bytes(std::uint64_t primitives, const AccelOptions& options, const DeviceProfile& profile);

/// The peak of a build whose builder keeps its working memory, and holds so much of it before: `held` bytes.
inline std::uint64_t peak_with_kept_scratch(const AccelMemory& memory, std::uint64_t held) {
  return std::max(memory.peak, memory.tree + memory.scratch) + (std::max(held, memory.scratch) - memory.scratch);
}

/// For a scene: its own tree, one for each shared mesh, and the one over its instances. While the trees are put
/// together their nodes, and after them their blocks, are there twice.
AccelMemory predict_accel_bytes(const FlatScene& flat, const AccelOptions& options, const DeviceProfile& profile);

}  // namespace hemiray

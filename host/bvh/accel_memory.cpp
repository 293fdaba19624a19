#include "host/bvh/accel_memory.hpp"

#include <algorithm>
#include <cmath>

#include "host/gpu/parallel.hpp"
#include "shared/bvh_types.h"

namespace hemiray {
namespace {

// Of usual scenes: the share of a leaf's lanes in use, and of a node's children (measured,
// tests/bvh/test_accel_memory.cpp).
constexpr double kLeafFill = 0.7;
constexpr double kNodeFill = 0.97;
// kernels/bvh/arena.h
constexpr std::uint32_t kArenaRows = 9, kArenaGuard = 32;

// Smaller trees are built in less time than it takes to compile what moves nodes. In larger ones moving them added 27 %
// to the build at 250k triangles and 12 % at 1M.
constexpr std::uint32_t kFewestWithTop = 4096, kPrimitivesPerTopNode = 32;

std::size_t arena_words(std::uint32_t capacity) { return std::size_t{kArenaRows} * (capacity + 2 * kArenaGuard); }

// A tree of cells lists a primitive of a usual mesh in several leaves: a primitive, for leaves of 8 (measured from 20
// thousand triangles to a million, tests/bvh/test_accel_memory.cpp; a soup of tiny triangles takes half as much).
struct CellShape {
  double references, leaves, nodes;
  std::uint64_t node_bytes;
};

CellShape cell_shape(AccelKind kind) {
  switch (kind) {
    case AccelKind::octree:
      return {4.4, 0.85, 0.185, 48};
    case AccelKind::kdtree:
      return {3.0, 0.43, 0.39, 16};
    default:
      return {3.5, 0.50, 0.29, 16};
  }
}

AccelMemory predict_cell_bytes(std::uint64_t primitives, const AccelOptions& options, const DeviceProfile& profile) {
  const CellShape shape = cell_shape(options.kind);
  const double count = static_cast<double>(primitives), coarser = 8.0 / options.max_leaf;
  const double leaves = shape.leaves * coarser * count, nodes = shape.nodes * coarser * count;
  const double references = shape.references * count;
  const double blocks_a_leaf = std::max(1.0, references / leaves / options.leaf_lanes);
  const double block_bytes = 40.0 * options.leaf_lanes, node_bytes = static_cast<double>(shape.node_bytes);
  const double tree = nodes * node_bytes + leaves * blocks_a_leaf * block_bytes;
  // Before they come to their place: nodes, leaves' descriptions and references, beside sorted keys and boxes.
  const double sorted = count * (sizeof(shared::Box) + 2 * sizeof(std::uint64_t));
  const double drafts = nodes * node_bytes + leaves * sizeof(shared::uint4) + references * sizeof(std::uint32_t);
  AccelMemory memory;
  memory.tree = sort_bytes(profile) + static_cast<std::uint64_t>(tree);
  memory.peak = memory.tree + static_cast<std::uint64_t>(sorted + drafts);
  memory.scratch = static_cast<std::uint64_t>(sorted);
  return memory;
}

AccelMemory predict_tree(std::uint64_t primitives, bool has_blocks, const AccelOptions& given,
                         const DeviceProfile& profile) {
  const AccelOptions options = complete_options(given, profile);
  const std::uint64_t count = std::max<std::uint64_t>(primitives, 1);
  if (options.kind != AccelKind::bvh) return predict_cell_bytes(count, options, profile);
  const BinaryTreeSizes sizes = binary_tree_sizes(static_cast<std::uint32_t>(count), options.builder, profile);
  const std::uint64_t node_bytes = 32 * std::uint64_t{options.width};
  const std::uint64_t block_bytes = has_blocks ? 40 * std::uint64_t{options.leaf_lanes} : 0;
  const std::uint64_t target = std::clamp<std::uint64_t>(count / kSmallChunk, 2, profile.collapse_regions);
  // Leaves of several blocks are few.
  const double leaf_primitives = std::max(1.0, kLeafFill * std::min(options.max_leaf, options.leaf_lanes));
  const auto leaves = static_cast<std::uint64_t>(std::ceil(static_cast<double>(count) / leaf_primitives));
  const auto nodes =
      static_cast<std::uint64_t>(std::ceil(static_cast<double>(leaves) / (kNodeFill * options.width - 1.0)) + 1.0);
  const std::uint64_t kept = sort_bytes(profile) +
                             sizes.groups * (kSweepDepth * 2 + 3) * std::uint64_t{sizeof(std::uint32_t)}
                             // pending and node ranges
                             + target * node_bytes;  // the top's draft
  const std::uint64_t regions = (target + options.width + 1) * sizeof(shared::CollapseRegion);
  const std::uint64_t arenas = sizeof(float) * (sizes.arena_words + sizes.join_arena_words);
  const std::uint64_t boxes = sizeof(shared::Box) * std::uint64_t{sizes.nodes};
  const std::uint64_t keys = sizeof(std::uint64_t) * std::max<std::uint64_t>(count, sizes.nodes / 2 + 1);
  const std::uint64_t binary = sizeof(shared::BinaryNode) * std::uint64_t{sizes.nodes};
  const std::uint64_t top =
      sizes.top_nodes > 0 ? (2 * sizes.top_nodes + 1) * std::uint64_t{sizeof(shared::TopNode)} : 0;
  AccelMemory memory;
  memory.tree = kept + nodes * node_bytes + leaves * block_bytes + regions;
  const std::uint64_t partials = sizeof(shared::BoundsPartial) * std::uint64_t{profile.chunks};
  memory.peak = std::max({sort_bytes(profile) + boxes + partials, kept + boxes + 2 * keys + binary + arenas,
                          binary + top + keys + memory.tree});
  memory.scratch = boxes + 2 * keys + binary + arenas + top;
  return memory;
}

}  // namespace

BinaryTreeSizes binary_tree_sizes(std::uint32_t count, TreeBuilder builder, const DeviceProfile& profile) {
  BinaryTreeSizes sizes;
  sizes.groups = std::clamp(count / kSmallChunk, 1U, profile.cluster_chunks);
  if (builder == TreeBuilder::quality) {
    sizes.limit = profile.cluster_limit;
    sizes.keep = profile.cluster_keep;
  }
  sizes.arena_capacity = (kSweepDepth + 1) * sizes.limit;
  sizes.join_capacity = static_cast<std::uint32_t>(
      std::min<std::uint64_t>(std::uint64_t{sizes.groups} * kSweepDepth * sizes.limit, count));
  sizes.arena_words = sizes.groups * arena_words(sizes.arena_capacity);
  sizes.join_arena_words = arena_words(sizes.join_capacity);
  if (builder == TreeBuilder::quality && count >= kFewestWithTop) {
    sizes.top_nodes = std::min(profile.top_nodes, count / kPrimitivesPerTopNode);
  }
  sizes.top_first = std::max(count + sizes.join_capacity, 1U);
  sizes.nodes = sizes.top_first + sizes.top_nodes;
  return sizes;
}

AccelMemory predict_accel_bytes(std::uint64_t primitives, const AccelOptions& options, const DeviceProfile& profile) {
  return predict_tree(primitives, true, options, profile);
}

AccelMemory predict_accel_bytes(const FlatScene& flat, const AccelOptions& options, const DeviceProfile& profile) {
  const std::uint64_t world = flat.world_triangles() + flat.spheres.size() + flat.shapes.size();
  AccelMemory all = predict_accel_bytes(world, options, profile);
  if (flat.instances.empty()) return all;
  // The sort's digit counts are kept once for all trees.
  const std::uint64_t counts = sort_bytes(profile);
  if (world == 0) all = {counts, counts, 0};
  const auto add = [&](const AccelMemory& part) {
    all.peak = std::max(all.peak, all.tree + part.peak - counts);
    all.tree += part.tree - counts;
    all.scratch = std::max(all.scratch, part.scratch);
  };
  for (const SharedMesh& mesh : flat.shared_meshes) add(predict_accel_bytes(mesh.triangle_count, options, profile));
  AccelOptions single = options;
  single.max_leaf = 1;
  add(predict_tree(flat.instances.size(), false, single, profile));
  all.tree += flat.shared_meshes.size() * sizeof(shared::Box);
  all.peak = std::max(all.peak, 2 * all.tree);
  return all;
}

}  // namespace hemiray

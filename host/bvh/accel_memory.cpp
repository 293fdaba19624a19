#include "host/bvh/accel_memory.hpp"

#include <algorithm>
#include <cmath>

#include "host/gpu/parallel.hpp"
#include "shared/bvh_types.h"

namespace hemiray {
namespace {

// Of usual scenes: the share of a leaf's lanes in use, and of a node's children (measured, tests/bvh/test_accel.cpp).
constexpr double kLeafFill = 0.66;
constexpr double kNodeFill = 0.97;
// kernels/bvh/arena.h
constexpr std::uint64_t kSweepDepth = 130, kArenaRows = 9, kArenaPad = 64;

AccelMemory predict_tree(std::uint64_t primitives, bool has_blocks, const AccelOptions& given,
                         const DeviceProfile& profile) {
  const AccelOptions options = complete_options(given, profile);
  const std::uint64_t count = std::max<std::uint64_t>(primitives, 1);
  const std::uint64_t node_bytes = 32 * std::uint64_t{options.width};
  const std::uint64_t block_bytes = has_blocks ? 40 * std::uint64_t{options.leaf_lanes} : 0;
  const std::uint64_t regions = std::clamp<std::uint64_t>(count / 256, 2, profile.collapse_regions) + options.width + 1;
  const double leaf_primitives = std::max(1.0, kLeafFill * options.max_leaf);
  const auto leaves = static_cast<std::uint64_t>(std::ceil(static_cast<double>(count) / leaf_primitives));
  const std::uint64_t blocks_a_leaf = (options.max_leaf + options.leaf_lanes - 1) / options.leaf_lanes;
  const auto nodes =
      static_cast<std::uint64_t>(std::ceil(static_cast<double>(leaves) / (kNodeFill * options.width - 1.0)) + 1.0);
  const std::uint64_t draft = ((count - 1) / std::min(options.width - 1, options.max_leaf) + regions + 1) * node_bytes;
  const std::uint64_t groups = std::clamp<std::uint64_t>(count / 256, 1, profile.cluster_chunks);
  const std::uint64_t limit = options.builder == TreeBuilder::quality ? profile.cluster_limit : 1;
  const std::uint64_t joined = std::min(groups * kSweepDepth * limit, count);
  const std::uint64_t kept =
      sort_bytes(profile) + groups * (kSweepDepth * 2 + 1) * sizeof(std::uint32_t);  // and the pending ranges
  const std::uint64_t arenas =
      kArenaRows * sizeof(float) * (groups * ((kSweepDepth + 1) * limit + kArenaPad) + joined + kArenaPad);
  AccelMemory memory;
  memory.tree =
      kept + nodes * node_bytes + leaves * blocks_a_leaf * block_bytes + regions * sizeof(shared::CollapseRegion);
  const std::uint64_t leaf_order = 3 * sizeof(std::uint32_t) * count;
  const std::uint64_t binary = sizeof(shared::BinaryNode) * (count + joined);
  const std::uint64_t sorting = count * (sizeof(shared::Box) + 2 * sizeof(std::uint64_t));
  memory.peak = std::max(
      {kept + sorting + binary + arenas, kept + binary + draft + leaf_order, draft + leaf_order + memory.tree});
  return memory;
}

}  // namespace

AccelMemory predict_accel_bytes(std::uint64_t primitives, const AccelOptions& options, const DeviceProfile& profile) {
  return predict_tree(primitives, true, options, profile);
}

AccelMemory predict_accel_bytes(const FlatScene& flat, const AccelOptions& options, const DeviceProfile& profile) {
  const std::uint64_t world = flat.world_triangles() + flat.spheres.size();
  AccelMemory all = predict_accel_bytes(world, options, profile);
  if (flat.instances.empty()) return all;
  // The sort's digit counts are kept once for all trees.
  const std::uint64_t counts = sort_bytes(profile);
  if (world == 0) all = {counts, counts};
  const auto add = [&](const AccelMemory& part) {
    all.peak = std::max(all.peak, all.tree + part.peak - counts);
    all.tree += part.tree - counts;
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

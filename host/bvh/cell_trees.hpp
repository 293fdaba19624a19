// Trees of cells - octree, k-d tree, median k-d tree - from primitives sorted along the Morton order, by kernels.
#pragma once

#include <cstdint>

#include "host/bvh/accel_config.hpp"
#include "host/gpu/buffer.hpp"
#include "host/gpu/parallel.hpp"
#include "host/gpu/program.hpp"
#include "host/scene/device_scene.hpp"
#include "shared/bvh_types.h"

namespace hemiray {

/// What is built from, all on the device but for the numbers.
struct CellTreeInput {
  const DeviceScene& scene;
  const Buffer<shared::Box>& boxes;     ///< of the primitives [m]
  const Buffer<std::uint64_t>& keys;    ///< sorted: Morton code above the primitive
  std::uint32_t count;                  ///< keys, at least one
  unsigned index_bits, axis_bits;       ///< of a key: the primitive's; the code's along each axis
  shared::float4 lo, hi;                ///< bounds of the boxes [m]
  shared::float4 centre_lo, centre_hi;  ///< bounds of the boxes' centres, the lattice's cube along its longest side [m]
  unsigned max_leaf;                    ///< references that a leaf should have at most
};

/// The tree in the layout of kernels/lib/cell_layout.h.
struct CellTree {
  Buffer<float> nodes, blocks;
  std::uint32_t node_count = 0, block_count = 0;
  std::uint32_t references = 0;  ///< in leaves
  std::uint32_t depth = 0;       ///< cuts above the deepest leaf
};

/// Builds level by level. A cell is cut while more than max_leaf / 4 box centres lie in it and the surface area
/// heuristic, for leaves of max_leaf references, says that it pays. Where references would outgrow the primitives too
/// far, only cuts that add none are made; none is ever dropped. Deterministic. `program`: cell_tree_kernels() compiled
/// for `config`.
CellTree build_cell_tree(Context& context, Parallel& parallel, Program& program, const AccelConfig& config,
                         const CellTreeInput& input);

/// A tree without primitives.
CellTree empty_cell_tree(Context& context, const AccelConfig& config);

}  // namespace hemiray

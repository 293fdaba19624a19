// The sides whose factors are computed pair by pair, as a table on the device.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/gpu/buffer.hpp"
#include "host/radiosity/patch_mesh.hpp"
#include "shared/pair_types.h"

namespace hemiray {

/// Sides by number; kernels/shared/pair_types.h lays out the table.
struct PairSides {
  /// `sides`: each once; numbered in this order, which columns of rows have, too.
  PairSides(Context& context, const PatchMesh& mesh, std::span<const std::uint32_t> sides)
      : PairSides(context, mesh, sides, static_cast<std::uint32_t>(sides.size()),
                  static_cast<std::uint32_t>(sides.size())) {}
  /// Rows are wanted of the first `rows` only. `traced` <= sides, no fewer: these and their neighbours.
  PairSides(Context& context, const PatchMesh& mesh, std::span<const std::uint32_t> sides, std::uint32_t rows,
            std::uint32_t traced);

  std::uint32_t count = 0, stride = 0;  ///< stride: count, padded
  std::uint32_t rows = 0, traced = 0;
  float flatness = 0.0F;           ///< how far rounding moves a vertex [m]
  std::vector<std::uint32_t> ids;  ///< sides by number
  Buffer<float> table;
  Buffer<shared::float4> corners;         ///< three a side, counter-clockwise seen from its front [m]
  Buffer<std::uint32_t> blockers;         ///< of the numbers: what their own rays do not meet, of PatchMesh::blockers
  Buffer<std::uint32_t> neighbours;       ///< three a number: numbers of those that share an edge, or HR_NO_SIDE
  Buffer<std::uint32_t> active;           ///< of the mesh's sides: number, or HR_NO_SIDE
  Buffer<std::uint32_t> sides_by_number;  ///< ids, padded with HR_NO_SIDE
};

}  // namespace hemiray

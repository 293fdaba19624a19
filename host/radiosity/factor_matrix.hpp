// Form factors on the device: sparse rows, in blocks that the device can allocate.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "host/gpu/buffer.hpp"
#include "host/gpu/program.hpp"

namespace hemiray {

/// Some rows: rows[k] has columns and values [starts[k], starts[k + 1]), columns ascending.
struct FactorBlock {
  std::uint32_t row_count = 0;
  std::uint32_t entries = 0;
  Buffer<std::uint32_t> rows;  ///< sides
  Buffer<std::uint32_t> starts;
  Buffer<std::uint32_t> columns;  ///< sides
  Buffer<float> values;           ///< F_ij
};

/// F over the sides of a mesh. A side in no block has an empty row: no light comes to where it could be seen.
struct FactorMatrix {
  std::uint32_t side_count = 0;
  std::vector<FactorBlock> blocks;

  [[nodiscard]] std::uint64_t rows() const;
  [[nodiscard]] std::uint64_t entries() const;
  [[nodiscard]] std::uint64_t bytes() const;
};

/// A row as the host reads it.
using FactorRow = std::vector<std::pair<std::uint32_t, float>>;

/// A block as the host reads it: rows of these sides.
struct SideRows {
  std::vector<std::uint32_t> sides;
  std::vector<FactorRow> rows;
};

SideRows read_rows(const FactorBlock& block);
FactorBlock make_block(Context& context, const SideRows& rows);

/// All rows by side; for tests and exports.
std::vector<FactorRow> read_rows(const FactorMatrix& matrix);

}  // namespace hemiray

// Form factors on the device: sparse rows, in blocks that the device can allocate.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "host/gpu/buffer.hpp"
#include "host/gpu/program.hpp"
#include "kernels/shared/scalar.h"

namespace hemiray {

/// half: 11 significant bits instead of 24, 6 bytes an entry instead of 8.
enum class FactorPrecision : std::uint32_t { single, half };
const char* to_string(FactorPrecision precision);

/// Some rows: rows[k] has columns and values [starts[k], starts[k + 1]), columns ascending.
struct FactorBlock {
  std::uint32_t row_count = 0;
  std::uint32_t entries = 0;
  Buffer<std::uint32_t> rows;  ///< sides
  Buffer<std::uint32_t> starts;
  Buffer<std::uint32_t> columns;  ///< sides
  Buffer<float> values;           ///< F_ij; none where they are rounded (host/radiosity/factor_rounding.hpp)
  Buffer<std::uint16_t> halves;   ///< or F_ij = halves[] row_scales[k]
  Buffer<float> row_scales;
  /// Of rounded rows, d = rounded F_ij - F_ij: x largest |d| / F_ij, y the sum of these, z of |d|, w of d.
  std::vector<shared::float4> changes;

  [[nodiscard]] bool is_rounded() const { return row_scales.size() > 0; }
};

/// F over the sides of a mesh. A side in no block has an empty row: no light comes to where it could be seen.
struct FactorMatrix {
  std::uint32_t side_count = 0;
  std::vector<FactorBlock> blocks;  ///< of one precision

  [[nodiscard]] FactorPrecision precision() const;
  [[nodiscard]] std::uint64_t rows() const;
  [[nodiscard]] std::uint64_t entries() const;
  [[nodiscard]] std::uint64_t bytes() const;
};

/// What kernels that read factors (radiosity/factors.h) are compiled with, and what they take: rows, starts, columns
/// and values; or values alone, under another name.
std::string factor_defines(FactorPrecision precision);
Arguments row_arguments(const FactorBlock& block);
Arguments value_arguments(const FactorBlock& block, const std::string& name);

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

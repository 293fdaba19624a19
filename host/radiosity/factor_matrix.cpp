#include "host/radiosity/factor_matrix.hpp"

namespace hemiray {

std::uint64_t FactorMatrix::rows() const {
  std::uint64_t sum = 0;
  for (const FactorBlock& block : blocks) sum += block.row_count;
  return sum;
}

std::uint64_t FactorMatrix::entries() const {
  std::uint64_t sum = 0;
  for (const FactorBlock& block : blocks) sum += block.entries;
  return sum;
}

std::uint64_t FactorMatrix::bytes() const {
  std::uint64_t sum = 0;
  for (const FactorBlock& block : blocks) {
    sum += block.rows.bytes() + block.starts.bytes() + block.columns.bytes() + block.values.bytes();
  }
  return sum;
}

std::vector<FactorRow> read_rows(const FactorMatrix& matrix) {
  std::vector<FactorRow> all(matrix.side_count);
  for (const FactorBlock& block : matrix.blocks) {
    const std::vector<std::uint32_t> rows = block.rows.read(), starts = block.starts.read(),
                                     columns = block.columns.read();
    const std::vector<float> values = block.values.read();
    for (std::uint32_t k = 0; k < block.row_count; k++) {
      FactorRow& row = all[rows[k]];
      for (std::uint32_t i = starts[k]; i < starts[k + 1]; i++) row.emplace_back(columns[i], values[i]);
    }
  }
  return all;
}

}  // namespace hemiray

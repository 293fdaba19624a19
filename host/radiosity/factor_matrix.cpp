#include "host/radiosity/factor_matrix.hpp"

#include <span>
#include <utility>

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

SideRows read_rows(const FactorBlock& block) {
  SideRows result{block.rows.read(), {}};
  const std::vector<std::uint32_t> starts = block.starts.read(), columns = block.columns.read();
  const std::vector<float> values = block.values.read();
  for (std::uint32_t k = 0; k < block.row_count; k++) {
    FactorRow& row = result.rows.emplace_back();
    for (std::uint32_t i = starts[k]; i < starts[k + 1]; i++) row.emplace_back(columns[i], values[i]);
  }
  return result;
}

FactorBlock make_block(Context& context, const SideRows& from) {
  std::vector<std::uint32_t> starts{0}, columns;
  std::vector<float> values;
  for (const FactorRow& row : from.rows) {
    for (const auto& [column, value] : row) {
      columns.push_back(column);
      values.push_back(value);
    }
    starts.push_back(static_cast<std::uint32_t>(columns.size()));
  }
  FactorBlock block;
  block.row_count = static_cast<std::uint32_t>(from.sides.size());
  block.entries = starts.back();
  block.rows = {context, "factor rows", std::span(from.sides)};
  block.starts = {context, "factor starts", std::span(std::as_const(starts))};
  block.columns = {context, "factor columns", std::span(std::as_const(columns))};
  block.values = {context, "factor values", std::span(std::as_const(values))};
  return block;
}

std::vector<FactorRow> read_rows(const FactorMatrix& matrix) {
  std::vector<FactorRow> all(matrix.side_count);
  for (const FactorBlock& block : matrix.blocks) {
    SideRows some = read_rows(block);
    for (std::size_t k = 0; k < some.sides.size(); k++) {
      FactorRow& row = all[some.sides[k]];
      row.insert(row.end(), some.rows[k].begin(), some.rows[k].end());
    }
  }
  return all;
}

}  // namespace hemiray

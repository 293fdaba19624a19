#include "host/radiosity/factor_matrix.hpp"

#include <cmath>
#include <span>
#include <utility>

namespace hemiray {
namespace {

// Of a number that is not negative.
float value_of_half(std::uint16_t bits) {
  const int exponent = bits >> 10U, mantissa = bits & 1023;
  return exponent == 0 ? std::ldexp(static_cast<float>(mantissa), -24)
                       : std::ldexp(static_cast<float>(mantissa + 1024), exponent - 25);
}

std::vector<float> read_values(const FactorBlock& block) {
  if (!block.is_rounded()) return block.values.read();
  const std::vector<std::uint32_t> starts = block.starts.read();
  const std::vector<std::uint16_t> halves = block.halves.read();
  const std::vector<float> scales = block.row_scales.read();
  std::vector<float> values(halves.size());
  for (std::uint32_t k = 0; k < block.row_count; k++) {
    for (std::uint32_t e = starts[k]; e < starts[k + 1]; e++) values[e] = value_of_half(halves[e]) * scales[k];
  }
  return values;
}

}  // namespace

const char* to_string(FactorPrecision precision) { return precision == FactorPrecision::half ? "half" : "single"; }

FactorPrecision FactorMatrix::precision() const {
  return !blocks.empty() && blocks.front().is_rounded() ? FactorPrecision::half : FactorPrecision::single;
}

std::string factor_defines(FactorPrecision precision) {
  return precision == FactorPrecision::half ? "-DHR_HALF_FACTORS=1" : "";
}

Arguments value_arguments(const FactorBlock& block, const std::string& name) {
  if (!block.is_rounded()) return {arg(name.c_str(), block.values)};
  return {arg(name.c_str(), block.halves), arg((name + "_scales").c_str(), block.row_scales)};
}

Arguments row_arguments(const FactorBlock& block) {
  return arguments(arg("rows", block.rows), arg("starts", block.starts), arg("columns", block.columns),
                   value_arguments(block, "values"));
}

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
    sum += block.rows.bytes() + block.starts.bytes() + block.columns.bytes() + block.values.bytes() +
           block.halves.bytes() + block.row_scales.bytes();
  }
  return sum;
}

SideRows read_rows(const FactorBlock& block) {
  SideRows result{block.rows.read(), {}};
  const std::vector<std::uint32_t> starts = block.starts.read(), columns = block.columns.read();
  const std::vector<float> values = read_values(block);
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

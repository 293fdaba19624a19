#include "host/radiosity/factor_rounding.hpp"

#include <algorithm>
#include <cmath>

#include "host/radiosity/factor_memory.hpp"

namespace hemiray {
namespace {

constexpr double kSumsRounded = 1.0 + 0x1p-20;  // sums of changes come in single precision

ProgramOptions widest(const Context& context) {
  ProgramOptions options;
  options.double_precision = context.device().has_fp64;
  return options;
}

}  // namespace

FactorRounder::FactorRounder(Context& context, const PatchMesh& mesh)
    : context_(&context),
      program_(context, "round factors", {"radiosity/round_factors.cl"}, widest(context)),
      normals_(context, "patch normals", std::span(mesh.normals)) {}

void FactorRounder::round(FactorBlock& block, bool exchange) {
  block.halves = Buffer<std::uint16_t>(*context_, "factor values", block.entries);
  block.row_scales = Buffer<float>(*context_, "factor scales", block.row_count);
  const Buffer<shared::float4> changes(*context_, "changes of rows", block.row_count);
  const std::uint32_t is_exchange = exchange ? 1 : 0;
  launch(*context_, program_.kernel("radiosity_round_row"), block.row_count,
         arguments(arg("rows", block.rows), arg("starts", block.starts), arg("values", block.values),
                   arg("row_count", block.row_count), arg("normals", normals_), arg("exchange", is_exchange),
                   arg("halves", block.halves), arg("scales", block.row_scales), arg("changes", changes)));
  block.changes = changes.read();
  block.values = {};
}

FactorRounding rounding_of(const FactorMatrix& matrix) {
  FactorRounding result;
  if (matrix.precision() == FactorPrecision::single) return result;
  for (const FactorBlock& block : matrix.blocks) {
    for (const shared::float4& row : block.changes) {
      result.largest = std::max(result.largest, static_cast<double>(row.x));
      result.mean += static_cast<double>(row.y);
      result.row_change = std::max(result.row_change, static_cast<double>(row.z) * kSumsRounded);
      result.row_sum_change = std::max(result.row_sum_change, std::abs(static_cast<double>(row.w)));
    }
  }
  const std::uint64_t rows = matrix.rows(), entries = matrix.entries();
  result.mean /= std::max(static_cast<double>(entries), 1.0);
  const auto bytes = [rows, entries](FactorPrecision precision) {
    return static_cast<std::int64_t>(rows * row_bytes(precision) + entries * entry_bytes(precision));
  };
  result.bytes_saved = bytes(FactorPrecision::single) - bytes(FactorPrecision::half);
  return result;
}

std::vector<double> row_changes(const FactorMatrix& matrix) {
  std::vector<double> changes;
  if (matrix.precision() == FactorPrecision::single) return changes;
  changes.assign(matrix.side_count, 0.0);
  for (const FactorBlock& block : matrix.blocks) {
    const std::vector<std::uint32_t> rows = block.rows.read();
    for (std::uint32_t k = 0; k < block.row_count; k++) {
      changes[rows[k]] = static_cast<double>(block.changes[k].z) * kSumsRounded;
    }
  }
  return changes;
}

}  // namespace hemiray

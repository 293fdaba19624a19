#include "host/radiosity/guards.hpp"

#include <algorithm>
#include <cmath>

namespace hemiray {
namespace {

// Of a sum of cells that are rounded each.
constexpr double kClosedSum = 1e-4;

Arguments rows_of(const FactorBlock& block) {
  return arguments(row_arguments(block), arg("row_count", block.row_count));
}

double reciprocity_of(Context& context, Program& program, const Buffer<shared::float4>& normals,
                      const FactorMatrix& matrix) {
  Buffer<float> residuals(context, "reciprocity", matrix.side_count);
  residuals.clear();
  for (const FactorBlock& other : matrix.blocks) {
    std::vector<std::uint32_t> place(matrix.side_count, HR_NO_SIDE);
    const std::vector<std::uint32_t> rows = other.rows.read();
    for (std::uint32_t k = 0; k < rows.size(); k++) place[rows[k]] = k;
    const Buffer<std::uint32_t> places(context, "places of rows", std::span<const std::uint32_t>(place));
    for (const FactorBlock& block : matrix.blocks) {
      launch(context, program.kernel("radiosity_check_reciprocity"), block.row_count,
             arguments(rows_of(block), arg("place", places), arg("other_starts", other.starts),
                       arg("other_columns", other.columns), arg("other_values", other.values), arg("normals", normals),
                       arg("residuals", residuals)));
    }
  }
  double worst = 0.0;
  for (const float r : residuals.read()) worst = std::max(worst, static_cast<double>(r));
  return worst;
}

}  // namespace

Guards::Guards(Context& context, const PatchMesh& mesh, const FactorMatrix& raw, const PairSides& sides,
               const PairVisibility& visibility, float finest)
    : context_(&context),
      raw_(&raw),
      sides_(&sides),
      visibility_(&visibility),
      finest_(finest),
      program_(context, "guards", {"radiosity/guards.cl"}, {}),
      normals_(context, "patch normals", std::span(mesh.normals)),
      broken_(context, "laws broken", sides.count),
      causes_(context, "causes", sides.count) {
  broken_.clear();
  causes_.clear();
}

PairWatcher Guards::watcher() {
  const auto batch_arguments = [this](const FactorBlock& block, const PairBatch& batch) {
    return arguments(rows_of(block), arg("active", sides_->active), arg("dense", *batch.dense),
                     arg("stride", sides_->stride), arg("first", batch.first), arg("batch", batch.rows));
  };
  PairWatcher watcher;
  watcher.unobstructed = [this, batch_arguments](const PairBatch& batch) {
    for (const FactorBlock& block : raw_->blocks) {
      launch(*context_, program_.kernel("radiosity_check_entries"), block.row_count,
             arguments(batch_arguments(block, batch), arg("normals", normals_), arg("broken", broken_)));
    }
  };
  watcher.obstructed = [this, batch_arguments](const PairBatch& batch) {
    for (const FactorBlock& block : raw_->blocks) {
      launch(*context_, program_.kernel("radiosity_find_causes"), block.row_count,
             arguments(batch_arguments(block, batch), arg("sides", sides_->table), arg("partial", visibility_->partial),
                       arg("finest", finest_), arg("causes", causes_)));
    }
  };
  return watcher;
}

Violations Guards::violations() {
  Violations sum;
  sum.entries = raw_->entries();
  for (const shared::uint4& b : broken_.read()) {
    sum.above_one += b.x;
    sum.above_area += b.y;
    sum.above_unobstructed += b.z;
  }
  for (const shared::uint4& c : causes_.read()) {
    sum.proximity += c.x;
    sum.visibility += c.y;
    sum.aliasing += c.z;
    sum.point += c.w;
  }
  sum.reciprocity = reciprocity_of(*context_, program_, normals_, *raw_);
  return sum;
}

std::vector<bool> closed_rows(const FactorMatrix& raw) {
  std::vector<bool> closed(raw.side_count, false);
  for (const FactorBlock& block : raw.blocks) {
    const std::vector<std::uint32_t> rows = block.rows.read(), starts = block.starts.read();
    const std::vector<float> values = block.values.read();
    for (std::uint32_t k = 0; k < block.row_count; k++) {
      double sum = 0.0;
      for (std::uint32_t e = starts[k]; e < starts[k + 1]; e++) sum += static_cast<double>(values[e]);
      closed[rows[k]] = std::abs(sum - 1.0) < kClosedSum;
    }
  }
  return closed;
}

}  // namespace hemiray

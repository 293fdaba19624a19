#include "host/radiosity/enforce.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "host/radiosity/factor_rounding.hpp"

namespace hemiray {
namespace {

constexpr std::uint32_t kMostSweeps = 24;
constexpr double kStalled = 0.8;
constexpr double kCloseEnough = 1e-5;  // single precision keeps not much more of a row of ten thousands

}  // namespace

Enforcement scale_pairs(Context& context, const PatchMesh& mesh, FactorMatrix& exchange,
                        const std::vector<double>& slack, bool enforce, FactorPrecision precision) {
  Program program(context, "pair rows", {"radiosity/pair_rows.cl"}, {});
  Enforcement result;
  std::vector<bool> closed(slack.size());
  std::transform(slack.begin(), slack.end(), closed.begin(), [](double s) { return s >= 0.0; });
  result.scales.assign(mesh.side_count(), 1.0F);
  std::vector<std::uint32_t> rows;
  for (const FactorBlock& block : exchange.blocks) {
    const std::vector<std::uint32_t> some = block.rows.read();
    rows.insert(rows.end(), some.begin(), some.end());
  }
  Buffer<float> scales(context, "scales", mesh.side_count()), sums(context, "scaled sums", mesh.side_count());
  sums.clear();
  double last = 0.0;
  for (std::uint32_t sweep = 0;; sweep++) {
    scales.write(result.scales);
    for (const FactorBlock& block : exchange.blocks) {
      launch(
          context, program.kernel("radiosity_sum_scaled"), block.row_count,
          arguments(row_arguments(block), arg("row_count", block.row_count), arg("scales", scales), arg("sums", sums)));
    }
    const std::vector<float> scaled = sums.read();
    double worst = 0.0, mean = 0.0, excess = 0.0;
    std::uint32_t count = 0;
    for (const std::uint32_t s : rows) {
      const double f = static_cast<double>(result.scales[s]) * static_cast<double>(scaled[s]) /
                       static_cast<double>(mesh.normals[s / 2].w);
      excess = std::max(excess, f - 1.0);
      if (!closed[s]) continue;
      if (sweep == 0 && std::abs(1.0 - f) > slack[s]) {
        closed[s] = false;
        result.left_rows++;
        continue;
      }
      worst = std::max(worst, std::abs(1.0 - f));
      mean += std::abs(1.0 - f);
      count++;
    }
    mean /= std::max(count, 1U);
    if (sweep == 0) {
      result.closed_rows = count;
      result.closure_before = worst;
      result.mean_before = mean;
      result.excess_before = excess;
    }
    result.sweeps = sweep;
    result.closure_after = worst;
    result.mean_after = mean;
    result.excess_after = excess;
    const bool stalled = sweep > 2 && worst > kStalled * last;  // at what rounding leaves
    last = worst;
    if (!enforce || stalled || sweep == kMostSweeps || (worst < kCloseEnough && excess < kCloseEnough)) break;
    for (const std::uint32_t s : rows) {
      const double sum = static_cast<double>(scaled[s]), area = static_cast<double>(mesh.normals[s / 2].w);
      if (sum == 0.0) continue;
      const double now = static_cast<double>(result.scales[s]);
      // Both sides of a pair take the step, so one of 1 in the logarithm may swing for ever: 2/3 leaves a third of an
      // error that is a side's own, and of one that all sides share.
      if (closed[s] || now * sum > area) {
        result.scales[s] = static_cast<float>(now * std::pow(area / (now * sum), 2.0 / 3.0));
      }
    }
  }
  const Buffer<shared::float4> normals(context, "patch normals", std::span(mesh.normals));
  std::optional<FactorRounder> rounder;
  if (precision == FactorPrecision::half) rounder.emplace(context, mesh);
  const std::uint32_t as_factors = rounder ? 0 : 1;
  for (FactorBlock& block : exchange.blocks) {
    launch(context, program.kernel("radiosity_scale_pairs"), block.row_count,
           arguments(row_arguments(block), arg("row_count", block.row_count), arg("scales", scales),
                     arg("normals", normals), arg("as_factors", as_factors)));
    if (rounder) rounder->round(block, true);
  }
  return result;
}

}  // namespace hemiray

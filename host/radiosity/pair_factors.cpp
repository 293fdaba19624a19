#include "host/radiosity/pair_factors.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "host/base/clock.hpp"
#include "host/base/error.hpp"

namespace hemiray {
namespace {

constexpr std::uint64_t kDenseBytes = std::uint64_t{64} << 20U;
constexpr std::uint32_t kFarColumns = 256;  // HR_FAR_COLUMNS of radiosity/pair_far.cl

ProgramOptions wide_options(const Context& context, bool double_precision) {
  ProgramOptions options;
  options.double_precision = double_precision;
  if (context.profile().explicit_vectors == 0) options.defines = "-DHR_EXPLICIT_VECTORS=0";
  return options;
}

}  // namespace

PairFactors make_pair_factors(Context& context, Parallel& parallel, const PairSides& sides,
                              const PairVisibility& visibility, const PairWatcher& watcher,
                              const std::function<bool(double)>& on_progress) {
  if (!context.device().has_fp64) {  // in single precision contours cancel: up to 2 % off, not HR_PAIR_FAR_ERROR
    throw InputError("form factors", fmt::format("'{}' has no double precision, which pairs of close sides need; take "
                                                 "--form-factors hemicube, or another device",
                                                 context.device().name));
  }
  const double start = steady_ms();
  Program far(context, "far pairs", {"radiosity/pair_far.cl"}, wide_options(context, false)),
      near(context, "near pairs", {"radiosity/pair_near.cl"}, wide_options(context, true)),
      rows(context, "pair rows", {"radiosity/pair_rows.cl"}, {});
  PairFactors result;
  result.matrix.side_count = static_cast<std::uint32_t>(sides.active.size());
  const std::uint64_t row_bytes = std::uint64_t{sides.stride} * sizeof(float);
  const auto batch = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(
      std::min(kDenseBytes, context.device().max_allocation_bytes) / row_bytes, 1, std::max(sides.count, 1U)));
  Buffer<float> dense(context, "exchange areas", std::size_t{batch} * sides.stride);
  Buffer<std::uint32_t> near_counts(context, "near pairs", sides.count);
  Buffer<shared::float4> sums(context, "sums of exchange", sides.count);
  near_counts.clear();
  sums.clear();
  const std::uint32_t blocks = (sides.stride + kFarColumns - 1) / kFarColumns;
  for (std::uint32_t first = 0; first < sides.rows; first += batch) {
    const std::uint32_t count = std::min(batch, sides.rows - first);
    const Arguments table =
        arguments(arg("sides", sides.table), arg("stride", sides.stride), arg("flatness", sides.flatness),
                  arg("first", first), arg("row_count", count), arg("dense", dense));
    launch(context, far.kernel("radiosity_pair_far"), std::uint64_t{count} * blocks,
           arguments(table, arg("count", sides.count)));
    launch(context, near.kernel("radiosity_pair_near"), count,
           arguments(table, arg("corners", sides.corners), arg("near_counts", near_counts)));
    const PairBatch part{first, count, &dense};
    if (watcher.unobstructed) watcher.unobstructed(part);
    FactorBlock block;
    block.row_count = count;
    block.rows =
        Buffer<std::uint32_t>(context, "factor rows", std::span<const std::uint32_t>(sides.ids).subspan(first, count));
    block.starts = Buffer<std::uint32_t>(context, "factor starts", count + std::size_t{1});
    launch(context, rows.kernel("radiosity_apply_visibility"), count,
           arguments(arg("visible", visibility.visible), arg("partial", visibility.partial),
                     arg("starts", visibility.starts), arg("columns", visibility.columns),
                     arg("shares", visibility.shares), arg("errors", visibility.errors), arg("stride", sides.stride),
                     arg("first", first), arg("row_count", count), arg("dense", dense), arg("counts", block.starts),
                     arg("sums", sums)));
    if (watcher.obstructed) watcher.obstructed(part);
    parallel.exclusive_scan(block.starts, count);
    block.entries = block.starts.read(count, 1).front();
    block.columns = Buffer<std::uint32_t>(context, "factor columns", block.entries);
    block.values = Buffer<float>(context, "factor values", block.entries);
    launch(context, rows.kernel("radiosity_emit_pairs"), count,
           arguments(arg("dense", dense), arg("ids", sides.sides_by_number), arg("starts", block.starts),
                     arg("stride", sides.stride), arg("row_count", count), arg("columns", block.columns),
                     arg("values", block.values)));
    result.matrix.blocks.push_back(std::move(block));
    if (on_progress && !on_progress(static_cast<double>(first + count) / sides.rows)) break;
  }
  for (const shared::float4& s : sums.read()) {
    result.sums.push_back(
        {static_cast<double>(s.x), static_cast<double>(s.y), static_cast<double>(s.z), static_cast<double>(s.w)});
  }
  for (const std::uint32_t n : near_counts.read()) result.near_pairs += n;
  result.near_pairs /= 2;
  result.pairs_ms = steady_ms() - start;
  return result;
}

}  // namespace hemiray

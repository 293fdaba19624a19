#include "host/radiosity/area_errors.hpp"

#include <algorithm>
#include <cmath>

namespace hemiray {
namespace {

constexpr std::size_t kSumsAtOnce = std::size_t{1} << 20U;  // 16 MiB

}  // namespace

AreaErrors::AreaErrors(Context& context, const FactorGroups& groups, const PairSides& sides,
                       const PairVisibility& visibility)
    : context_(&context),
      sides_(&sides),
      visibility_(&visibility),
      groups_(static_cast<std::uint32_t>(groups.names.size())),
      group_of_(sides.stride, 0),
      program_(context, "errors of pairs", {"radiosity/pair_rows.cl"}, {}),
      sums_(std::size_t{groups_} * groups_) {
  for (std::uint32_t i = 0; i < sides.count; i++) group_of_[i] = groups.of_patch[sides.ids[i] / 2];
  groups_of_ = Buffer<std::uint32_t>(context, "areas of sides", std::span<const std::uint32_t>(group_of_));
}

void AreaErrors::add(const PairBatch& batch) {
  const auto step = static_cast<std::uint32_t>(std::clamp<std::size_t>(kSumsAtOnce / groups_, 1, batch.rows));
  Buffer<shared::float4> errors(*context_, "errors of areas", std::size_t{step} * groups_);
  for (std::uint32_t begin = 0; begin < batch.rows; begin += step) {
    const std::uint32_t rows = std::min(step, batch.rows - begin);
    errors.clear();
    launch(
        *context_, program_.kernel("radiosity_sum_pair_errors"), rows,
        arguments(arg("visible", visibility_->visible), arg("partial", visibility_->partial),
                  arg("starts", visibility_->starts), arg("columns", visibility_->columns),
                  arg("shares", visibility_->shares), arg("errors", visibility_->errors), arg("stride", sides_->stride),
                  arg("first", batch.first), arg("begin", begin), arg("row_count", rows), arg("dense", *batch.dense),
                  arg("groups_of", groups_of_), arg("groups", groups_), arg("sums", errors)));
    const std::vector<shared::float4> read = errors.read(0, std::size_t{rows} * groups_);
    for (std::size_t k = 0; k < read.size(); k++) {
      const std::size_t row = batch.first + begin + k / groups_;
      ErrorSplit& sum = sums_[std::size_t{group_of_[row]} * groups_ + k % groups_];
      sum.geometry += static_cast<double>(read[k].x);
      sum.sampling += static_cast<double>(read[k].y);
      if (visibility_->misses_some) sum.visibility += kMissedShare * static_cast<double>(read[k].z);
    }
  }
}

std::vector<ErrorSplit> AreaErrors::exchange_errors() const {
  std::vector<ErrorSplit> errors = sums_;
  for (std::size_t k = 0; k < errors.size(); k++) {
    // An area's own pairs are there twice, in two rows, with one error: it adds up, where variances would.
    const bool own = k / groups_ == k % groups_;
    errors[k].sampling = std::sqrt((own ? 2.0 : 1.0) * errors[k].sampling);
  }
  return errors;
}

}  // namespace hemiray

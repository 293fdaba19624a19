// Room for the refracted rays that wait while reflected ones are followed.
#pragma once

#include <algorithm>
#include <cstdint>

#include "host/gpu/buffer.hpp"
#include "host/gpu/program.hpp"
#include "host/scene/features.hpp"
#include "shared/scalar.h"

namespace hemiray {

/// `depth` entries a slot where the scene branches, else nothing.
class BranchStack {
 public:
  BranchStack(Context& context, const ProgramOptions& options, std::uint32_t slots, int depth) {
    if (!has_feature(options.features, HR_FEATURE_BRANCHING)) return;
    const std::size_t entries = static_cast<std::size_t>(slots) * static_cast<std::size_t>(std::max(depth, 1));
    entries_ = {context, "branches", entries * (options.double_precision ? 2 : 1)};
  }
  [[nodiscard]] Arguments as_arguments() const {
    return entries_.name().empty() ? Arguments{} : arguments(arg("branches", entries_));
  }

 private:
  /// PendingBranch of kernels/path/path_context.h; the host never looks inside. In double it takes two.
  struct alignas(16) Entry {
    shared::real4 origin, direction, weight;
    shared::uint4 control;
  };
  Buffer<Entry> entries_;
};

}  // namespace hemiray

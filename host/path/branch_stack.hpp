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
  BranchStack(Context& context, std::uint32_t features, std::uint32_t slots, int depth) {
    if (!has_feature(features, HR_FEATURE_BRANCHING)) return;
    entries_ = {context, "branches", static_cast<std::size_t>(slots) * static_cast<std::size_t>(std::max(depth, 1))};
  }
  [[nodiscard]] Arguments as_arguments() const {
    return entries_.name().empty() ? Arguments{} : arguments(arg("branches", entries_));
  }

 private:
  /// PendingBranch of kernels/path/path_context.h; the host never looks inside.
  struct alignas(16) Entry {
    shared::real4 origin, direction, weight;
    shared::uint4 control;
  };
  Buffer<Entry> entries_;
};

}  // namespace hemiray

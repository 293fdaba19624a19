// The megakernel engine: one launch a wave.
#pragma once

#include <cstdint>

#include "host/path/branch_stack.hpp"
#include "host/path/engine.hpp"

namespace hemiray {

class MegakernelEngine final : public PathEngine {
 public:
  MegakernelEngine(Context& context, const ProgramOptions& options, std::uint32_t slots, int depth);

  RayCounts trace(shared::RenderParams params, std::uint32_t count, const Arguments& arguments) override;
  [[nodiscard]] const PathSums& sums() const override { return sums_; }
  [[nodiscard]] Program& program() override { return program_; }

 private:
  Context* context_;
  std::uint32_t slots_;
  Program program_;
  PathSums sums_;
  BranchStack branches_;
  Buffer<shared::uint2> ray_counts_;
};

}  // namespace hemiray

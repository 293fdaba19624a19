// The wavefront engine: a kernel a stage, queues compacted between rounds. The last paths of a wave go as in the
// megakernel.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host/path/branch_stack.hpp"
#include "host/path/engine.hpp"
#include "host/path/ray_sorter.hpp"
#include "shared/path_state.def"

namespace hemiray {

class WavefrontEngine final : public PathEngine {
 public:
  WavefrontEngine(Context& context, Parallel& parallel, const ProgramOptions& options, std::uint32_t slots, int depth,
                  const WaveTracing& tracing);

  RayCounts trace(shared::RenderParams params, std::uint32_t count, const Arguments& arguments) override;
  [[nodiscard]] const PathSums& sums() const override { return sums_; }
  [[nodiscard]] Program& program() override { return program_; }

 private:
  /// One array for each field of the path state that the mask has, except the sums.
  struct StateArrays {
    StateArrays(Context& context, const ProgramOptions& options, std::uint32_t slots);
    Arguments all;
    Arguments rays;  ///< path_ray_origin and path_ray_direction

   private:
    std::size_t floats_a_real_ = 1;
    std::vector<Buffer<shared::real4>> vectors_;
    std::vector<Buffer<shared::uint4>> integer_vectors_;
    std::vector<Buffer<std::uint32_t>> integers_;
    void add(Context& context, const char* name, shared::real4 /*type*/, std::uint32_t slots);
    void add(Context& context, const char* name, shared::uint4 /*type*/, std::uint32_t slots);
    void add(Context& context, const char* name, std::uint32_t /*type*/, std::uint32_t slots);
  };

  /// One turn of all stages; in round 0 the camera's rays are traced.
  struct Round {
    std::uint32_t number = 0;
    bool in_packets = false;
  };

  /// Sorts the live slots of the queue by their next stage; returns where each stage's run starts, and the end.
  std::vector<std::uint32_t> compact_queue(std::uint32_t live);
  /// Runs one stage over its part of the queue.
  void run_stage(std::size_t stage, std::uint32_t first, std::uint32_t items, Round round, const Arguments& common);
  /// Traces `rays` rays of the queue's run in packets.
  void run_packets(const char* kernel, std::uint32_t rays, const Arguments& run);
  /// Are shadow rays, too, traced in packets?
  [[nodiscard]] bool packs_shadows() const;
  /// The rounds in which packets are traced: those of camera rays and of the first surfaces' shadow rays. By round, so
  /// that it does not depend on the other paths of the wave.
  [[nodiscard]] std::uint32_t rounds_of_packets(std::uint32_t lights) const;
  /// Do the paths left walk to their end in one go? Not before rays that go in packets or are worth sorting are traced.
  [[nodiscard]] bool is_tail(std::uint32_t live, Round round) const;
  /// Walks the paths left in the queue to their end.
  RayCounts finish_paths(std::uint32_t live, const Arguments& common);

  Context* context_;
  Parallel* parallel_;
  std::uint32_t features_;
  std::uint32_t slots_;
  ProgramOptions options_;
  WaveTracing tracing_;
  Program program_;
  std::optional<Program> packet_program_;  ///< compiled when it is first needed
  std::optional<RaySorter> sorter_;
  PathSums sums_;
  StateArrays state_;
  BranchStack branches_;
  Buffer<std::uint32_t> next_stage_;
  Buffer<std::uint32_t> queue_, queue_other_;
  Buffer<std::uint32_t> counts_;
  Buffer<shared::uint2> tail_rays_;
};

}  // namespace hemiray

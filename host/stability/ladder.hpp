// Runs rungs: asks the device, and a peer beside it, and has the oracle judge.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/bench/tracer.hpp"
#include "host/bvh/accel.hpp"
#include "host/gpu/context.hpp"
#include "host/stability/judge.hpp"
#include "host/stability/rung.hpp"

namespace hemiray::stability {

struct RungResult {
  std::string case_name, rung;
  RungKind kind = RungKind::hits;
  Tally ours;
  std::optional<Tally> packets;  ///< of the same rays traced in packets
  std::uint64_t other_bits = 0;  ///< answers of packets that are not those of single rays to the bit
  std::optional<Tally> peer;     ///< of the same rays, where it can trace them
  /// Implicit surfaces: regions of rays of which the device says that it cannot tell whether the surface is met there.
  std::optional<std::uint64_t> open_regions;
  std::string answers;              ///< hash of all of the device's answers
  std::vector<std::string> broken;  ///< bounds (bounds.hpp) that ours does not keep
};

struct LadderOptions {
  std::uint32_t rays = 1'000'000;  ///< a rung; rounded up to packets
  std::uint32_t seed = 5;
  bench::Tracer* peer = nullptr;
  unsigned threads = 1;  ///< that judge
  /// Rays and pictures in double. Rays that leave surfaces begin where a float cannot tell: their rungs are left out.
  bool double_precision = false;
  bool strict = false;  ///< answers are to be the same bits on every device
  /// Puts something in the way of the device's answers: for tests of the oracle.
  std::function<void(std::vector<shared::QueryHit>&)> tamper;
};

class Ladder {
 public:
  Ladder(Context& context, LadderOptions options);
  /// None for a rung that is left out.
  std::optional<RungResult> run(const std::string& case_name, const Rung& rung);

 private:
  void run_hits(const Rung& rung, RungResult& result, AnswerHash& hash);
  void run_leaving(const Rung& rung, RungResult& result, AnswerHash& hash);
  static void check_bounds(RungResult& result);

  Context* context_;
  LadderOptions options_;
  Parallel parallel_;
  AccelBuilder builder_;
};

}  // namespace hemiray::stability

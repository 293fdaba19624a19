// Keeps what is computed of a solution in a file, from which it goes on with the same bits.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/radiosity/factor_matrix.hpp"
#include "host/radiosity/patch_mesh.hpp"

namespace hemiray {

struct KeepOptions {
  std::string file;       ///< empty: nothing is kept
  bool resume = false;    ///< go on from what the file has; else it is begun
  double every_s = 30.0;  ///< from one write to the next, at least [s]; and ten times what the last one took
};

/// What there is of the form factors: some rows, all that light reaches, or none, as they do not fit.
enum class FactorStage : std::uint32_t { some, all, on_demand };

struct SolutionState {
  FactorStage stage = FactorStage::some;
  std::uint64_t expected_factor_bytes = 0;  ///< last known
  FactorMatrix factors;
  std::vector<std::uint8_t> solver;  ///< SolveOptions::continue_from
};

class SolutionFile {
 public:
  /// `key` (host/radiosity/solution_key.hpp) decides whose bits the file has. Begins the file, or reads it. Throws
  /// InputError where it cannot be read, is damaged, of another version or has another key or mesh, and says in what;
  /// and as AtomicFile does.
  SolutionFile(Context& context, const KeepOptions& options, std::string key, const PatchMesh& mesh);

  /// What was in the file, to go on from; without resume, the start.
  [[nodiscard]] SolutionState take_state() { return std::move(state_); }

  /// Writes the file anew, if it is time or it `must` be. `solver` is asked for only then.
  void offer(bool must, FactorStage stage, std::uint64_t expected_factor_bytes, const FactorMatrix& factors,
             const std::function<std::vector<std::uint8_t>()>& solver);

 private:
  void read(Context& context);

  KeepOptions options_;
  std::string key_;
  std::vector<std::uint8_t> mesh_;
  SolutionState state_;
  double next_ms_ = 0.0;
};

}  // namespace hemiray

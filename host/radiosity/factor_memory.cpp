#include "host/radiosity/factor_memory.hpp"

#include <algorithm>
#include <cmath>

namespace hemiray {
namespace {

constexpr double kFreeShare = 0.75;  // solver vectors, batches and the driver need some, too

}  // namespace

std::uint64_t most_factor_bytes(const PatchMesh& mesh, const HemicubeOptions& options, FactorPrecision precision) {
  const std::uint64_t cells =
      std::uint64_t{3} * options.resolution * options.resolution * options.divisions * options.divisions;
  return mesh.side_count() *
         (std::min<std::uint64_t>(cells, mesh.side_count()) * entry_bytes(precision) + row_bytes(precision));
}

std::uint64_t expected_factor_bytes(std::uint64_t entries, std::uint64_t rows_done, std::uint64_t rows_known,
                                    FactorPrecision precision) {
  if (rows_done == 0) return 0;
  const double a_row = static_cast<double>(entries * entry_bytes(precision)) / static_cast<double>(rows_done) +
                       static_cast<double>(row_bytes(precision));
  return static_cast<std::uint64_t>(std::llround(a_row * static_cast<double>(rows_known)));
}

std::uint64_t factor_memory_limit(const Context& context) {
  const std::uint64_t all = context.device().global_bytes, taken = context.allocated_bytes();
  return static_cast<std::uint64_t>(kFreeShare * static_cast<double>(all > taken ? all - taken : 0));
}

}  // namespace hemiray

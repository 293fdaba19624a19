// How much memory form factors will take.
#pragma once

#include <cstdint>

#include "host/radiosity/hemicubes.hpp"

namespace hemiray {

constexpr std::uint64_t kEntryBytes = 8, kRowBytes = 8;  ///< of a FactorBlock

/// No matrix of the mesh can take more: every side has a row, and every ray of it meets another side, or all.
std::uint64_t most_factor_bytes(const PatchMesh& mesh, const HemicubeOptions& options);

/// From the entries of the rows that are there to all rows that are known to be wanted, those among them.
std::uint64_t expected_factor_bytes(std::uint64_t entries, std::uint64_t rows_done, std::uint64_t rows_known);

/// What may be spent on them where nothing is said: a share of what is free on the device.
std::uint64_t factor_memory_limit(const Context& context);

}  // namespace hemiray

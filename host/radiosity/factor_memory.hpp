// How much memory form factors will take.
#pragma once

#include <cstdint>

#include "host/radiosity/hemicubes.hpp"

namespace hemiray {

/// Of a FactorBlock.
constexpr std::uint64_t entry_bytes(FactorPrecision precision) { return precision == FactorPrecision::half ? 6 : 8; }
constexpr std::uint64_t row_bytes(FactorPrecision precision) { return precision == FactorPrecision::half ? 12 : 8; }

/// No matrix of the mesh can take more: every side has a row, and every ray of it meets another side, or all.
std::uint64_t most_factor_bytes(const PatchMesh& mesh, const HemicubeOptions& options,
                                FactorPrecision precision = FactorPrecision::single);

/// From the entries of the rows that are there to all rows that are known to be wanted, those among them.
std::uint64_t expected_factor_bytes(std::uint64_t entries, std::uint64_t rows_done, std::uint64_t rows_known,
                                    FactorPrecision precision = FactorPrecision::single);

/// What may be spent on them where nothing is said: a share of what is free on the device.
std::uint64_t factor_memory_limit(const Context& context);

}  // namespace hemiray

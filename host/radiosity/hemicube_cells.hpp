// The form factors of a hemicube's cells, exactly.
#pragma once

#include <cstdint>
#include <vector>

namespace hemiray {

/// Of the top's n x n cells, y n + x, and then of one side face's n x n / 2, z n + along: the integrals of the cells,
/// by differences of the closed forms at their corners, so that the top and four faces sum to 1 (source, section 5;
/// Howell's catalogue, configurations B-3 and B-4). `resolution`: n, even.
std::vector<double> hemicube_cells(std::uint32_t resolution);

}  // namespace hemiray

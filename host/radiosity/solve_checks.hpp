// What must hold of a radiosity system before it is solved.
#pragma once

#include "host/radiosity/solver.hpp"

namespace hemiray {

/// Asymmetry up to which conjugate gradients are right: what single precision leaves of factors that were made
/// symmetric, and far below what makes them stall.
constexpr double kSymmetric = 1e-5;

/// Throws InputError for options out of range, or a side with rho + tau >= 1 (of what arrives on it, or of what leaves
/// it), a negative one or no number.
void check_solver_input(const PatchMesh& mesh, const SolveOptions& options);

/// Throws InputError, with the patch, for factors below 0 or no numbers, and for rows that with the reflectance give
/// back all that comes or more.
void check_rows(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix);

/// max |A_i F_ij - A_j F_ji| / max A_i F_ij, or what is known of it once it exceeds `enough`.
double find_asymmetry(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix, double enough);

bool is_translucent(const PatchMesh& mesh);

}  // namespace hemiray

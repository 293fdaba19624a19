// View factors between whole areas: the sums of patches' form factors.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/radiosity/area_errors.hpp"
#include "host/radiosity/factor_matrix.hpp"
#include "host/radiosity/patch_mesh.hpp"

namespace hemiray {

/// F[i n + j] of n areas: what share of the light that leaves the fronts of area i arrives on fronts of area j. Backs
/// stop light and take none of it.
struct ViewFactors {
  std::vector<std::string> names;
  std::vector<double> areas_m2;
  std::vector<double> factors;
  std::vector<ErrorSplit> errors;  ///< of the factors; empty if form factors were not made pair by pair
  /// Half of what both directions of a pair differ by, |A_i F_ij - A_j F_ji| / (2 A_i): sampling shows in it, and
  /// visibility, but not an error that both directions share.
  std::vector<double> reciprocity_errors;
  std::vector<double> row_sums;
};

/// One group an object of the scene; objects of one name are one group. `objects`: their names by index.
FactorGroups groups_by_name(const PatchMesh& mesh, const std::vector<std::string>& objects);

/// `rows`: of the fronts of all patches (read_rows()). `exchange_errors`: AreaErrors::exchange_errors(), or nothing.
ViewFactors view_factors(const PatchMesh& mesh, const FactorGroups& groups, const std::vector<FactorRow>& rows,
                         const std::vector<ErrorSplit>& exchange_errors = {});

/// "from,to,area_m2,factor,geometry_error,sampling_error,visibility_error,reciprocity_error" and a line a pair; errors
/// that are not known are empty.
std::string factors_as_csv(const ViewFactors& factors);
/// NumPy's format 1.0: n x n, double, row-major.
std::string factors_as_npy(const ViewFactors& factors);
/// What View3D 3.2 writes as text (out=0): a head of 31 characters, areas, rows, emittances (1 minus the mean
/// reflectance of each group). `emittances`: one a group.
std::string factors_as_view3d(const ViewFactors& factors, const std::vector<double>& emittances, bool closed);
/// Emittances by area: 1 - rho, the mean of the three colours.
std::vector<double> group_emittances(const PatchMesh& mesh, const FactorGroups& groups);
/// View3D's input for the same areas: a surface a patch, those of a group combined.
std::string patches_as_view3d(const PatchMesh& mesh, const FactorGroups& groups, const std::string& title);

}  // namespace hemiray

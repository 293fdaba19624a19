#include "host/radiosity/view_factors.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace hemiray {

FactorGroups groups_by_name(const PatchMesh& mesh, const std::vector<std::string>& objects) {
  FactorGroups groups;
  std::map<std::string, std::uint32_t> known;
  std::vector<std::uint32_t> of_object;
  for (const std::string& name : objects) {
    const auto [found, is_new] = known.try_emplace(name, static_cast<std::uint32_t>(groups.names.size()));
    if (is_new) groups.names.push_back(name);
    of_object.push_back(found->second);
  }
  for (const std::uint32_t object : mesh.flat.triangle_objects) groups.of_patch.push_back(of_object.at(object));
  return groups;
}

ViewFactors view_factors(const PatchMesh& mesh, const FactorGroups& groups, const std::vector<FactorRow>& rows,
                         const std::vector<ErrorSplit>& exchange_errors) {
  const std::size_t n = groups.names.size();
  ViewFactors result;
  result.names = groups.names;
  result.areas_m2.assign(n, 0.0);
  std::vector<double> exchange(n * n, 0.0);  // A_i F_ij
  for (std::uint32_t patch = 0; patch < mesh.patch_count(); patch++) {
    const auto area = static_cast<double>(mesh.normals[patch].w);
    const std::size_t i = groups.of_patch[patch];
    result.areas_m2[i] += area;
    for (const auto& [side, value] : rows[std::size_t{2} * patch]) {
      if (side % 2 == 0) exchange[i * n + groups.of_patch[side / 2]] += area * static_cast<double>(value);
    }
  }
  for (std::size_t i = 0; i < n; i++) {
    const double area = result.areas_m2[i];
    double sum = 0.0;
    for (std::size_t j = 0; j < n; j++) {
      result.factors.push_back(area > 0.0 ? exchange[i * n + j] / area : 0.0);
      result.reciprocity_errors.push_back(area > 0.0 ? 0.5 * std::abs(exchange[i * n + j] - exchange[j * n + i]) / area
                                                     : 0.0);
      if (!exchange_errors.empty()) {
        const ErrorSplit& e = exchange_errors[i * n + j];
        result.errors.push_back(area > 0.0 ? ErrorSplit{e.geometry / area, e.sampling / area, e.visibility / area}
                                           : ErrorSplit{});
      }
      sum += result.factors.back();
    }
    result.row_sums.push_back(sum);
  }
  return result;
}

std::vector<double> group_emittances(const PatchMesh& mesh, const FactorGroups& groups) {
  std::vector<double> sums(groups.names.size(), 0.0), areas = sums;
  for (std::uint32_t patch = 0; patch < mesh.patch_count(); patch++) {
    const shared::float4& rho = mesh.reflectance[std::size_t{2} * patch];
    const auto area = static_cast<double>(mesh.normals[patch].w);
    const double mean = (static_cast<double>(rho.x) + static_cast<double>(rho.y) + static_cast<double>(rho.z)) / 3.0;
    sums[groups.of_patch[patch]] += area * (1.0 - mean);
    areas[groups.of_patch[patch]] += area;
  }
  for (std::size_t i = 0; i < sums.size(); i++) sums[i] = areas[i] > 0.0 ? sums[i] / areas[i] : 1.0;
  return sums;
}

}  // namespace hemiray

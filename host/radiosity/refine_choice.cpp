#include "host/radiosity/refine_choice.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/radiosity/display.hpp"
#include "host/radiosity/mesh_edges.hpp"

namespace hemiray {

RefineChoice patches_to_refine(const PatchMesh& mesh, const std::vector<std::array<double, 3>>& irradiance,
                               double least_jump) {
  const MeshEdges edges(mesh);
  const double least_cosine = std::cos(DisplayOptions{}.crease_deg * std::numbers::pi / 180.0);
  RefineChoice choice;
  std::vector<double> errors(mesh.patch_count(), 0.0);
  double sum = 0.0, area = 0.0;
  for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
    double most = 0.0;
    for (std::size_t k = 0; k < 3; k++) {
      const std::uint32_t other = edges.neighbours[std::size_t{3} * i + k];
      if (other == HR_NO_SIDE) continue;
      const double cosine = cosine_of(mesh.normals[i], mesh.normals[other]);
      if (std::abs(cosine) < least_cosine) continue;
      for (std::uint32_t back = 0; back < 2; back++) {
        // Of what comes to this side, it reflects rho, and the other side passes tau.
        const shared::float4 &rho = mesh.reflectance[std::size_t{2} * i + back],
                             &tau = mesh.transmittance[std::size_t{2} * i + 1 - back];
        const auto& here = irradiance[std::size_t{2} * i + back];
        const auto& there = irradiance[std::size_t{2} * other + (cosine > 0.0 ? back : 1 - back)];
        const std::array<double, 3> jump = {(rho.x + tau.x) * (here[0] - there[0]),
                                            (rho.y + tau.y) * (here[1] - there[1]),
                                            (rho.z + tau.z) * (here[2] - there[2])};
        most = std::max(most, (jump[0] * jump[0] + jump[1] * jump[1] + jump[2] * jump[2]) / 3.0);
      }
    }
    errors[i] = static_cast<double>(mesh.normals[i].w) * most;
    sum += errors[i];
    area += static_cast<double>(mesh.normals[i].w);
    choice.largest_jump = std::max(choice.largest_jump, std::sqrt(most));
    if (std::sqrt(most) > least_jump) choice.patches.push_back(i);
  }
  choice.mean_jump = std::sqrt(sum / area);
  std::ranges::stable_sort(choice.patches, [&](std::uint32_t a, std::uint32_t b) { return errors[a] > errors[b]; });
  return choice;
}

}  // namespace hemiray

#include "host/radiosity/display.hpp"

#include <cmath>
#include <numbers>

#include "host/radiosity/mesh_edges.hpp"

namespace hemiray {
namespace {

// The triangles around each place, and the place of each corner.
struct Fans {
  std::vector<std::vector<std::uint32_t>> triangles;
  std::vector<std::uint32_t> of_corner;
};

Fans fans_of(const PatchMesh& mesh) {
  Fans fans;
  const std::vector<std::uint32_t> places = number_places(mesh.flat);
  fans.triangles.resize(places.size());
  for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
    const shared::uint4& t = mesh.flat.triangles[i];
    for (const std::uint32_t vertex : {t.x, t.y, t.z}) {
      fans.triangles[places[vertex]].push_back(i);
      fans.of_corner.push_back(places[vertex]);
    }
  }
  return fans;
}

}  // namespace

std::vector<std::array<float, 3>> corner_irradiance(const PatchMesh& mesh,
                                                    const std::vector<std::array<double, 3>>& irradiance,
                                                    const DisplayOptions& options) {
  std::vector<std::array<float, 3>> corners(std::size_t{6} * mesh.patch_count());
  const Fans fans = options.smooth ? fans_of(mesh) : Fans{};
  const double least_cosine = std::cos(options.crease_deg * std::numbers::pi / 180.0);
  for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
    for (std::uint32_t corner = 0; corner < 3; corner++) {
      for (std::uint32_t back = 0; back < 2; back++) {
        std::array<double, 3> sum{};
        double weight = 0.0;
        const auto add = [&](std::uint32_t triangle, std::uint32_t side) {
          const auto area = static_cast<double>(mesh.normals[triangle].w);
          for (std::size_t c = 0; c < 3; c++) sum[c] += area * irradiance[std::size_t{2} * triangle + side][c];
          weight += area;
        };
        if (options.smooth) {
          for (const std::uint32_t other : fans.triangles[fans.of_corner[std::size_t{3} * i + corner]]) {
            const double cosine = cosine_of(mesh.normals[i], mesh.normals[other]);
            // A neighbour of the other winding turns its back where this one has its front.
            if (std::abs(cosine) >= least_cosine) add(other, cosine > 0.0 ? back : 1 - back);
          }
        } else {
          add(i, back);
        }
        for (std::size_t c = 0; c < 3; c++) {
          corners[(std::size_t{2} * i + back) * 3 + corner][c] = static_cast<float>(sum[c] / weight);
        }
      }
    }
  }
  return corners;
}

FlatScene lit_patches(const PatchMesh& mesh, const std::vector<std::array<double, 3>>& irradiance,
                      const DisplayOptions& options) {
  FlatScene flat = mesh.flat;
  flat.lights.clear();
  flat.emitters.clear();
  flat.patch_light.reserve(std::size_t{6} * mesh.patch_count());
  for (const auto& h : corner_irradiance(mesh, irradiance, options))
    flat.patch_light.push_back({h[0], h[1], h[2], 0.0F});
  // No highlights: there are no lights that they could mirror.
  for (shared::Material& m : flat.materials) m.ks = {0.0F, 0.0F, 0.0F, m.ks.w};
  return flat;
}

}  // namespace hemiray

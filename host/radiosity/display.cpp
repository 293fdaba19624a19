#include "host/radiosity/display.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>

#include "host/scene/flat_lights.hpp"

namespace hemiray {
namespace {

using Place = std::array<std::uint32_t, 3>;  // bits of a position; -0 is 0

Place place_of(const FlatScene& flat, std::uint32_t vertex) {
  Place place{};
  for (std::size_t i = 0; i < 3; i++)
    place[i] = std::bit_cast<std::uint32_t>(flat.positions[std::size_t{3} * vertex + i] + 0.0F);
  return place;
}

// The triangles around each place, and the place of each corner.
struct Fans {
  std::vector<std::vector<std::uint32_t>> triangles;
  std::vector<std::uint32_t> of_corner;
};

Fans fans_of(const PatchMesh& mesh) {
  Fans fans;
  std::map<Place, std::uint32_t> places;
  for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
    const shared::uint4& t = mesh.flat.triangles[i];
    for (const std::uint32_t vertex : {t.x, t.y, t.z}) {
      const auto [found, is_new] =
          places.try_emplace(place_of(mesh.flat, vertex), static_cast<std::uint32_t>(places.size()));
      if (is_new) fans.triangles.emplace_back();
      fans.triangles[found->second].push_back(i);
      fans.of_corner.push_back(found->second);
    }
  }
  return fans;
}

double cosine_of(const shared::float4& a, const shared::float4& b) {
  return static_cast<double>(a.x) * static_cast<double>(b.x) + static_cast<double>(a.y) * static_cast<double>(b.y) +
         static_cast<double>(a.z) * static_cast<double>(b.z);
}

// First patch that was cut from the scene's triangle `face`, or from a later one. Patches come in the order of
// triangles.
std::uint32_t first_patch_of(const PatchMesh& mesh, std::uint32_t face) {
  return static_cast<std::uint32_t>(std::ranges::lower_bound(mesh.faces, face) - mesh.faces.begin());
}

// Patches that emit and are no part of a light of its own.
std::vector<shared::Emitter> emitters_of(const PatchMesh& mesh, const std::vector<shared::Light>& lights) {
  std::vector<EmitterCandidate> candidates;
  for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
    const shared::float4& e = mesh.flat.materials[mesh.flat.triangles[i].w].emission;
    const double mean = (static_cast<double>(e.x) + static_cast<double>(e.y) + static_cast<double>(e.z)) / 3.0;
    const bool is_light = std::ranges::any_of(lights, [i](const shared::Light& light) {
      return i >= light.first_primitive && i - light.first_primitive < light.primitive_count;
    });
    const auto area = static_cast<double>(mesh.normals[i].w);
    if (mean > 0.0 && !is_light) candidates.push_back({i, area, area * mean});
  }
  return make_emitters(candidates);
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

FlatScene gathered_patches(const FlatScene& scene, const PatchMesh& mesh,
                           const std::vector<std::array<double, 3>>& irradiance, std::uint32_t rays,
                           const DisplayOptions& options) {
  FlatScene flat = lit_patches(mesh, irradiance, options);
  flat.materials = scene.materials;
  flat.gather_rays = rays;
  flat.lights = scene.lights;
  for (shared::Light& light : flat.lights) {
    if (light.primitive_count == 0) continue;
    const std::uint32_t end = first_patch_of(mesh, light.first_primitive + light.primitive_count);
    light.first_primitive = first_patch_of(mesh, light.first_primitive);
    light.primitive_count = end - light.first_primitive;
  }
  flat.emitters = emitters_of(mesh, flat.lights);
  return flat;
}

}  // namespace hemiray

#include "host/radiosity/display.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "host/radiosity/mesh_edges.hpp"
#include "host/scene/flat_lights.hpp"

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

// Patches, and what comes to their sides, in the order of the scene's triangles; refined ones are not.
struct OrderedPatches {
  PatchMesh mesh;
  std::vector<std::array<double, 3>> irradiance;
};

OrderedPatches in_order_of_faces(const PatchMesh& mesh, const std::vector<std::array<double, 3>>& irradiance) {
  std::vector<std::uint32_t> order(mesh.patch_count());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, {}, [&mesh](std::uint32_t i) { return mesh.faces[i]; });
  OrderedPatches ordered{mesh, irradiance};
  for (std::size_t k = 0; k < order.size(); k++) {
    const std::uint32_t i = order[k];
    ordered.mesh.flat.triangles[k] = mesh.flat.triangles[i];
    ordered.mesh.flat.triangle_objects[k] = mesh.flat.triangle_objects[i];
    ordered.mesh.normals[k] = mesh.normals[i];
    ordered.mesh.faces[k] = mesh.faces[i];
    for (std::size_t side = 0; side < 2; side++)
      ordered.irradiance[2 * k + side] = irradiance[std::size_t{2} * i + side];
  }
  return ordered;
}

// First patch that was cut from the scene's triangle `face`, or from a later one.
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
  const OrderedPatches patches = in_order_of_faces(mesh, irradiance);
  FlatScene flat = lit_patches(patches.mesh, patches.irradiance, options);
  flat.materials = scene.materials;
  flat.gather_rays = rays;
  flat.lights = scene.lights;
  for (shared::Light& light : flat.lights) {
    if (light.primitive_count == 0) continue;
    const std::uint32_t end = first_patch_of(patches.mesh, light.first_primitive + light.primitive_count);
    light.first_primitive = first_patch_of(patches.mesh, light.first_primitive);
    light.primitive_count = end - light.first_primitive;
  }
  flat.emitters = emitters_of(patches.mesh, flat.lights);
  return flat;
}

}  // namespace hemiray

// Rays that leave a surface of an instance: the rounding of its transform, both ways, is in the error of the hit point.
#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>

#include "host/bench/flat_mesh.hpp"
#include "host/stability/rung.hpp"
#include "host/stability/shapes.hpp"

namespace hemiray::stability {
namespace {

Mesh mesh_of(const FlatScene& flat) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < flat.positions.size() / 3; i++) mesh.positions.emplace_back(bench::vertex_of(flat, i));
  for (const shared::uint4& t : flat.triangles) mesh.triangles.emplace_back(t.x, t.y, t.z);
  mesh.triangle_materials.assign(mesh.triangles.size(), 0);
  return mesh;
}

// One mesh at each of the places. In the scene as instances, in `copies` as triangles of the world.
struct Instanced {
  FlatScene scene, copies;
};
Instanced place_mesh(const FlatScene& flat, const std::vector<DMat4>& places) {
  Scene scene;
  scene.materials.emplace_back();
  scene.meshes.push_back(mesh_of(flat));
  for (const DMat4& to_world : places) {
    Object object;
    object.to_world = to_world;
    scene.objects.push_back(object);
  }
  return {flatten_scene(scene, Instancing::always), flatten_scene(scene, Instancing::never)};
}

DMat4 turned() { return glm::rotate(DMat4(1.0), 0.9, glm::normalize(DVec3(1.0, 2.0, 0.5))); }
DMat4 turned_again() { return glm::rotate(DMat4(1.0), 2.2, glm::normalize(DVec3(-0.4, 1.0, 1.3))); }

// Scaled along axes that are nobody's, turned, and the mesh's middle `own` brought to `at`.
DMat4 transform(DVec3 scale, DVec3 at, DVec3 own = DVec3(0.0)) {
  const DMat4 linear = turned_again() * turned() * glm::scale(DMat4(1.0), scale) * glm::transpose(turned());
  return glm::translate(DMat4(1.0), at) * linear * glm::translate(DMat4(1.0), -own);
}

// An icosahedron of radius 1 about `own` in its own space, brought to `at`, as an instance or a copy.
Rung solid(std::string name, DVec3 scale, DVec3 at, DVec3 own = DVec3(0.0), bool instanced = true) {
  Instanced placed = place_mesh(moved(icosahedron(), DVec3(1.0), own), {transform(scale, at, own)});
  const auto least = static_cast<float>(std::min({scale.x, scale.y, scale.z}));
  const auto most = static_cast<float>(std::max({scale.x, scale.y, scale.z}));
  const Vec3 center(at);
  Rung rung;
  rung.name = std::move(name);
  rung.kind = RungKind::leaving;
  rung.rays =
      at_triangles(placed.copies, {{center, 2.0F * most, 4.0F * most, false}, {center, 0.0F, 0.2F * least, true}});
  rung.flat = std::move(instanced ? placed.scene : placed.copies);
  return rung;
}

// Two sheets of one mesh, scaled, 1 from the origin, the second behind the first as seen from where the rays start.
Rung layers(std::string name, double gap, DVec3 scale) {
  const DVec3 place = DVec3(0.577, 0.577, 0.577);
  const DMat4 first = transform(scale, place);
  const DVec3 along = glm::normalize(glm::cross(DVec3(first[0]), DVec3(first[1])));
  Instanced placed = place_mesh(sheet(3), {first, glm::translate(DMat4(1.0), gap * along) * first});
  Rung rung;
  rung.name = std::move(name);
  rung.kind = RungKind::leaving;
  rung.after = After::layer;
  rung.rays = through_first_layer(placed.copies, along, place);
  rung.flat = std::move(placed.scene);
  return rung;
}

}  // namespace

std::vector<Case> instance_cases() {
  const DVec3 way(1.0, -0.7, 0.3);
  Case scale{"leaving, instance scale",
             "An icosahedron of radius 1 as an instance, turned, scaled by that and placed three times as far from the "
             "origin: outside rays meet nothing, inside the far side.",
             {}};
  constexpr std::pair<const char*, double> kScales[] = {
      {"1e-6", 1e-6}, {"1e-3", 1e-3}, {"1", 1.0}, {"1e3", 1e3}, {"1e6", 1e6}};
  for (const auto& [name, value] : kScales) {
    scale.rungs.emplace_back([=, name = name, value = value] { return solid(name, DVec3(value), 3.0 * value * way); });
  }
  Case translation{"leaving, instance place", "The same scaled by 4, so far from the origin.", {}};
  constexpr std::pair<const char*, double> kOffsets[] = {{"0", 0.0},   {"1e2", 1e2}, {"1e3", 1e3}, {"1e4", 1e4},
                                                         {"1e5", 1e5}, {"1e6", 1e6}, {"1e7", 1e7}};
  for (const auto& [name, value] : kOffsets) {
    translation.rungs.emplace_back([=, name = name, value = value] { return solid(name, DVec3(4.0), value * way); });
  }
  Case own{"leaving, instance's own place", "The same, the mesh so far from the origin of its own space.", {}};
  constexpr std::pair<const char*, double> kOwn[] = {{"1e1", 1e1}, {"1e2", 1e2}, {"1e4", 1e4}};
  for (const auto& [name, value] : kOwn) {
    own.rungs.emplace_back(
        [=, name = name, value = value] { return solid(name, DVec3(1.0), way, value * DVec3(0.6, 0.8, 0.5)); });
  }
  Case stretch{"leaving, instance stretch",
               "Rays go on through a sheet, an instance squeezed askew to that, to another one 0.01 behind it.",
               {}};
  constexpr std::pair<const char*, double> kSqueezes[] = {{"1", 1.0}, {"1e-1", 1e-1}, {"1e-2", 1e-2}, {"1e-3", 1e-3}};
  for (const auto& [name, value] : kSqueezes) {
    stretch.rungs.emplace_back([name = name, value = value] { return layers(name, 1e-2, {1.0, value, 1.0}); });
  }
  Case sharp{
      "leaving, sharp edges",
      "From an icosahedron squeezed so that its sharpest edges have that angle, as triangles of the world and as an "
      "instance.",
      {}};
  // Edges of 138.19 degrees about the middle: tan(angle / 2) shrinks by the scale.
  constexpr std::pair<const char*, double> kEdges[] = {
      {"29 degrees", 0.1}, {"15 degrees", 0.05}, {"7.5 degrees", 0.025}, {"3.7 degrees", 0.0125}};
  for (const auto& [name, value] : kEdges) {
    for (const bool instanced : {false, true}) {
      sharp.rungs.emplace_back([=, name = std::string(name), value = value] {
        return solid(instanced ? name + ", instance" : name, {1.0, value, 1.0}, way, DVec3(0.0), instanced);
      });
    }
  }
  Case gap{"gap, instances",
           "Rays go on through a sheet, an instance 1 from the origin, to another one of the same mesh behind it at "
           "that gap.",
           {}};
  constexpr std::pair<const char*, double> kGaps[] = {
      {"1e-2", 1e-2},     {"1e-4", 1e-4},     {"1e-5", 1e-5},     {"4e-6", 4e-6}, {"2e-6", 2e-6},
      {"1.6e-6", 1.6e-6}, {"1.4e-6", 1.4e-6}, {"1.2e-6", 1.2e-6}, {"1e-6", 1e-6}, {"9e-7", 9e-7},
      {"8e-7", 8e-7},     {"7e-7", 7e-7},     {"6e-7", 6e-7},     {"5e-7", 5e-7}};
  for (const auto& [name, value] : kGaps) {
    gap.rungs.emplace_back([name = name, value = value] { return layers(name, value, DVec3(0.5)); });
  }
  return {std::move(scale),   std::move(translation), std::move(own),
          std::move(stretch), std::move(sharp),       std::move(gap)};
}

}  // namespace hemiray::stability

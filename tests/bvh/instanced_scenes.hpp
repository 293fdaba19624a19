// Scenes whose objects share meshes, and what tests need to compare them as instances with the same as copies.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "host/scene/features.hpp"
#include "tests/bvh/query_bench.hpp"

namespace hemiray::test {

/// The triangles of a flat shape as a mesh.
inline Mesh mesh_of(const FlatScene& flat) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < flat.positions.size() / 3; i++) mesh.positions.push_back(vertex(flat, i));
  for (const shared::uint4& t : flat.triangles) mesh.triangles.emplace_back(t.x, t.y, t.z);
  mesh.triangle_materials.assign(mesh.triangles.size(), 0);
  return mesh;
}

inline std::uint32_t add_mesh(Scene& scene, Mesh mesh) {
  if (scene.materials.empty()) scene.materials.emplace_back();
  scene.meshes.push_back(std::move(mesh));
  return static_cast<std::uint32_t>(scene.meshes.size() - 1);
}

inline void add_object(Scene& scene, std::uint32_t mesh, const DMat4& to_world) {
  Object object;
  object.mesh = mesh;
  object.to_world = to_world;
  scene.objects.push_back(object);
}

/// Turned about a random axis, scaled by `scale` along the object's own axes, moved to `place`.
inline DMat4 random_turn(Places& places, DVec3 place, DVec3 scale) {
  const DMat4 moved = glm::translate(DMat4(1.0), place);
  const double angle = static_cast<double>(places.in(0.0F, 2.0F)) * std::numbers::pi;
  return glm::scale(glm::rotate(moved, angle, glm::normalize(DVec3(places.direction()))), scale);
}

/// A flat scene on the device with its tree, instances and all.
struct InstancedTree {
  InstancedTree(TreeWorkshop& workshop, const FlatScene& flat, const AccelOptions& options = {})
      : scene(workshop.context, flat, kAllPrimitives | (flat.instances.empty() ? 0U : HR_FEATURE_INSTANCES)),
        accel(workshop.builder, scene, options) {}
  DeviceScene scene;
  Accel accel;
};

/// A primitive by its object and its place in it, which is the same for instances and for copies.
using PrimitiveName = std::pair<std::uint32_t, std::uint32_t>;

inline PrimitiveName name_of(const FlatScene& flat, std::uint32_t id) {
  const std::uint32_t triangles = flat.world_triangles();
  if (id < triangles) {
    std::uint32_t first = id;
    while (first > 0 && flat.triangle_objects[first - 1] == flat.triangle_objects[id]) first--;
    return {flat.triangle_objects[id], id - first};
  }
  id -= triangles;
  if (id < flat.spheres.size()) return {flat.spheres[id].object, 0};
  id -= static_cast<std::uint32_t>(flat.spheres.size());
  if (id < flat.planes.size()) return {flat.planes[id].object, 0};
  id += static_cast<std::uint32_t>(flat.spheres.size()) + triangles;
  for (const shared::Instance& instance : flat.instances) {
    if (id - instance.first_id < instance.triangle_count) return {instance.object, id - instance.first_id};
  }
  return {kMiss, kMiss};
}

}  // namespace hemiray::test

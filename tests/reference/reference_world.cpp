// Flattens a Scene into world-space primitives.
#include "tests/reference/reference_world.hpp"

#include <cmath>
#include <utility>

namespace hemiray::reference {

namespace {

bool finite(const DVec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// False for a triangle without area or with non-finite corners: it is dropped.
bool complete(WorldTriangle& triangle) {
  for (const DVec3& corner : triangle.corners) {
    if (!finite(corner)) return false;
  }
  const DVec3 twice_area =
      glm::cross(triangle.corners[1] - triangle.corners[0], triangle.corners[2] - triangle.corners[0]);
  const double length = glm::length(twice_area);
  if (!(length > 0.0)) return false;
  triangle.normal = twice_area / length;
  triangle.area_m2 = length / 2.0;
  return true;
}

void add_object(World& world, std::size_t object_index) {
  const Object& object = world.scene.objects[object_index];
  const Mesh& mesh = world.scene.meshes.at(object.mesh);
  const glm::dmat3 linear(object.to_world);
  const glm::dmat3 for_normals = glm::transpose(glm::inverse(linear));
  const bool mirrored = glm::determinant(linear) < 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    WorldTriangle triangle;
    triangle.material = material_of(world.scene, object, t);
    triangle.object = object_index;
    triangle.smooth = !mesh.normals.empty();
    triangle.has_uvs = !mesh.uvs.empty();
    glm::uvec3 vertices = mesh.triangles[t];
    if (mirrored) std::swap(vertices.y, vertices.z);
    for (int k = 0; k < 3; ++k) {
      const auto corner = static_cast<std::size_t>(k);
      const std::size_t vertex = vertices[k];
      triangle.corners[corner] = world_position(object, mesh.positions.at(vertex));
      triangle.uvs[corner] = triangle.has_uvs ? glm::dvec2(mesh.uvs.at(vertex)) : glm::dvec2(0.0);
      triangle.colors[corner] = mesh.colors.empty() ? DVec3(1.0) : DVec3(mesh.colors.at(vertex));
      if (!triangle.smooth) continue;
      const DVec3 normal = for_normals * DVec3(mesh.normals.at(vertex));
      const double length = glm::length(normal);
      triangle.smooth = length > 0.0;
      if (triangle.smooth) triangle.normals[corner] = normal / length;
    }
    if (complete(triangle)) world.triangles.push_back(triangle);
  }
}

}  // namespace

World::World(const Scene& scene_in) : scene(scene_in) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i) add_object(*this, i);
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    if (light.kind != LightKind::area || !light.visible) continue;
    quads.push_back({light.position, light.edge_u, light.edge_v, glm::normalize(glm::cross(light.edge_u, light.edge_v)),
                     DVec3(light.intensity), i});
  }
}

std::size_t World::object_id(const PrimitiveId& primitive) const {
  const std::size_t objects = scene.objects.size();
  const std::size_t spheres = scene.spheres.size();
  switch (primitive.kind) {
    case Kind::triangle:
      return 1 + triangles[primitive.index].object;
    case Kind::sphere:
      return 1 + objects + primitive.index;
    case Kind::shape:
      return 1 + objects + spheres + primitive.index;
    case Kind::plane:
      return 1 + objects + spheres + scene.shapes.size() + primitive.index;
    case Kind::quad:
      return 1 + objects + spheres + scene.shapes.size() + scene.planes.size() + primitive.index;
    case Kind::none:
      break;
  }
  return 0;
}

std::size_t material_of(const Scene& scene, const Object& object, std::size_t triangle) {
  if (object.material != kNone) return static_cast<std::size_t>(object.material);
  return scene.meshes.at(object.mesh).triangle_materials.at(triangle);
}

DVec3 world_position(const Object& object, const Vec3& position) {
  return DVec3(Vec3(DVec3(object.to_world * glm::dvec4(DVec3(position), 1.0))));
}

}  // namespace hemiray::reference

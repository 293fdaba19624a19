// World bounds in double: one walk over the finite things of a scene, used twice.
#include "host/scene/bounds.hpp"

#include <algorithm>

#include "host/scene/shape_geometry.hpp"

namespace hemiray {
namespace {

// Calls add_point(p_world) for every corner of a triangle, of a visible area light and of a shape's box, and
// add_sphere(center, radius).
template <typename AddPoint, typename AddSphere>
void visit(const Scene& scene, AddPoint add_point, AddSphere add_sphere) {
  for (const Object& object : scene.objects) {
    const Mesh& mesh = scene.meshes[object.mesh];
    std::vector<bool> used(mesh.positions.size());  // vertices without a triangle do not count
    for (const UVec3& t : mesh.triangles) used[t.x] = used[t.y] = used[t.z] = true;
    for (std::size_t i = 0; i < used.size(); ++i) {
      if (used[i]) add_point(DVec3(object.to_world * glm::dvec4(mesh.positions[i], 1.0)));
    }
  }
  for (const Light& light : scene.lights) {
    if (light.kind != LightKind::area || !light.visible) continue;
    add_point(light.position);
    add_point(light.position + light.edge_u);
    add_point(light.position + light.edge_v);
    add_point(light.position + light.edge_u + light.edge_v);
  }
  for (const Sphere& sphere : scene.spheres) add_sphere(sphere.center, sphere.radius);
  for (const Shape& shape : scene.shapes) {
    const WorldBounds box = shape_bounds(shape);
    for (unsigned corner = 0; corner < 8; ++corner) {
      add_point(DVec3((corner & 1U) != 0 ? box.max.x : box.min.x, (corner & 2U) != 0 ? box.max.y : box.min.y,
                      (corner & 4U) != 0 ? box.max.z : box.min.z));
    }
  }
}

}  // namespace

WorldBounds world_bounds(const Scene& scene) {
  WorldBounds bounds;
  visit(
      scene, [&](const DVec3& point) { bounds.add(point); },
      [&](const DVec3& center, double radius) {
        bounds.add(center - radius);
        bounds.add(center + radius);
      });
  return bounds;
}

double bounding_radius(const Scene& scene, const DVec3& center) {
  double result = 0.0;
  visit(
      scene, [&](const DVec3& point) { result = std::max(result, glm::length(point - center)); },
      [&](const DVec3& middle, double radius) { result = std::max(result, glm::length(middle - center) + radius); });
  return result;
}

}  // namespace hemiray

// Builds scenes from parts.
#include "tests/reference/scene_builder.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace hemiray::reference {

namespace {

std::size_t add_mesh_object(Scene& scene, Mesh mesh, std::uint32_t material) {
  mesh.triangle_materials.assign(mesh.triangles.size(), material);
  scene.meshes.push_back(std::move(mesh));
  Object object;
  object.mesh = static_cast<std::uint32_t>(scene.meshes.size() - 1);
  scene.objects.push_back(object);
  return scene.objects.size() - 1;
}

}  // namespace

DMat4 look_at(const DVec3& eye, const DVec3& target, const DVec3& up) {
  const DVec3 back = glm::normalize(eye - target);
  const DVec3 right = glm::normalize(glm::cross(up, back));
  const DVec3 above = glm::cross(back, right);
  return {glm::dvec4(right, 0.0), glm::dvec4(above, 0.0), glm::dvec4(back, 0.0), glm::dvec4(eye, 1.0)};
}

Scene empty_scene(const DVec3& eye, const DVec3& target, double fov_y_deg) {
  Scene scene;
  scene.camera.to_world = look_at(eye, target);
  scene.camera.fov_y_deg = fov_y_deg;
  scene.has_camera = true;
  scene.has_lights = true;
  return scene;
}

std::uint32_t add_material(Scene& scene, const Material& material) {
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

Material diffuse(const Vec3& kd) {
  Material material;
  material.kd = kd;
  return material;
}

Material mirror(float kr) {
  Material material = diffuse(Vec3(0.0F));
  material.kr = Vec3(kr);
  return material;
}

Material glass(float ior) {
  Material material = mirror(1.0F);
  material.kt = Vec3(1.0F);
  material.ior = ior;
  return material;
}

Material emissive(const Vec3& emission) {
  Material material = diffuse(Vec3(0.0F));
  material.emission = emission;
  return material;
}

std::size_t add_rectangle(Scene& scene, const DVec3& corner, const DVec3& u, const DVec3& v, std::uint32_t material) {
  Mesh mesh;
  mesh.positions = {Vec3(corner), Vec3(corner + u), Vec3(corner + u + v), Vec3(corner + v)};
  mesh.uvs = {{0.0F, 0.0F}, {1.0F, 0.0F}, {1.0F, 1.0F}, {0.0F, 1.0F}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.rectangle = true;
  return add_mesh_object(scene, std::move(mesh), material);
}

std::size_t add_box(Scene& scene, const DVec3& low, const DVec3& high, std::uint32_t material) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.emplace_back((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                                (i & 4) != 0 ? high.z : low.z);
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return add_mesh_object(scene, std::move(mesh), material);
}

std::size_t add_smooth_ball(Scene& scene, const DVec3& center, double radius, int rings, std::uint32_t material) {
  Mesh mesh;
  const int columns = 2 * rings;
  for (int i = 0; i <= rings; ++i) {
    for (int j = 0; j <= columns; ++j) {
      const double theta = std::numbers::pi * i / rings;
      const double phi = 2.0 * std::numbers::pi * j / columns;
      const DVec3 normal(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
      mesh.positions.emplace_back(center + radius * normal);
      mesh.normals.emplace_back(normal);
      mesh.uvs.emplace_back(static_cast<double>(j) / columns, static_cast<double>(i) / rings);
    }
  }
  const auto vertex = [columns](int i, int j) { return static_cast<std::uint32_t>(i * (columns + 1) + j); };
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < columns; ++j) {
      // The cells at the poles are single triangles.
      if (i > 0) mesh.triangles.emplace_back(vertex(i, j), vertex(i + 1, j), vertex(i, j + 1));
      if (i + 1 < rings) mesh.triangles.emplace_back(vertex(i, j + 1), vertex(i + 1, j), vertex(i + 1, j + 1));
    }
  }
  return add_mesh_object(scene, std::move(mesh), material);
}

void add_sphere(Scene& scene, const DVec3& center, double radius, std::uint32_t material) {
  Sphere sphere;
  sphere.center = center;
  sphere.radius = radius;
  sphere.material = material;
  scene.spheres.push_back(sphere);
}

void add_plane(Scene& scene, const DVec3& point, const DVec3& normal, std::uint32_t material) {
  Plane plane;
  plane.point = point;
  plane.normal = glm::normalize(normal);
  plane.material = material;
  scene.planes.push_back(plane);
}

Light& add_point_light(Scene& scene, const DVec3& position, const Vec3& intensity) {
  Light light;
  light.position = position;
  light.intensity = intensity;
  scene.lights.push_back(light);
  return scene.lights.back();
}

Light& add_area_light(Scene& scene, const DVec3& corner, const DVec3& u, const DVec3& v, const Vec3& radiance) {
  Light light;
  light.kind = LightKind::area;
  light.position = corner;
  light.edge_u = u;
  light.edge_v = v;
  light.intensity = radiance;
  scene.lights.push_back(light);
  return scene.lights.back();
}

double value_at(const Image& image, const std::string& layer, int x, int y, std::size_t c) {
  const Layer* found = image.find(layer);
  if (found == nullptr || x < 0 || y < 0 || x >= image.width || y >= image.height) {
    throw std::out_of_range("no layer '" + layer + "' or no such pixel");
  }
  const std::size_t pixel =
      static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x);
  return found->data.at(pixel * found->channels.size() + c);
}

}  // namespace hemiray::reference

// Interpolation, normal maps, textures and the metallic-roughness workflow.
#include "tests/reference/reference_surface.hpp"

#include <algorithm>
#include <cmath>

#include "tests/reference/reference_shape.hpp"
#include "tests/reference/reference_texture.hpp"

namespace hemiray::reference {

namespace {

constexpr double kMinRoughness = 0.01;
constexpr double kMaxExponent = 1e6;
constexpr double kDielectricSpecular = 0.04;  // glTF: reflectance of a dielectric at normal incidence

/// Interpolated texture coordinates and colour; primitives without them keep `textured` false.
struct Attributes {
  bool textured = false;
  glm::dvec2 uv{0.0};
  DVec3 color{1.0};
};

Attributes attributes_at(const WorldTriangle& triangle, const DVec3& weights) {
  Attributes result;
  result.textured = triangle.has_uvs;
  result.color = DVec3(0.0);
  for (int k = 0; k < 3; ++k) {
    result.uv += weights[k] * triangle.uvs[static_cast<std::size_t>(k)];
    result.color += weights[k] * triangle.colors[static_cast<std::size_t>(k)];
  }
  return result;
}

DVec3 texture_or_one(const Scene& scene, int texture, const Attributes& attributes) {
  if (texture == kNone || !attributes.textured) return DVec3(1.0);
  return sample_texture(scene.textures.at(static_cast<std::size_t>(texture)), attributes.uv);
}

void apply_material(const Scene& scene, const Material& material, const Attributes& attributes, Surface& surface) {
  const DVec3 base = DVec3(material.kd) * texture_or_one(scene, material.kd_texture, attributes) * attributes.color;
  surface.kd = base;
  surface.ks = DVec3(material.ks);
  surface.exponent = material.shininess;
  if (material.metallic_roughness) {
    const DVec3 map = texture_or_one(scene, material.metallic_roughness_texture, attributes);
    const double metallic = material.metallic * map.z;
    surface.kd = base * (1.0 - metallic);
    surface.ks = DVec3(kDielectricSpecular) * (1.0 - metallic) + base * metallic;
    surface.exponent = exponent_from_roughness(material.roughness * map.y);
  }
  surface.ka = material.ka ? DVec3(*material.ka) : surface.kd;
  surface.kr = DVec3(material.kr);
  surface.kt = DVec3(material.kt);
  surface.ior = material.ior;
  surface.fresnel = material.fresnel;
  surface.emission = DVec3(material.emission) * texture_or_one(scene, material.emission_texture, attributes);
}

/// `normal` tilted by the material's normal map; the bitangent runs against v (glTF: +Y is up in the picture).
DVec3 perturbed(const Scene& scene, const Material& material, const WorldTriangle& triangle,
                const Attributes& attributes, const DVec3& normal) {
  const DVec3 e1 = triangle.corners[1] - triangle.corners[0];
  const DVec3 e2 = triangle.corners[2] - triangle.corners[0];
  const glm::dvec2 d1 = triangle.uvs[1] - triangle.uvs[0];
  const glm::dvec2 d2 = triangle.uvs[2] - triangle.uvs[0];
  const double determinant = d1.x * d2.y - d2.x * d1.y;
  if (determinant == 0.0) return normal;
  const DVec3 along_u = (e1 * d2.y - e2 * d1.y) / determinant;
  const DVec3 along_v = (e2 * d1.x - e1 * d2.x) / determinant;
  const DVec3 flat = along_u - normal * glm::dot(normal, along_u);
  if (!(glm::length(flat) > 0.0)) return normal;
  const DVec3 tangent = glm::normalize(flat);
  DVec3 bitangent = glm::cross(normal, tangent);
  if (glm::dot(bitangent, along_v) > 0.0) bitangent = -bitangent;
  DVec3 local = texture_or_one(scene, material.normal_texture, attributes) * 2.0 - 1.0;
  local.x *= material.normal_scale;
  local.y *= material.normal_scale;
  const DVec3 tilted = tangent * local.x + bitangent * local.y + normal * local.z;
  return glm::length(tilted) > 0.0 ? glm::normalize(tilted) : normal;
}

/// The normals, turned towards the viewer; `outward` and `shading` are those of the front.
void set_normals(Surface& surface, const Ray& ray, const DVec3& outward, const DVec3& shading) {
  surface.front = glm::dot(outward, ray.direction) < 0.0;
  surface.geometric_normal = surface.front ? outward : -outward;
  surface.shading_normal = glm::dot(shading, surface.geometric_normal) < 0.0 ? -shading : shading;
}

void evaluate_triangle(const World& world, const Ray& ray, const Hit& hit, Surface& surface) {
  const WorldTriangle& triangle = world.triangles[hit.primitive.index];
  const Material& material = world.scene.materials.at(triangle.material);
  const Attributes attributes = attributes_at(triangle, hit.barycentrics);
  apply_material(world.scene, material, attributes, surface);
  DVec3 shading = triangle.normal;
  if (triangle.smooth) {
    const DVec3 sum = triangle.normals[0] * hit.barycentrics.x + triangle.normals[1] * hit.barycentrics.y +
                      triangle.normals[2] * hit.barycentrics.z;
    if (glm::length(sum) > 0.0) shading = glm::normalize(sum);
  }
  if (material.normal_texture != kNone && triangle.has_uvs) {
    shading = perturbed(world.scene, material, triangle, attributes, shading);
  }
  set_normals(surface, ray, triangle.normal, shading);
  if (!triangle.smooth) return;
  // Hanika's shadow origin: the mean of the point's projections onto the vertices' tangent planes, where above it.
  const DVec3 on_triangle = triangle.corners[0] * hit.barycentrics.x + triangle.corners[1] * hit.barycentrics.y +
                            triangle.corners[2] * hit.barycentrics.z;
  for (int corner = 0; corner < 3; ++corner) {
    const auto c = static_cast<std::size_t>(corner);
    DVec3 up = triangle.normals[c];
    if (glm::dot(up, surface.geometric_normal) < 0.0) up = -up;
    const double height = glm::dot(on_triangle - triangle.corners[c], up);
    if (height < 0.0) surface.lift_m -= hit.barycentrics[corner] * height * up;
  }
}

}  // namespace

Surface surface_at(const World& world, const Ray& ray, const Hit& hit) {
  Surface surface;
  surface.position_m = ray.origin + ray.direction * hit.t_m;
  surface.position_error_m = point_error(surface.position_m, hit.t_m);
  const Scene& scene = world.scene;
  switch (hit.primitive.kind) {
    case Kind::triangle:
      evaluate_triangle(world, ray, hit, surface);
      break;
    case Kind::quad: {
      const WorldQuad& quad = world.quads[hit.primitive.index];
      surface.emission = quad.emission;
      set_normals(surface, ray, quad.normal, quad.normal);
      break;
    }
    case Kind::sphere: {
      const Sphere& sphere = scene.spheres[hit.primitive.index];
      apply_material(scene, scene.materials.at(sphere.material), {}, surface);
      const DVec3 outward = glm::normalize(surface.position_m - sphere.center);
      set_normals(surface, ray, outward, outward);
      break;
    }
    case Kind::shape: {
      const Shape& shape = scene.shapes[hit.primitive.index];
      apply_material(scene, scene.materials.at(shape.material), {}, surface);
      const DVec3 outward = shape_normal(shape, surface.position_m);
      set_normals(surface, ray, outward, outward);
      break;
    }
    case Kind::plane: {
      const Plane& plane = scene.planes[hit.primitive.index];
      apply_material(scene, scene.materials.at(plane.material), {}, surface);
      set_normals(surface, ray, plane.normal, plane.normal);
      break;
    }
    case Kind::none:
      break;
  }
  return surface;
}

DVec3 triangle_emission(const World& world, const WorldTriangle& triangle, const DVec3& barycentrics) {
  Surface surface;
  apply_material(world.scene, world.scene.materials.at(triangle.material), attributes_at(triangle, barycentrics),
                 surface);
  return surface.emission;
}

double exponent_from_roughness(double roughness) {
  const double r = std::clamp(roughness, kMinRoughness, 1.0);
  return std::clamp(2.0 / (r * r * r * r) - 2.0, 0.0, kMaxExponent);
}

}  // namespace hemiray::reference

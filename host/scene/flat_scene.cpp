#include "host/scene/flat_scene.hpp"

#include <bit>

#include <algorithm>
#include <array>

#include "host/base/error.hpp"
#include "host/scene/flat_instances.hpp"
#include "host/scene/flat_lights.hpp"
#include "host/scene/shape_geometry.hpp"

namespace hemiray {
namespace {

shared::float4 to_float4(Vec3 v, float w) { return {v.x, v.y, v.z, w}; }

std::uint32_t texture_or_none(int index) { return index == kNone ? HR_NO_TEXTURE : static_cast<std::uint32_t>(index); }

shared::Material flatten_material(const Material& m) {
  shared::Material flat{};
  flat.kd = to_float4(m.kd, m.shininess);
  flat.ks = to_float4(m.ks, m.ior);
  flat.ka = to_float4(m.ka.value_or(m.kd), m.roughness);
  flat.kr = to_float4(m.kr, m.metallic);
  flat.kt = to_float4(m.kt, m.normal_scale);
  flat.emission = to_float4(m.emission, 0.0F);
  flat.translucency_r = m.translucency.r;
  flat.translucency_g = m.translucency.g;
  flat.translucency_b = m.translucency.b;
  flat.kd_texture = texture_or_none(m.kd_texture);
  flat.metallic_roughness_texture = texture_or_none(m.metallic_roughness_texture);
  flat.emission_texture = texture_or_none(m.emission_texture);
  flat.normal_texture = texture_or_none(m.normal_texture);
  flat.flags = (m.fresnel ? HR_MATERIAL_FRESNEL : 0U) | (m.metallic_roughness ? HR_MATERIAL_METALLIC_ROUGHNESS : 0U) |
               (m.ka ? HR_MATERIAL_OWN_AMBIENT : 0U);
  return flat;
}

std::uint32_t wrap_code(Wrap wrap) {
  return wrap == Wrap::repeat ? HR_WRAP_REPEAT : wrap == Wrap::clamp ? HR_WRAP_CLAMP : HR_WRAP_MIRROR;
}

void flatten_textures(const Scene& scene, FlatScene& flat) {
  for (const Texture& t : scene.textures) {
    if (flat.texels.size() + t.rgba.size() / 4 > std::size_t{0xffffffff}) {
      throw DeviceError("the textures have more than 2^32 texels; scale them down");
    }
    shared::Texture texture{};
    texture.first_texel = static_cast<std::uint32_t>(flat.texels.size());
    texture.width = static_cast<std::uint32_t>(t.width);
    texture.height = static_cast<std::uint32_t>(t.height);
    texture.flags = (t.filter == Filter::nearest ? HR_TEXTURE_NEAREST : 0U) |
                    (t.color_space == ColorSpace::srgb ? HR_TEXTURE_SRGB : 0U);
    texture.wrap_u = wrap_code(t.wrap_u);
    texture.wrap_v = wrap_code(t.wrap_v);
    flat.textures.push_back(texture);
    for (std::size_t i = 0; i + 3 < t.rgba.size(); i += 4) {
      flat.texels.push_back(std::uint32_t{t.rgba[i]} | std::uint32_t{t.rgba[i + 1]} << 8U |
                            std::uint32_t{t.rgba[i + 2]} << 16U | std::uint32_t{t.rgba[i + 3]} << 24U);
    }
  }
}

// Those that any object needs.
Attributes attributes_of(const Scene& scene) {
  Attributes needed;
  const bool textured = !scene.textures.empty();
  for (const Object& object : scene.objects) {
    const Mesh& mesh = scene.meshes[object.mesh];
    needed.normals |= !mesh.normals.empty();
    needed.uvs |= textured && !mesh.uvs.empty();
    needed.colors |= !mesh.colors.empty();
  }
  return needed;
}

void append_object(const Scene& scene, const Object& object, std::uint32_t object_index, const Attributes& needed,
                   FlatScene& flat) {
  const Mesh& mesh = scene.meshes[object.mesh];
  const std::size_t first = flat.positions.size() / 3;
  check_room(flat, mesh);
  const glm::dmat3 linear(object.to_world);
  const glm::dmat3 normal_matrix = glm::transpose(glm::inverse(linear));
  for (std::size_t i = 0; i < mesh.positions.size(); i++) {
    const Vec3 position(object.to_world * glm::dvec4(DVec3(mesh.positions[i]), 1.0));
    Vec3 normal(0.0F);
    if (!mesh.normals.empty()) {
      const DVec3 n = normal_matrix * DVec3(mesh.normals[i]);
      const double length = glm::length(n);
      if (length > 0.0) normal = Vec3(n / length);
    }
    append_vertex(flat, needed, position, normal, mesh.uvs.empty() ? Vec2(0.0F) : mesh.uvs[i],
                  mesh.colors.empty() ? Vec3(1.0F) : mesh.colors[i]);
  }
  const bool mirrored = glm::determinant(linear) < 0.0;
  const auto offset = static_cast<std::uint32_t>(first);
  for (std::size_t t = 0; t < mesh.triangles.size(); t++) {
    UVec3 v = mesh.triangles[t] + offset;
    if (mirrored) std::swap(v.y, v.z);
    const std::uint32_t material =
        object.material != kNone ? static_cast<std::uint32_t>(object.material) : mesh.triangle_materials[t];
    flat.triangles.push_back({v.x, v.y, v.z, material});
    flat.triangle_objects.push_back(object_index);
  }
}

// A visible area light is a black quad that emits to its front.
std::uint32_t append_light_quad(const Light& light, std::uint32_t object_index, const Attributes& needed,
                                FlatScene& flat) {
  Material black;
  black.kd = Vec3(0.0F);
  black.emission = light.intensity;
  const auto material = static_cast<std::uint32_t>(flat.materials.size());
  flat.materials.push_back(flatten_material(black));
  const auto first = static_cast<std::uint32_t>(flat.positions.size() / 3);
  const auto primitive = static_cast<std::uint32_t>(flat.triangles.size());
  const std::array<DVec3, 4> corners = {light.position, light.position + light.edge_u,
                                        light.position + light.edge_u + light.edge_v, light.position + light.edge_v};
  for (const DVec3& corner : corners) {
    append_vertex(flat, needed, Vec3(corner), Vec3(0.0F), Vec2(0.0F), Vec3(1.0F));
  }
  flat.triangles.push_back({first, first + 1, first + 2, material});
  flat.triangles.push_back({first, first + 2, first + 3, material});
  flat.triangle_objects.insert(flat.triangle_objects.end(), {object_index, object_index});
  return primitive;
}

}  // namespace

// Behind the others; the last shape is told where.
static void add_tape(const std::vector<shared::uint4>& tape, FlatScene& flat) {
  shared::Shape& shape = flat.shapes.back();
  shape.form.x = std::bit_cast<float>(static_cast<std::uint32_t>(flat.tapes.size()));
  shape.form.y = std::bit_cast<float>(static_cast<std::uint32_t>(tape.size()));
  flat.tapes.insert(flat.tapes.end(), tape.begin(), tape.end());
}

FlatScene flatten_scene(const Scene& scene, Instancing instancing) {
  FlatScene flat;
  for (const Material& material : scene.materials) flat.materials.push_back(flatten_material(material));
  flatten_textures(scene, flat);
  const Attributes needed = attributes_of(scene);
  const std::vector<bool> instanced = instanced_objects(scene, instancing);
  std::uint32_t object_index = 0;
  std::vector<std::uint32_t> first_primitive;  // of each object
  for (const Object& object : scene.objects) {
    first_primitive.push_back(static_cast<std::uint32_t>(flat.triangles.size()));
    if (!instanced[object_index]) append_object(scene, object, object_index, needed, flat);
    object_index++;
  }
  for (const Sphere& sphere : scene.spheres) {
    shared::Sphere s{};
    s.center_radius = to_float4(Vec3(sphere.center), static_cast<float>(sphere.radius));
    s.material = sphere.material;
    s.object = object_index++;
    flat.spheres.push_back(s);
  }
  for (const Shape& shape : scene.shapes) {
    flat.shapes.push_back(flatten_shape(shape));
    if (shape.kind == ShapeKind::implicit) add_tape(shape.expression.tape, flat);
    flat.shapes.back().object = object_index++;
  }
  for (const Plane& plane : scene.planes) {
    shared::Plane p{};
    p.point = to_float4(Vec3(plane.point), 0.0F);
    p.normal = to_float4(Vec3(plane.normal), 0.0F);
    p.material = plane.material;
    p.object = object_index++;
    flat.planes.push_back(p);
  }
  LightCollector collector(scene, flat);
  for (const Light& light : scene.lights) {
    const bool quad = light.kind == LightKind::area && light.visible;
    collector.add_light(light, quad ? append_light_quad(light, object_index++, needed, flat) : 0, quad ? 2 : 0);
  }
  for (std::size_t i = 0; i < scene.objects.size(); i++) {
    if (!instanced[i]) collector.add_object(scene.objects[i], first_primitive[i]);
  }
  collector.add_spheres();
  collector.finish();
  append_instances(scene, instanced, needed, flat);
  return flat;
}

}  // namespace hemiray

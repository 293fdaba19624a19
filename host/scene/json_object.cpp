// The elements of "objects" of a JSON scene other than meshes and shapes: quads, boxes, spheres, planes.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/spelling.hpp"
#include "host/scene/json_build.hpp"
#include "host/scene/json_keys.hpp"
#include "host/scene/json_transform.hpp"
#include "host/scene/mesh_tools.hpp"
#include "host/scene/triangulate.hpp"

namespace hemiray {
namespace {

DMat4 read_transform_of(const JsonNode& node) {
  const auto transform = node.find("transform");
  return transform ? read_transform(*transform) : DMat4(1.0);
}

// Adds a mesh of one material and an object that places it; degenerate triangles are dropped and counted.
void add_mesh(const JsonNode& node, JsonBuild& build, Mesh mesh, std::uint32_t material) {
  const auto dropped = std::erase_if(mesh.triangles, [&](const UVec3& t) {
    return is_degenerate(mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]);
  });
  build.scene.dropped_triangles += dropped;
  mesh.triangle_materials.assign(mesh.triangles.size(), material);
  mesh.name = read_name(node);
  if (node.at("type").value() == "quad" && dropped == 0) mark_rectangle(mesh);
  Object object;
  object.name = mesh.name;
  object.mesh = static_cast<std::uint32_t>(build.scene.meshes.size());
  object.to_world = read_transform_of(node);
  build.scene.meshes.push_back(std::move(mesh));
  build.scene.objects.push_back(std::move(object));
}

Vec2 read_uv_scale(const JsonNode& node) {
  const auto scale = node.find("uv_scale");
  if (!scale) return Vec2(1.0F);
  if (scale->is_array()) expect_array(*scale, 2);
  Vec2 result;
  for (int c = 0; c < 2; ++c) {
    const JsonNode part = scale->is_array() ? (*scale)[static_cast<std::size_t>(c)] : *scale;
    result[c] = static_cast<float>(read_number(part, -1e6, 1e6));
    if (result[c] == 0.0F) part.fail("a uv_scale of 0 leaves one texel");
  }
  return result;
}

DVec3 triangle_normal(const DVec3& a, const DVec3& b, const DVec3& c) { return glm::cross(b - a, c - a); }

// Four points in order. The diagonal 0-2 must lie inside: where the corner 1 or 3 is reflex, the diagonal 1-3 does.
std::array<DVec3, 4> read_corners(const JsonNode& node) {
  expect_array(node, 4);
  std::array<DVec3, 4> p{};
  for (std::size_t i = 0; i < 4; ++i) p[i] = read_vector(node[i]);
  for (int turn = 0; turn < 2; ++turn) {
    const DVec3 first = triangle_normal(p[0], p[1], p[2]);
    const DVec3 second = triangle_normal(p[0], p[2], p[3]);
    if (glm::dot(first, second) > 0.0) return p;
    std::rotate(p.begin(), p.begin() + 1, p.end());
  }
  node.fail("the four points do not go round a quad: two coincide, all lie on a line, or the sides cross");
}

std::array<DVec3, 4> read_parallelogram(const JsonNode& node) {
  const DVec3 corner = read_vector(node.at("corner"));
  const DVec3 u = read_vector(node.at("edge_u"));
  const DVec3 v = read_vector(node.at("edge_v"));
  constexpr double kParallel = 1e-6;  // sine of the smallest angle between the edges
  if (!(glm::length(glm::cross(u, v)) > kParallel * glm::length(u) * glm::length(v))) {
    node.at("edge_v").fail("edge_u and edge_v span no area");
  }
  return {corner, corner + u, corner + u + v, corner + v};
}

void read_quad(const JsonNode& node, JsonBuild& build) {
  const auto vertices = node.find("vertices");
  for (const char* key : {"corner", "edge_u", "edge_v"}) {
    const auto other = node.find(key);
    if (vertices && other) other->fail("a quad has either vertices or corner, edge_u and edge_v");
  }
  const auto corners = vertices ? read_corners(*vertices) : read_parallelogram(node);
  const Vec2 scale = read_uv_scale(node);
  // Seen from the front with edge_u to the right and edge_v up, a texture stands upright: v grows downwards.
  constexpr std::array<Vec2, 4> kUv{Vec2(0.0F, 1.0F), Vec2(1.0F, 1.0F), Vec2(1.0F, 0.0F), Vec2(0.0F, 0.0F)};
  Mesh mesh;
  for (std::size_t i = 0; i < 4; ++i) {
    mesh.positions.emplace_back(corners[i]);
    mesh.uvs.push_back(kUv[i] * scale);
  }
  mesh.triangles = {UVec3(0, 1, 2), UVec3(0, 2, 3)};
  add_mesh(node, build, std::move(mesh), read_material_of(node, build));
}

void read_box(const JsonNode& node, JsonBuild& build) {
  const DVec3 low = read_vector(node.at("min"));
  const DVec3 high = read_vector(node.at("max"));
  for (int c = 0; c < 3; ++c) {
    const auto axis = static_cast<std::size_t>(c);
    if (!(low[c] < high[c])) node.at("max")[axis].fail(fmt::format("must be greater than min ({})", low[c]));
  }
  // Each face as corner, u and v with u x v pointing outwards; u and v name axes, a sign means "backwards".
  struct Face {
    DVec3 corner;  // 0: min, 1: max along each axis
    DVec3 u, v;
  };
  const std::array<Face, 6> faces{Face{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},  Face{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}},
                                  Face{{1, 0, 1}, {0, 0, -1}, {0, 1, 0}}, Face{{0, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                  Face{{0, 1, 1}, {1, 0, 0}, {0, 0, -1}}, Face{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}};
  Mesh mesh;
  for (const Face& face : faces) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec2 uv : {Vec2(0.0F, 1.0F), Vec2(1.0F, 1.0F), Vec2(1.0F, 0.0F), Vec2(0.0F, 0.0F)}) {
      const DVec3 place = face.corner + double{uv.x} * face.u + (1.0 - double{uv.y}) * face.v;
      mesh.positions.emplace_back(glm::mix(low, high, place));
      mesh.uvs.push_back(uv);
    }
    mesh.triangles.emplace_back(first, first + 1, first + 2);
    mesh.triangles.emplace_back(first, first + 2, first + 3);
  }
  add_mesh(node, build, std::move(mesh), read_material_of(node, build));
}

void read_sphere(const JsonNode& node, JsonBuild& build) {
  Sphere sphere;
  sphere.name = read_name(node);
  sphere.center = read_vector(node.at("center"));
  sphere.radius = read_positive(node.at("radius"), kMaxCoordinate);
  sphere.material = read_material_of(node, build);
  refuse_textures(node, build.scene.materials[sphere.material], "sphere");
  if (const auto transform = node.find("transform")) {
    const DMat4 matrix = read_transform(*transform);
    const auto scale = similarity_scale(matrix);
    if (!scale) transform->fail("a sphere must stay a sphere: use the same scale for all axes and no shear");
    sphere.center = DVec3(matrix * glm::dvec4(sphere.center, 1.0));
    sphere.radius *= *scale;
  }
  build.scene.spheres.push_back(std::move(sphere));
}

void read_plane(const JsonNode& node, JsonBuild& build) {
  Plane plane;
  plane.name = read_name(node);
  plane.point = read_vector(node.at("point"));
  plane.normal = read_direction(node.at("normal"));
  plane.material = read_material_of(node, build);
  const Material& material = build.scene.materials[plane.material];
  refuse_textures(node, material, "plane");
  if (material.emission != Vec3(0.0F)) {
    node.at("material")
        .fail(fmt::format("a plane is unbounded and cannot emit, but material {} does; use a quad",
                          in_quotes(material.name)));
  }
  if (const auto transform = node.find("transform")) {
    const DMat4 matrix = read_transform(*transform);
    const auto scale = similarity_scale(matrix);
    constexpr double kUnit = 1e-5;  // as the similarity itself
    if (!scale || std::abs(*scale - 1.0) > kUnit) transform->fail("a plane can only be moved and turned, not scaled");
    plane.point = DVec3(matrix * glm::dvec4(plane.point, 1.0));
    plane.normal = glm::normalize(DVec3(matrix * glm::dvec4(plane.normal, 0.0)));
  }
  build.scene.planes.push_back(std::move(plane));
}

}  // namespace

void refuse_textures(const JsonNode& node, const Material& material, std::string_view kind) {
  if (!has_texture(material)) return;
  node.at("material")
      .fail(fmt::format("a {} has no texture coordinates, but material {} has a texture", kind,
                        in_quotes(material.name)));
}

std::string read_name(const JsonNode& node) {
  const auto name = node.find("name");
  return name ? read_string(*name) : std::string();
}

void read_object(const JsonNode& node, JsonBuild& build) {
  if (!node.is_object()) node.fail("expected an object of the scene, found " + describe(node.value()));
  const std::string_view type = json_object_types()[read_choice(node.at("type"), json_object_types())];
  check_keys(node, type);
  if (type == "mesh") {
    read_mesh_object(node, build);
  } else if (type == "quad") {
    read_quad(node, build);
  } else if (type == "plane") {
    read_plane(node, build);
  } else if (type == "sphere") {
    read_sphere(node, build);
  } else if (type == "box") {
    read_box(node, build);
  } else {
    read_shape_object(node, type, build);
  }
}

}  // namespace hemiray

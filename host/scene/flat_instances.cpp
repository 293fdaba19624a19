#include "host/scene/flat_instances.hpp"

#include <fmt/format.h>

#include "host/base/error.hpp"
#include "host/base/numbers.hpp"

namespace hemiray {
namespace {

constexpr std::size_t kMaxElements = std::size_t{1} << 30U;
constexpr std::uint64_t kMaxIds = (std::uint64_t{1} << 31U) - 1;        // signed in the kernels of packets
constexpr std::uint64_t kMaxInstances = (std::uint64_t{1} << 27U) - 2;  // in a leaf's reference, shared/bvh_types.h
constexpr std::uint32_t kUnplaced = 0xffffffffU;

void append3(std::vector<float>& to, Vec3 v) { to.insert(to.end(), {v.x, v.y, v.z}); }

// Row `row` of a matrix, and w.
shared::float4 row_of(const glm::dmat3& m, int row, double w) {
  return {static_cast<float>(m[0][row]), static_cast<float>(m[1][row]), static_cast<float>(m[2][row]),
          static_cast<float>(w)};
}

void append_mesh(const Mesh& mesh, const Attributes& needed, FlatScene& flat) {
  check_room(flat, mesh);
  flat.shared_meshes.push_back(
      {static_cast<std::uint32_t>(flat.triangles.size()), static_cast<std::uint32_t>(mesh.triangles.size())});
  const auto first = static_cast<std::uint32_t>(flat.positions.size() / 3);
  for (std::size_t i = 0; i < mesh.positions.size(); i++) {
    append_vertex(flat, needed, mesh.positions[i], mesh.normals.empty() ? Vec3(0.0F) : mesh.normals[i],
                  mesh.uvs.empty() ? Vec2(0.0F) : mesh.uvs[i], mesh.colors.empty() ? Vec3(1.0F) : mesh.colors[i]);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); t++) {
    const UVec3 v = mesh.triangles[t] + first;
    flat.triangles.push_back({v.x, v.y, v.z, mesh.triangle_materials[t]});
  }
}

shared::Instance place(const Object& object) {
  const glm::dmat3 linear(object.to_world), back = glm::inverse(linear);
  const DVec3 translation(object.to_world[3]);
  shared::Instance instance{};
  instance.to_world_x = row_of(linear, 0, translation.x);
  instance.to_world_y = row_of(linear, 1, translation.y);
  instance.to_world_z = row_of(linear, 2, translation.z);
  instance.to_object_x = row_of(back, 0, 0.0);
  instance.to_object_y = row_of(back, 1, 0.0);
  instance.to_object_z = row_of(back, 2, 0.0);
  instance.material = object.material != kNone ? static_cast<std::uint32_t>(object.material) : HR_NO_MATERIAL;
  instance.flags = glm::determinant(linear) < 0.0 ? HR_INSTANCE_MIRRORED : 0U;
  return instance;
}

}  // namespace

void append_vertex(FlatScene& flat, const Attributes& needed, Vec3 position, Vec3 normal, Vec2 uv, Vec3 color) {
  append3(flat.positions, position);
  if (needed.normals) append3(flat.normals, normal);
  if (needed.uvs) flat.uvs.push_back({uv.x, uv.y});
  if (needed.colors) append3(flat.colors, color);
}

void check_room(const FlatScene& flat, const Mesh& mesh) {
  if (flat.positions.size() / 3 + mesh.positions.size() > kMaxElements ||
      flat.triangles.size() + mesh.triangles.size() > kMaxElements) {
    throw DeviceError("the scene has more than 2^30 vertices or triangles; split it");
  }
}

void append_instances(const Scene& scene, const std::vector<bool>& instanced, const Attributes& needed,
                      FlatScene& flat) {
  std::uint64_t next_id = flat.triangles.size() + flat.spheres.size() + flat.shapes.size() + flat.planes.size();
  std::vector<std::uint32_t> place_of(scene.meshes.size(), kUnplaced);  // among the shared meshes
  for (std::size_t i = 0; i < scene.objects.size(); i++) {
    if (!instanced[i]) continue;
    const Object& object = scene.objects[i];
    std::uint32_t& mesh = place_of[object.mesh];
    if (mesh == kUnplaced) {
      mesh = static_cast<std::uint32_t>(flat.shared_meshes.size());
      append_mesh(scene.meshes[object.mesh], needed, flat);
    }
    shared::Instance instance = place(object);
    instance.first_id = static_cast<std::uint32_t>(next_id);
    instance.first_triangle = flat.shared_meshes[mesh].first_triangle;
    instance.triangle_count = flat.shared_meshes[mesh].triangle_count;
    instance.mesh = mesh;
    instance.object = static_cast<std::uint32_t>(i);
    next_id += instance.triangle_count;
    if (next_id > kMaxIds || flat.instances.size() >= kMaxInstances) {
      throw DeviceError(
          fmt::format("the scene has more primitives than can be told apart (2^31, copies counted; object {} of {}); "
                      "place fewer copies, or give several of them as one mesh of fewer triangles",
                      format_count(i + 1), format_count(scene.objects.size())));
    }
    flat.instances.push_back(instance);
  }
}

}  // namespace hemiray

// Objects of "type": "mesh" of a JSON scene: read from a mesh file, or written out as vertices and triangles.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "host/base/spelling.hpp"
#include "host/scene/gltf_reader.hpp"
#include "host/scene/json_build.hpp"
#include "host/scene/json_transform.hpp"
#include "host/scene/load.hpp"
#include "host/scene/mesh_tools.hpp"
#include "host/scene/obj_reader.hpp"
#include "host/scene/ply_reader.hpp"
#include "host/scene/triangulate.hpp"

namespace hemiray {
namespace {

constexpr std::size_t kMaxVertices = std::size_t{1} << 31U;  // indices are 32 bits

// A list of `Vector` (2 or 3 floats); element and component nodes, with their paths, are made only for faults.
template <typename Vector>
std::vector<Vector> read_vectors(const JsonNode& node, double limit) {
  expect_array(node);
  if (node.size() > kMaxVertices) node.fail("too many elements");
  std::vector<Vector> result;
  result.reserve(node.size());
  for (std::size_t i = 0; i < node.size(); ++i) {
    const nlohmann::json& element = node.value()[i];
    Vector vector;
    constexpr auto kSize = static_cast<std::size_t>(Vector::length());
    if (!element.is_array() || element.size() != kSize) expect_array(node[i], kSize);
    for (std::size_t c = 0; c < kSize; ++c) {
      const double value = element[c].is_number() ? element[c].get<double>() : limit * 2.0;
      if (!(std::abs(value) <= limit)) read_number(node[i][c], -limit, limit);  // throws
      vector[static_cast<int>(c)] = static_cast<float>(value);
    }
    result.push_back(vector);
  }
  return result;
}

std::uint32_t read_index(const JsonNode& list, std::size_t face, std::size_t corner, std::size_t vertex_count) {
  const nlohmann::json& value = list.value()[face][corner];
  if (value.is_number_unsigned() && value.get<std::uint64_t>() < vertex_count) return value.get<std::uint32_t>();
  const JsonNode node = list[face][corner];
  const std::int64_t index = read_integer(node, -(std::int64_t{1} << 53U), std::int64_t{1} << 53U);
  if (index < 0 || static_cast<std::uint64_t>(index) >= vertex_count) {
    node.fail(
        fmt::format("vertex index {} is out of range: there are {} vertices, counted from 0", index, vertex_count));
  }
  return static_cast<std::uint32_t>(index);
}

void read_triangles(const JsonNode& list, Mesh& mesh, Scene& scene) {
  expect_array(list);
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!list.value()[i].is_array() || list.value()[i].size() != 3) expect_array(list[i], 3);
    UVec3 t;
    for (std::size_t c = 0; c < 3; ++c) t[static_cast<int>(c)] = read_index(list, i, c, mesh.positions.size());
    if (is_degenerate(mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z])) {
      ++scene.dropped_triangles;
    } else {
      mesh.triangles.push_back(t);
    }
  }
}

void read_polygons(const JsonNode& list, Mesh& mesh, Scene& scene) {
  expect_array(list);
  for (std::size_t i = 0; i < list.size(); ++i) {
    const nlohmann::json& polygon = list.value()[i];
    if (!polygon.is_array() || polygon.size() < 3 || polygon.size() > kMaxFaceCorners) {
      list[i].fail(
          fmt::format("expected an array of 3 to {} vertex indices, found {}", kMaxFaceCorners, describe(polygon)));
    }
    std::vector<std::uint32_t> corners;
    std::vector<Vec3> positions;
    for (std::size_t c = 0; c < polygon.size(); ++c) {
      corners.push_back(read_index(list, i, c, mesh.positions.size()));
      positions.push_back(mesh.positions[corners.back()]);
    }
    std::vector<std::array<std::uint32_t, 3>> triangles;
    scene.dropped_triangles += triangulate(positions, triangles);
    for (const auto& t : triangles) mesh.triangles.emplace_back(corners[t[0]], corners[t[1]], corners[t[2]]);
  }
}

void check_length(const JsonNode& node, const Mesh& mesh) {
  if (node.size() == mesh.positions.size()) return;
  node.fail(fmt::format("has {} elements, but there are {} vertices", node.size(), mesh.positions.size()));
}

void read_inline_mesh(const JsonNode& node, JsonBuild& build, Object object) {
  Mesh mesh;
  mesh.name = object.name;
  mesh.positions = read_vectors<Vec3>(node.at("vertices"), kMaxCoordinate);
  if (const auto normals = node.find("normals")) {
    mesh.normals = read_vectors<Vec3>(*normals, kMaxCoordinate);
    check_length(*normals, mesh);
    for (Vec3& normal : mesh.normals) normal = normalized_or_zero(DVec3(normal));
  }
  if (const auto uvs = node.find("uvs")) {
    mesh.uvs = read_vectors<Vec2>(*uvs, 1e6);
    check_length(*uvs, mesh);
  }
  const auto triangles = node.find("triangles");
  const auto polygons = node.find("polygons");
  if (!triangles && !polygons) node.fail("missing key \"triangles\" (or \"polygons\")");
  if (triangles) read_triangles(*triangles, mesh, build.scene);
  if (polygons) read_polygons(*polygons, mesh, build.scene);
  const std::uint32_t material = read_material_of(node, build);
  if (mesh.uvs.empty() && has_texture(build.scene.materials[material])) {
    node.fail(
        fmt::format("missing key \"uvs\": material {} has a texture", in_quotes(build.scene.materials[material].name)));
  }
  mesh.triangle_materials.assign(mesh.triangles.size(), material);
  object.mesh = static_cast<std::uint32_t>(build.scene.meshes.size());
  build.scene.meshes.push_back(std::move(mesh));
  build.scene.objects.push_back(std::move(object));
}

Scene load_mesh_file(const JsonNode& node, const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".obj") return load_obj(path);
  if (extension == ".ply") return load_ply(path);
  if (extension == ".gltf" || extension == ".glb") return load_gltf(path);
  node.fail(fmt::format("unknown kind of mesh file {}; known: .obj, .ply, .gltf, .glb", in_quotes(extension)));
}

// Moves the contents of a mesh file into the scene, its indices shifted past those already there.
MergedFile merge(Scene file, const std::string& name, Scene& scene) {
  const auto texture_offset = static_cast<int>(scene.textures.size());
  const auto material_offset = static_cast<std::uint32_t>(scene.materials.size());
  const auto mesh_offset = static_cast<std::uint32_t>(scene.meshes.size());
  MergedFile merged;
  for (Material& material : file.materials) {
    for (int* texture : {&material.kd_texture, &material.metallic_roughness_texture, &material.emission_texture,
                         &material.normal_texture}) {
      if (*texture != kNone) *texture += texture_offset;
    }
    scene.materials.push_back(std::move(material));
  }
  for (Texture& texture : file.textures) scene.textures.push_back(std::move(texture));
  for (Mesh& mesh : file.meshes) {
    for (std::uint32_t& material : mesh.triangle_materials) material += material_offset;
    merged.has_uvs = merged.has_uvs && !mesh.uvs.empty();
    scene.meshes.push_back(std::move(mesh));
  }
  for (Object& object : file.objects) {
    object.mesh += mesh_offset;
    if (object.material != kNone) object.material += static_cast<int>(material_offset);
    merged.objects.push_back(std::move(object));
  }
  scene.dropped_triangles += file.dropped_triangles;
  for (const std::string& note : file.notes) {
    // Readers may name their file themselves.
    scene.notes.push_back(note.starts_with(name) ? note : name + ": " + note);
  }
  if (file.has_camera) scene.notes.push_back(name + ": its cameras are ignored, the scene file has its own");
  if (!file.lights.empty()) scene.notes.push_back(name + ": its lights are ignored, the scene file has its own");
  return merged;
}

void read_file_mesh(const JsonNode& node, JsonBuild& build, const Object& placement) {
  const JsonNode file_node = node.at("file");
  for (const char* key : {"vertices", "triangles", "polygons", "normals", "uvs"}) {
    if (const auto other = node.find(key)) other->fail("does not go with \"file\": the mesh is in the file");
  }
  const std::filesystem::path path = read_file_path(file_node, build);
  auto known = build.mesh_files.find(path.string());
  if (known == build.mesh_files.end()) {
    MergedFile merged = merge(load_mesh_file(file_node, path), path.filename().string(), build.scene);
    known = build.mesh_files.emplace(path.string(), std::move(merged)).first;
  }
  int material = kNone;
  if (node.find("material")) {
    material = static_cast<int>(read_material_of(node, build));
    const Material& named = build.scene.materials[static_cast<std::size_t>(material)];
    if (has_texture(named) && !known->second.has_uvs) {
      node.at("material")
          .fail(
              fmt::format("material {} has a texture, but the file has no texture coordinates", in_quotes(named.name)));
    }
  }
  for (Object object : known->second.objects) {
    object.to_world = placement.to_world * object.to_world;
    if (material != kNone) object.material = material;
    if (!placement.name.empty()) {
      object.name = object.name.empty() ? placement.name : placement.name + "/" + object.name;
    }
    build.scene.objects.push_back(std::move(object));
  }
}

}  // namespace

std::filesystem::path read_file_path(const JsonNode& node, const JsonBuild& build) {
  const std::string name = read_string(node);
  if (name.empty()) node.fail("an empty file name");
  if (build.folder.empty()) node.fail("this scene must not name other files");
  const std::filesystem::path path = (build.folder / name).lexically_normal();
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) node.fail("no such file: " + in_quotes(path.string()));
  return path;
}

void read_mesh_object(const JsonNode& node, JsonBuild& build) {
  Object placement;
  placement.name = read_name(node);
  if (const auto transform = node.find("transform")) placement.to_world = read_transform(*transform);
  if (node.find("file")) {
    read_file_mesh(node, build, placement);
  } else if (node.find("vertices")) {
    read_inline_mesh(node, build, std::move(placement));
  } else {
    node.fail("missing key \"file\" (or \"vertices\" and \"triangles\")");
  }
}

}  // namespace hemiray

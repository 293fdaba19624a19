// Primitives of all triangle modes into one mesh, keeping only vertices that triangles use.
#include "host/scene/gltf_meshes.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "host/scene/mesh_tools.hpp"
#include "host/scene/triangulate.hpp"

namespace hemiray {

namespace {

enum class Mode { triangles = 4, strip = 5, fan = 6 };

// True if any primitive of the mesh has an attribute whose name starts like that.
bool any_attribute(const JsonNode& primitives, std::string_view prefix) {
  for (const nlohmann::json& primitive : primitives.value()) {
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object()) continue;
    for (const auto& [name, value] : attributes->items()) {
      if (name.starts_with(prefix)) return true;
    }
  }
  return false;
}

}  // namespace

struct GltfMeshes::Primitive {
  const GltfAccessor& positions;
  std::optional<GltfAccessor> normals;
  std::optional<GltfAccessor> uvs;
  std::optional<GltfAccessor> colors;
  std::optional<GltfAccessor> indices;
  std::uint32_t material = 0;

  [[nodiscard]] std::size_t corners() const { return indices ? indices->count() : positions.count(); }
  [[nodiscard]] std::uint32_t corner(std::size_t i) const {
    if (!indices) return static_cast<std::uint32_t>(i);
    const std::uint32_t vertex = indices->index(i);
    if (vertex >= positions.count()) {
      indices->node().fail("element " + std::to_string(i) + ": vertex " + std::to_string(vertex) +
                           " does not exist; there are " + std::to_string(positions.count()));
    }
    return vertex;
  }
};

std::optional<std::uint32_t> GltfMeshes::load(std::size_t index) {
  const auto known = loaded_.find(index);
  if (known != loaded_.end()) return known->second;
  const std::optional<std::uint32_t> mesh = build(document_.item("meshes", index));
  loaded_.emplace(index, mesh);
  return mesh;
}

std::optional<std::uint32_t> GltfMeshes::build(const JsonNode& node) {
  const JsonNode primitives = node.at("primitives");
  expect_array(primitives);
  Mesh mesh;
  mesh.name = name_of(node);
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const JsonNode primitive = primitives[i];
    if (!primitive.is_object()) primitive.fail("expected an object, found " + describe(primitive.value()));
    add_primitive(primitive, mesh);
  }
  // Filled in step with positions; kept only if some primitive has them.
  if (!any_attribute(primitives, "NORMAL")) mesh.normals.clear();
  if (!any_attribute(primitives, "TEXCOORD_")) mesh.uvs.clear();
  if (!any_attribute(primitives, "COLOR_0")) mesh.colors.clear();
  if (mesh.triangles.empty()) return std::nullopt;
  mark_rectangle(mesh);
  scene_.meshes.push_back(std::move(mesh));
  return static_cast<std::uint32_t>(scene_.meshes.size() - 1);
}

std::optional<GltfAccessor> GltfMeshes::attribute(const JsonNode& attributes, const std::string& name,
                                                  int min_components, int max_components, std::size_t count) {
  const std::optional<JsonNode> reference = attributes.find(name);
  if (!reference) return std::nullopt;
  GltfAccessor accessor(document_, document_.index_of(*reference, "accessors"));
  if (accessor.components() < min_components || accessor.components() > max_components) {
    reference->fail("the accessor has " + std::to_string(accessor.components()) + " components; " + name + " needs " +
                    std::to_string(min_components) +
                    (max_components > min_components ? " or " + std::to_string(max_components) : ""));
  }
  if (accessor.count() != count) {
    reference->fail("the accessor has " + std::to_string(accessor.count()) + " elements, POSITION has " +
                    std::to_string(count));
  }
  return accessor;
}

void GltfMeshes::add_primitive(const JsonNode& node, Mesh& mesh) {
  const std::int64_t mode = integer_or(node, "mode", 4, 0, 6);
  if (mode < 4) {
    document_.note("primitives that are points or lines are ignored");
    return;
  }
  if (node.find("targets")) document_.note("morph targets are ignored: the rest pose is used");
  const JsonNode attributes = object_at(node, "attributes");
  const std::optional<JsonNode> position_node = attributes.find("POSITION");
  if (!position_node) {
    document_.note("primitives without POSITION are ignored");
    return;
  }
  const GltfAccessor positions(document_, document_.index_of(*position_node, "accessors"));
  if (positions.components() != 3) position_node->fail("POSITION needs an accessor of type VEC3");
  const GltfMaterial material = materials_.of_primitive(node);
  const std::size_t count = positions.count();
  if (count > std::size_t{kMaxGltfTriangles} * 3) position_node->fail("too many vertices");
  const std::string uv_name = "TEXCOORD_" + std::to_string(std::max(material.tex_coord, 0));
  Primitive primitive{positions,
                      attribute(attributes, "NORMAL", 3, 3, count),
                      attribute(attributes, uv_name, 2, 2, count),
                      attribute(attributes, "COLOR_0", 3, 4, count),
                      std::nullopt,
                      material.index};
  if (material.tex_coord != kNone && !primitive.uvs) {
    document_.note("a primitive lacks the " + uv_name + " its textures want: their top left texel is used");
  }
  if (const std::optional<JsonNode> indices = node.find("indices")) {
    primitive.indices.emplace(document_, document_.index_of(*indices, "accessors"));
    if (!primitive.indices->is_unsigned_integer() || primitive.indices->components() != 1) {
      indices->fail("indices need a SCALAR accessor of type 5121, 5123 or 5125");
    }
  }
  if (remap_.size() < count) remap_.resize(count);
  ++stamp_;

  const std::size_t corners = primitive.corners();
  const auto at = [&primitive](std::size_t i) { return primitive.corner(i); };
  if (static_cast<Mode>(mode) == Mode::triangles) {
    if (corners % 3 != 0) node.fail(std::to_string(corners) + " corners do not make whole triangles");
    for (std::size_t i = 0; i < corners; i += 3) add_triangle(primitive, {at(i), at(i + 1), at(i + 2)}, mesh);
    return;
  }
  for (std::size_t i = 0; i + 2 < corners; ++i) {
    if (static_cast<Mode>(mode) == Mode::fan) {
      add_triangle(primitive, {at(0), at(i + 1), at(i + 2)}, mesh);
    } else {  // every other triangle of a strip runs the other way round
      add_triangle(primitive, {at(i), at(i + 1 + i % 2), at(i + 2 - i % 2)}, mesh);
    }
  }
}

void GltfMeshes::add_triangle(const Primitive& primitive, const UVec3& corners, Mesh& mesh) {
  if (++triangles_ > kMaxGltfTriangles) {
    document_.root().fail("more than " + std::to_string(kMaxGltfTriangles) + " triangles");
  }
  const Vec3 a(primitive.positions.value(corners.x));
  const Vec3 b(primitive.positions.value(corners.y));
  const Vec3 c(primitive.positions.value(corners.z));
  if (!is_finite(a) || !is_finite(b) || !is_finite(c) || is_degenerate(a, b, c)) {
    ++scene_.dropped_triangles;
    return;
  }
  // Braces, because they are evaluated from left to right.
  mesh.triangles.push_back(UVec3{add_vertex(primitive, corners.x, mesh), add_vertex(primitive, corners.y, mesh),
                                 add_vertex(primitive, corners.z, mesh)});
  mesh.triangle_materials.push_back(primitive.material);
}

std::uint32_t GltfMeshes::add_vertex(const Primitive& primitive, std::uint32_t corner, Mesh& mesh) {
  Remap& remap = remap_[corner];
  if (remap.stamp == stamp_) return remap.vertex;
  remap = {stamp_, static_cast<std::uint32_t>(mesh.positions.size())};
  mesh.positions.emplace_back(primitive.positions.value(corner));
  mesh.normals.push_back(primitive.normals ? normalized_or_zero(DVec3(primitive.normals->value(corner))) : Vec3(0.0F));
  Vec2 uv = primitive.uvs ? Vec2(primitive.uvs->value(corner)) : Vec2(0.0F);
  if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) {
    document_.note("non-finite texture coordinates are taken as 0");
    uv = Vec2(0.0F);
  }
  mesh.uvs.push_back(uv);
  Vec3 color = primitive.colors ? Vec3(primitive.colors->value(corner)) : Vec3(1.0F);
  for (int i = 0; i < 3; ++i) {
    if (color[i] >= 0.0F && color[i] <= 1.0F) continue;
    document_.note("vertex colours outside [0,1] are clamped");
    color[i] = color[i] > 1.0F ? 1.0F : 0.0F;  // NaN too becomes 0
  }
  mesh.colors.push_back(color);
  return remap.vertex;
}

}  // namespace hemiray

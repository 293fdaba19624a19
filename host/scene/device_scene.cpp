#include "host/scene/device_scene.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include "host/scene/features.hpp"
#include "shared/scene_buffers.def"

namespace hemiray {
namespace {

std::vector<float> srgb_table() {
  std::vector<float> table(256);
  for (std::size_t i = 0; i < table.size(); i++) {
    const double c = static_cast<double>(i) / 255.0;
    table[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
  }
  return table;
}

template <typename T>
Buffer<T> upload_if(bool needed, Context& context, const char* name, const std::vector<T>& data) {
  return needed ? Buffer<T>(context, name, std::span<const T>(data)) : Buffer<T>();
}

template <typename T>
std::uint64_t bytes_of(const std::vector<T>& data) {
  return std::max<std::uint64_t>(data.size(), 1) * sizeof(T);
}

}  // namespace

std::uint64_t predict_scene_bytes(const FlatScene& flat, std::uint32_t features) {
  const auto if_on = [features](std::uint32_t feature, std::uint64_t bytes) {
    return has_feature(features, feature) ? bytes : 0;
  };
  constexpr std::uint64_t kSrgbTable = 256 * sizeof(float);
  return bytes_of(flat.positions) + bytes_of(flat.triangles) + bytes_of(flat.spheres) + bytes_of(flat.shapes) +
         bytes_of(flat.materials) + if_on(HR_FEATURE_TRIANGLES, bytes_of(flat.triangle_objects)) +
         if_on(HR_FEATURE_SMOOTH_NORMALS, bytes_of(flat.normals)) +
         if_on(HR_FEATURE_VERTEX_COLORS, bytes_of(flat.colors)) + if_on(HR_FEATURE_PLANES, bytes_of(flat.planes)) +
         if_on(HR_FEATURE_RADIOSITY, bytes_of(flat.patch_light)) +
         if_on(HR_FEATURE_IMPLICITS, bytes_of(flat.tapes) + sizeof(std::uint32_t)) +
         if_on(HR_FEATURE_INSTANCES, bytes_of(flat.instances)) + if_on(HR_FEATURE_LIGHTS, bytes_of(flat.lights)) +
         if_on(HR_FEATURE_EMITTERS, bytes_of(flat.emitters)) +
         if_on(HR_FEATURE_TEXTURES, bytes_of(flat.uvs) + bytes_of(flat.textures) + bytes_of(flat.texels) + kSrgbTable);
}

DeviceScene::DeviceScene(Context& context, const FlatScene& flat, std::uint32_t features)
    : features_(features),
      triangle_count_(flat.world_triangles()),
      sphere_count_(static_cast<std::uint32_t>(flat.spheres.size())),
      shape_count_(static_cast<std::uint32_t>(flat.shapes.size())),
      plane_count_(static_cast<std::uint32_t>(flat.planes.size())),
      light_count_(static_cast<std::uint32_t>(flat.lights.size())),
      emitter_count_(static_cast<std::uint32_t>(flat.emitters.size())),
      instance_count_(static_cast<std::uint32_t>(flat.instances.size())),
      shared_meshes_(flat.shared_meshes) {
  const auto has = [features](std::uint32_t bit) { return (features & bit) != 0; };
  if (!flat.instances.empty() && !has(HR_FEATURE_INSTANCES)) {
    throw std::logic_error("a scene with instances is uploaded without the feature that shows them");
  }
  const bool textured = has(HR_FEATURE_TEXTURES);
  positions_ = upload_if(true, context, "positions", flat.positions);
  triangles_ = upload_if(true, context, "triangles", flat.triangles);
  spheres_ = upload_if(true, context, "spheres", flat.spheres);
  shapes_ = upload_if(true, context, "shapes", flat.shapes);
  materials_ = upload_if(true, context, "materials", flat.materials);
  triangle_objects_ = upload_if(has(HR_FEATURE_TRIANGLES), context, "triangle_objects", flat.triangle_objects);
  normals_ = upload_if(has(HR_FEATURE_SMOOTH_NORMALS), context, "normals", flat.normals);
  uvs_ = upload_if(textured, context, "uvs", flat.uvs);
  colors_ = upload_if(has(HR_FEATURE_VERTEX_COLORS), context, "colors", flat.colors);
  tapes_ = upload_if(has(HR_FEATURE_IMPLICITS), context, "tapes", flat.tapes);
  patch_light_ = upload_if(has(HR_FEATURE_RADIOSITY), context, "patch_light", flat.patch_light);
  uncertain_roots_ =
      upload_if(has(HR_FEATURE_IMPLICITS), context, "uncertain_roots", std::vector<std::uint32_t>(1, 0U));
  planes_ = upload_if(has(HR_FEATURE_PLANES), context, "planes", flat.planes);
  lights_ = upload_if(has(HR_FEATURE_LIGHTS), context, "lights", flat.lights);
  emitters_ = upload_if(has(HR_FEATURE_EMITTERS), context, "emitters", flat.emitters);
  textures_ = upload_if(textured, context, "textures", flat.textures);
  texels_ = upload_if(textured, context, "texels", flat.texels);
  instances_ = upload_if(has(HR_FEATURE_INSTANCES), context, "instances", flat.instances);
  srgb_to_linear_ = upload_if(textured, context, "srgb_to_linear", srgb_table());
}

Arguments DeviceScene::geometry_arguments() const {
  return arguments(arg("positions", positions_), arg("triangles", triangles_), arg("spheres", spheres_),
                   arg("shapes", shapes_), arg("triangle_count", triangle_count_), arg("sphere_count", sphere_count_));
}

Arguments DeviceScene::geometry_arguments(const TreeInput& input) const {
  return arguments(arg("positions", positions_), arg("triangles", triangles_), arg("spheres", spheres_),
                   arg("shapes", shapes_), arg("sphere_count", sphere_count_),
                   arg("triangle_count", input.triangle_count), arg("first_triangle", input.first_triangle));
}

Arguments DeviceScene::shading_arguments() const {
  Arguments all;
  const Buffer<int> accel_nodes_, accel_blocks_,
      tree_roots_;  // in the list, but the tree's owner adds them: empty here
  const auto bind = [&](std::uint32_t feature, const char* name, const auto& buffer) {
    const bool is_tree = buffer.name().empty();
    if (has_feature(features_, feature) && !is_tree) all.push_back(arg(name, buffer));
  };
#define HR_BIND(feature, type, name) bind(HR_FEATURE_##feature, #name, name##_);
  HR_SCENE_BUFFERS(HR_BIND)
#undef HR_BIND
  if (has_feature(features_, HR_FEATURE_IMPLICITS)) all.push_back(arg("uncertain_roots", uncertain_roots_));
  return all;
}

std::uint64_t DeviceScene::uncertain_roots() const {
  return has_feature(features_, HR_FEATURE_IMPLICITS) ? uncertain_roots_.read()[0] : 0;
}

}  // namespace hemiray

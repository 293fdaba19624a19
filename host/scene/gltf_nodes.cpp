// Node transforms, traversal, cameras and punctual lights.
#include "host/scene/gltf_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <utility>

namespace hemiray {

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kHalfPi = std::numbers::pi / 2.0;
constexpr int kDefaultHeight = 512;  // pixels of a camera's image; the width follows from its aspect ratio
constexpr int kMaxDefaultWidth = 8192;

bool is_finite(const DMat4& matrix) {
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) {
      if (!std::isfinite(matrix[c][r])) return false;
    }
  }
  return true;
}

DMat4 read_matrix(const JsonNode& node) {
  expect_array(node, 16);
  DMat4 matrix;
  for (int i = 0; i < 16; ++i) {
    matrix[i / 4][i % 4] = read_number(node[static_cast<std::size_t>(i)], -kMaxGltfNumber, kMaxGltfNumber);
  }
  // A projective last row would bend straight lines; glTF allows only affine matrices.
  if (matrix[0][3] != 0.0 || matrix[1][3] != 0.0 || matrix[2][3] != 0.0 || matrix[3][3] != 1.0) {
    node.fail("the matrix's last row must be 0 0 0 1");
  }
  return matrix;
}

DMat4 local_transform(const JsonNode& node) {
  const std::optional<JsonNode> matrix = node.find("matrix");
  const std::optional<JsonNode> rotation = node.find("rotation");
  if (matrix) {
    if (rotation || node.find("translation") || node.find("scale")) {
      matrix->fail("a node has either a matrix or translation, rotation and scale, not both");
    }
    return read_matrix(*matrix);
  }
  const DVec3 translation = vector_or(node, "translation", DVec3(0.0), -kMaxGltfNumber, kMaxGltfNumber);
  const DVec3 scale = vector_or(node, "scale", DVec3(1.0), -kMaxGltfNumber, kMaxGltfNumber);
  glm::dquat quaternion(1.0, 0.0, 0.0, 0.0);
  if (rotation) {
    expect_array(*rotation, 4);
    glm::dvec4 q(0.0);
    // Unit length is asked for; this bound leaves room for rounding and keeps squares finite.
    for (int i = 0; i < 4; ++i) q[i] = read_number((*rotation)[static_cast<std::size_t>(i)], -1e6, 1e6);
    if (!(glm::length(q) > 1e-6)) rotation->fail("a rotation must be a quaternion of unit length");
    q = glm::normalize(q);
    quaternion = glm::dquat(q.w, q.x, q.y, q.z);
  }
  DMat4 local = glm::mat4_cast(quaternion);
  for (int c = 0; c < 3; ++c) local[c] *= scale[c];
  local[3] = glm::dvec4(translation, 1.0);
  return local;
}

// The rotation and place of a node without its scale: z axis first, y in the plane it spans with z.
std::optional<DMat4> rigid(const DMat4& to_world) {
  const DVec3 z(to_world[2]);
  const DVec3 x = glm::cross(DVec3(to_world[1]), z);
  const double z_length = glm::length(z);
  const double x_length = glm::length(x);
  if (!(z_length > 0.0) || !(x_length > 0.0) || !std::isfinite(z_length) || !std::isfinite(x_length)) return {};
  const DVec3 z_unit = z / z_length;
  const DVec3 x_unit = x / x_length;
  DMat4 matrix(1.0);
  matrix[0] = glm::dvec4(x_unit, 0.0);
  matrix[1] = glm::dvec4(glm::cross(z_unit, x_unit), 0.0);
  matrix[2] = glm::dvec4(z_unit, 0.0);
  matrix[3] = to_world[3];
  return matrix;
}

int image_width(double aspect) {
  return static_cast<int>(std::clamp(std::round(kDefaultHeight * aspect), 1.0, double{kMaxDefaultWidth}));
}

}  // namespace

void GltfNodes::load() {
  find_parents();
  struct Visit {
    std::size_t node;
    DMat4 parent;
    int depth;
  };
  std::vector<Visit> stack;
  const std::vector<std::size_t> roots = root_nodes();
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) stack.push_back({*root, DMat4(1.0), 1});
  while (!stack.empty()) {
    const Visit visit = stack.back();
    stack.pop_back();
    const JsonNode node = document_.item("nodes", visit.node);
    if (visit.depth > kMaxGltfNodeDepth) {
      node.fail("lies deeper than " + std::to_string(kMaxGltfNodeDepth) + " levels in the node hierarchy");
    }
    const DMat4 to_world = visit.parent * local_transform(node);
    if (!is_finite(to_world)) node.fail("the node's transform is out of range");
    place(node, visit.node, to_world);
    if (const std::optional<JsonNode> children = node.find("children")) {
      for (std::size_t i = children->size(); i-- > 0;) {  // backwards: the stack then hands them out in file order
        stack.push_back({document_.index_of((*children)[i], "nodes"), to_world, visit.depth + 1});
      }
    }
  }
}

void GltfNodes::find_parents() {
  const std::size_t count = document_.count("nodes");
  parents_.assign(count, kNone);
  for (std::size_t i = 0; i < count; ++i) {
    const std::optional<JsonNode> children = document_.item("nodes", i).find("children");
    if (!children) continue;
    expect_array(*children);
    for (std::size_t k = 0; k < children->size(); ++k) {
      const JsonNode reference = (*children)[k];
      int& parent = parents_[document_.index_of(reference, "nodes")];
      if (parent != kNone) {
        reference.fail("node " + describe(reference.value()) + " is already a child of node " + std::to_string(parent));
      }
      parent = static_cast<int>(i);
    }
  }
  // With one parent each, walking up either ends at a root or goes round. Nodes found to end well are not walked again.
  std::vector<std::size_t> walk_of(count, count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t at = i; walk_of[at] == count;) {
      walk_of[at] = i;
      if (parents_[at] == kNone) break;
      at = static_cast<std::size_t>(parents_[at]);
      if (walk_of[at] == i) document_.item("nodes", at).fail("is its own ancestor; the node hierarchy has a cycle");
    }
  }
}

std::vector<std::size_t> GltfNodes::root_nodes() {
  std::vector<std::size_t> roots;
  const std::optional<JsonNode> chosen = document_.root().find("scene");
  if (document_.count("scenes") == 0) {
    if (chosen) static_cast<void>(document_.index_of(*chosen, "scenes"));  // throws: there is none
    document_.note("the file has no scene, all of its root nodes are shown");
    for (std::size_t i = 0; i < parents_.size(); ++i) {
      if (parents_[i] == kNone) roots.push_back(i);
    }
    return roots;
  }
  if (document_.count("scenes") > 1) document_.note("the file has several scenes, only the default one is shown");
  const JsonNode scene = document_.item("scenes", chosen ? document_.index_of(*chosen, "scenes") : 0);
  scene_.title = name_of(scene);
  const std::optional<JsonNode> nodes = scene.find("nodes");
  if (!nodes) return roots;
  expect_array(*nodes);
  std::vector<bool> listed(parents_.size(), false);
  for (std::size_t i = 0; i < nodes->size(); ++i) {
    const JsonNode reference = (*nodes)[i];
    const std::size_t root = document_.index_of(reference, "nodes");
    if (parents_[root] != kNone) {
      reference.fail("node " + std::to_string(root) + " is a child of node " + std::to_string(parents_[root]) +
                     " and so not a root");
    }
    if (listed[root]) reference.fail("node " + std::to_string(root) + " is listed twice");
    listed[root] = true;
    roots.push_back(root);
  }
  return roots;
}

void GltfNodes::place(const JsonNode& node, std::size_t index, const DMat4& to_world) {
  std::string name = name_of(node);
  if (name.empty()) name = "node " + std::to_string(index);
  if (node.find("skin")) document_.note("skins are ignored: the rest pose is used");
  if (const std::optional<JsonNode> mesh = node.find("mesh")) place_mesh(node, *mesh, name, to_world);
  if (const std::optional<JsonNode> reference = node.find("camera")) {
    const JsonNode camera = document_.item("cameras", document_.index_of(*reference, "cameras"));
    if (scene_.has_camera) {
      document_.note("the file has several cameras, the first one in the scene is used");
    } else {
      place_camera(camera, node, to_world);
    }
  }
  if (const std::optional<JsonNode> light = extension(node, "KHR_lights_punctual")) {
    place_light(light->at("light"), name, to_world);
  }
}

void GltfNodes::place_mesh(const JsonNode& node, const JsonNode& reference, const std::string& name,
                           const DMat4& to_world) {
  const std::optional<std::uint32_t> mesh = meshes_.load(document_.index_of(reference, "meshes"));
  if (!mesh) return;
  const double determinant = glm::determinant(glm::dmat3(to_world));
  if (determinant == 0.0) {
    document_.note("node '" + name + "' is flattened by a scale of 0 and left out");
    return;
  }
  if (!std::isfinite(determinant)) node.fail("the node's transform is out of range");
  Object object;
  object.name = name;
  object.mesh = *mesh;
  object.to_world = to_world;
  scene_.objects.push_back(std::move(object));
}

void GltfNodes::place_camera(const JsonNode& camera, const JsonNode& node, const DMat4& to_world) {
  const std::optional<DMat4> frame = rigid(to_world);
  if (!frame) node.fail("the camera's node has a scale of 0");
  Camera result;
  result.to_world = *frame;
  result.height = kDefaultHeight;
  result.width = kDefaultHeight;
  const JsonNode type = camera.at("type");
  const std::string kind = read_string(type);
  if (kind == "perspective") {
    const JsonNode lens = object_at(camera, "perspective");
    const JsonNode yfov = lens.at("yfov");
    const double angle = read_positive(yfov, std::numbers::pi);
    result.fov_y_deg = angle * kDegrees;
    if (result.fov_y_deg >= 180.0) yfov.fail("must be less than pi");
    if (const std::optional<JsonNode> aspect = lens.find("aspectRatio")) {
      result.width = image_width(read_positive(*aspect, 1e6));
    }
  } else if (kind == "orthographic") {
    const JsonNode lens = object_at(camera, "orthographic");
    const double ymag = read_positive(lens.at("ymag"), kMaxCoordinate);
    const double xmag = read_positive(lens.at("xmag"), kMaxCoordinate);
    result.kind = CameraKind::orthographic;
    result.height_m = 2.0 * ymag;
    result.width = image_width(xmag / ymag);
  } else {
    type.fail("unknown camera type; use perspective or orthographic");
  }
  scene_.camera = result;
  scene_.has_camera = true;
}

void GltfNodes::place_light(const JsonNode& reference, const std::string& name, const DMat4& to_world) {
  const std::optional<JsonNode> extensions = extension(document_.root(), "KHR_lights_punctual");
  if (!extensions) reference.fail("the file has no extensions/KHR_lights_punctual/lights");
  const JsonNode lights = extensions->at("lights");
  expect_array(lights);
  const auto index = static_cast<std::size_t>(read_integer(reference, 0, kMaxGltfInteger));
  if (index >= lights.size()) {
    reference.fail("light " + std::to_string(index) + " does not exist; there are " + std::to_string(lights.size()));
  }
  const JsonNode node = lights[index];
  if (!node.is_object()) node.fail("expected an object, found " + describe(node.value()));
  Light light;
  light.name = name_of(node).empty() ? name : name_of(node);
  const JsonNode type = node.at("type");
  const std::string kind = read_string(type);
  if (kind == "directional") {
    light.kind = LightKind::directional;
  } else if (kind == "spot") {
    light.kind = LightKind::spot;
    double inner = 0.0;
    double outer = kHalfPi / 2.0;
    if (node.find("spot")) {
      const JsonNode spot = object_at(node, "spot");
      inner = number_or(spot, "innerConeAngle", inner, 0.0, kHalfPi);
      // Files round pi/2 up in single precision.
      outer = std::min(number_or(spot, "outerConeAngle", outer, 0.0, kHalfPi + 1e-6), kHalfPi);
      if (inner >= outer) spot.fail("innerConeAngle must be less than outerConeAngle");
    }
    light.inner_angle_deg = inner * kDegrees;
    light.outer_angle_deg = outer * kDegrees;
  } else if (kind != "point") {
    type.fail("unknown light type; use point, directional or spot");
  }
  const DVec3 color = vector_or(node, "color", DVec3(1.0), 0.0, kMaxRadiance);
  const double intensity = number_or(node, "intensity", 1.0, 0.0, kMaxRadiance);
  const DVec3 radiant = color * intensity;
  if (std::max({radiant.x, radiant.y, radiant.z}) > kMaxRadiance) node.fail("colour times intensity is out of range");
  light.intensity = Vec3(radiant);
  if (node.find("range")) document_.note("the range of lights is ignored: they fall off with the square of distance");
  light.position = DVec3(to_world[3]);
  if (light.kind != LightKind::point) {
    const DVec3 axis(to_world[2]);
    const double length = glm::length(axis);
    if (!(length > 0.0) || !std::isfinite(length)) reference.fail("the light's node has a scale of 0 along its axis");
    light.direction = -axis / length;
  }
  scene_.lights.push_back(std::move(light));
  scene_.has_lights = true;
}

}  // namespace hemiray

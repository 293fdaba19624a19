// The "camera" object and the elements of "lights" of a JSON scene.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/scene/json_build.hpp"
#include "host/scene/json_keys.hpp"
#include "host/scene/look_at.hpp"

namespace hemiray {
namespace {

constexpr std::int64_t kMaxImageSide = 65536;
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28U;  // one float layer of RGB already takes 3 GiB
constexpr double kMinFovDeg = 0.01;
constexpr double kMaxFovDeg = 179.0;
constexpr int kMaxLightSamples = 1024;  // along one edge
// Directions that differ by less than this (sine of the angle) leave the image's roll to rounding.
constexpr double kParallel = 1e-6;

void place_camera(const JsonNode& node, Scene& scene) {
  const auto position_node = node.find("position");
  const auto target_node = node.find("look_at");
  if (!position_node && !target_node) {
    if (const auto up = node.find("up")) up->fail("needs position and look_at");
    return;  // finish_scene() frames the scene with this size and field of view
  }
  const DVec3 position = read_vector(node.at("position"));
  const DVec3 target = read_vector(node.at("look_at"));
  const auto up_node = node.find("up");
  const DVec3 up = up_node ? read_direction(*up_node) : DVec3(0.0, 1.0, 0.0);
  const double extent = std::max(glm::length(position), glm::length(target));
  const double distance = glm::length(position - target);
  if (!(distance > kParallel * kParallel * extent)) target_node->fail("is the camera's own position");
  if (glm::length(glm::cross(up, (position - target) / distance)) < kParallel) {
    (up_node ? *up_node : node)
        .fail(up_node ? "is parallel to the view direction"
                      : "the default up [0, 1, 0] is parallel to the view direction; give up");
  }
  scene.camera.to_world = look_at_matrix(position, target, up);
  scene.has_camera = true;
}

DVec3 read_edge(const JsonNode& node) {
  const DVec3 edge = read_vector(node);
  if (edge == DVec3(0.0)) node.fail("an edge must not be zero");
  return edge;
}

void read_area(const JsonNode& node, Light& light) {
  light.kind = LightKind::area;
  light.position = read_vector(node.at("corner"));
  light.edge_u = read_edge(node.at("edge_u"));
  light.edge_v = read_edge(node.at("edge_v"));
  const DVec3 normal = glm::cross(light.edge_u, light.edge_v);
  if (!(glm::length(normal) > kParallel * glm::length(light.edge_u) * glm::length(light.edge_v))) {
    node.at("edge_v").fail("is parallel to edge_u: the light has no area");
  }
  light.intensity = read_color(node.at("radiance"), kMaxRadiance);
  if (const auto samples = node.find("samples")) {
    if (samples->is_array()) expect_array(*samples, 2);
    const auto count = [&](std::size_t i) {
      return static_cast<int>(read_integer(samples->is_array() ? (*samples)[i] : *samples, 1, kMaxLightSamples));
    };
    light.samples_u = count(0);
    light.samples_v = count(1);
  }
  if (const auto jitter = node.find("jitter")) light.jitter = read_bool(*jitter);
  if (const auto visible = node.find("visible")) light.visible = read_bool(*visible);
}

void read_spot(const JsonNode& node, Light& light) {
  light.kind = LightKind::spot;
  light.position = read_vector(node.at("position"));
  light.direction = read_direction(node.at("direction"));
  light.intensity = read_color(node.at("intensity"), kMaxRadiance);
  if (const auto outer = node.find("outer_angle")) light.outer_angle_deg = read_positive(*outer, 90.0);
  if (const auto inner = node.find("inner_angle")) {
    light.inner_angle_deg = read_number(*inner, 0.0, 90.0);
    if (light.inner_angle_deg > light.outer_angle_deg) {
      inner->fail(fmt::format("must not exceed outer_angle ({} degrees)", light.outer_angle_deg));
    }
  }
}

}  // namespace

void read_camera(const JsonNode& node, Scene& scene) {
  check_keys(node, "camera");
  Camera& camera = scene.camera;
  const auto fov = node.find("fov");
  if (fov) camera.fov_y_deg = read_number(*fov, kMinFovDeg, kMaxFovDeg);
  if (const auto height = node.find("orthographic_height")) {
    if (fov) height->fail("a camera has either fov or orthographic_height");
    camera.kind = CameraKind::orthographic;
    camera.height_m = read_positive(*height, kMaxCoordinate);
  }
  if (const auto size = node.find("size")) {
    expect_array(*size, 2);
    camera.width = static_cast<int>(read_integer((*size)[0], 1, kMaxImageSide));
    camera.height = static_cast<int>(read_integer((*size)[1], 1, kMaxImageSide));
    if (std::int64_t{camera.width} * camera.height > kMaxPixels) {
      size->fail(fmt::format("more than {} pixels in all", kMaxPixels));
    }
  }
  place_camera(node, scene);
}

Light read_light(const JsonNode& node) {
  if (!node.is_object()) node.fail("expected a light, found " + describe(node.value()));
  const std::string_view type = json_light_types()[read_choice(node.at("type"), json_light_types())];
  check_keys(node, type);
  Light light;
  light.name = read_name(node);
  if (type == "point") {
    light.kind = LightKind::point;
    light.position = read_vector(node.at("position"));
    light.intensity = read_color(node.at("intensity"), kMaxRadiance);
  } else if (type == "directional") {
    light.kind = LightKind::directional;
    light.direction = read_direction(node.at("direction"));
    light.intensity = read_color(node.at("irradiance"), kMaxRadiance);
  } else if (type == "spot") {
    read_spot(node, light);
  } else {
    read_area(node, light);
  }
  return light;
}

}  // namespace hemiray

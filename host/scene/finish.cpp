// Completes a scene: a camera that frames it and a light, where it has none.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/scene/bounds.hpp"
#include "host/scene/emission.hpp"
#include "host/scene/load.hpp"
#include "host/scene/look_at.hpp"

namespace hemiray {
namespace {

// Three-quarter view: from the front, a little right and above. Any length.
const DVec3 kViewFrom{0.55, 0.45, 1.0};
constexpr double kMargin = 1.05;  // air around the bounding sphere
// A scene that is one point, or nothing, is shown as if it had this radius [m].
constexpr double kPointRadius = 1.0;
// A radius below this share of the distance from the origin is lost in float coordinates.
constexpr double kSmallestShare = 1e-4;

constexpr float kDefaultIrradiance = 3.0F;  // W/m^2: white at normal incidence has radiance 3/pi
constexpr float kDefaultAmbient = 0.15F;    // W/m^2/sr
// The way the default light travels in camera space: over the left shoulder, to the right, down and forwards.
const DVec3 kDefaultLightCamera{0.5, -0.7, -1.0};

std::string text(const DVec3& v) { return fmt::format("[{:.4g}, {:.4g}, {:.4g}]", v.x, v.y, v.z); }

void frame(Scene& scene) {
  const WorldBounds bounds = world_bounds(scene);
  const DVec3 center = bounds.empty() ? DVec3(0.0) : bounds.center();
  double radius = bounding_radius(scene, center);
  if (radius == 0.0) radius = kPointRadius;
  radius = kMargin * std::max(radius, kSmallestShare * glm::length(center));
  Camera& camera = scene.camera;
  const double aspect = static_cast<double>(camera.width) / camera.height;
  double distance = 2.0 * radius;
  if (camera.kind == CameraKind::orthographic) {
    camera.height_m = 2.0 * radius / std::min(1.0, aspect);
  } else {
    const double half_y = camera.fov_y_deg * std::numbers::pi / 360.0;
    const double half_x = std::atan(aspect * std::tan(half_y));
    distance = radius / std::sin(std::min(half_x, half_y));
  }
  const DVec3 position = center + distance * glm::normalize(kViewFrom);
  camera.to_world = look_at_matrix(position, center, DVec3(0.0, 1.0, 0.0));
  scene.has_camera = true;
  scene.notes.push_back(fmt::format("no camera in the scene: placed one at {} that looks at {} and sees all of it",
                                    text(position), text(center)));
}

void add_light(Scene& scene) {
  Light light;
  light.name = "default light";
  light.kind = LightKind::directional;
  light.direction = glm::normalize(DVec3(scene.camera.to_world * glm::dvec4(kDefaultLightCamera, 0.0)));
  light.intensity = Vec3(kDefaultIrradiance);
  scene.lights.push_back(std::move(light));
  scene.has_lights = true;
  std::string note = fmt::format(
      "nothing in the scene emits light: added a directional light of {} W/m^2 over the camera's left shoulder",
      kDefaultIrradiance);
  if (scene.ambient == Vec3(0.0F)) {
    scene.ambient = Vec3(kDefaultAmbient);
    note += fmt::format(" and ambient light of {} W/m^2/sr", kDefaultAmbient);
  }
  scene.notes.push_back(std::move(note));
}

}  // namespace

void finish_scene(Scene& scene) {
  if (!scene.has_camera) frame(scene);
  if (!scene.has_lights && scene.lights.empty() && !has_emitters(scene)) add_light(scene);
}

}  // namespace hemiray

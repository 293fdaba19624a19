#include "tests/reference/reference_camera.hpp"

#include <cmath>

namespace hemiray::reference {

Ray camera_ray(const Camera& camera, const ReferenceOptions& options, int x, int y, const glm::dvec2& offset) {
  const double sx = 2.0 * (x + offset.x) / options.width - 1.0;
  const double sy = 1.0 - 2.0 * (y + offset.y) / options.height;
  const double aspect = static_cast<double>(options.width) / options.height;
  glm::dvec4 origin(0.0, 0.0, 0.0, 1.0);
  DVec3 direction(0.0, 0.0, -1.0);
  if (camera.kind == CameraKind::perspective) {
    const double half = std::tan(glm::radians(camera.fov_y_deg) / 2.0);
    direction = {sx * aspect * half, sy * half, -1.0};
  } else {
    origin.x = sx * aspect * camera.height_m / 2.0;
    origin.y = sy * camera.height_m / 2.0;
  }
  Ray ray;
  ray.origin = DVec3(camera.to_world * origin);
  ray.direction = glm::normalize(glm::dmat3(camera.to_world) * direction);
  return ray;
}

}  // namespace hemiray::reference

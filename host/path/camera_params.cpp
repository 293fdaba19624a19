#include "host/path/camera_params.hpp"

#include <cmath>
#include <numbers>

namespace hemiray {
namespace {

shared::float4 column(const DMat4& m, int i, double w) {
  return {static_cast<float>(m[i].x), static_cast<float>(m[i].y), static_cast<float>(m[i].z), static_cast<float>(w)};
}

}  // namespace

void set_camera(shared::RenderParams& params, const Camera& camera, int width, int height) {
  const double aspect = static_cast<double>(width) / height;
  const double half_height = camera.kind == CameraKind::orthographic
                                 ? camera.height_m / 2.0
                                 : std::tan(camera.fov_y_deg * std::numbers::pi / 360.0);
  params.camera_right = column(camera.to_world, 0, half_height * aspect);
  params.camera_up = column(camera.to_world, 1, half_height);
  params.camera_back = column(camera.to_world, 2, 0.0);
  params.camera_position = column(camera.to_world, 3, 0.0);
  params.width = static_cast<std::uint32_t>(width);
  params.height = static_cast<std::uint32_t>(height);
}

}  // namespace hemiray

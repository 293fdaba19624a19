#include "host/bench/view.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "host/bench/flat_mesh.hpp"

namespace hemiray::bench {

View framing_view(const FlatScene& flat) {
  Vec3 lo(std::numeric_limits<float>::max()), hi(std::numeric_limits<float>::lowest());
  for (const shared::uint4& triangle : flat.triangles) {
    for (const std::uint32_t index : {triangle.x, triangle.y, triangle.z}) {
      const Vec3 p = vertex_of(flat, index);
      lo = glm::min(lo, p);
      hi = glm::max(hi, p);
    }
  }
  const Vec3 center = 0.5F * (lo + hi);
  const float radius = 0.5F * glm::length(hi - lo);
  View view;
  view.forward = glm::normalize(Vec3(-1.0F, -0.7F, -0.8F));
  // The sphere around the bounds would fit at 1.6 radii; the scene itself is smaller and shall fill the picture.
  view.eye = center - 1.1F * radius * view.forward;
  view.light = center + radius * Vec3(0.2F, 1.1F, 0.3F);
  return view;
}

View camera_view(const Scene& scene, const FlatScene& flat) {
  View view = framing_view(flat);
  for (const Light& light : scene.lights) {
    if (light.kind == LightKind::directional) continue;
    const bool area = light.kind == LightKind::area;
    view.light = Vec3(area ? light.position + 0.5 * (light.edge_u + light.edge_v) : light.position);
    break;
  }
  if (scene.camera.kind != CameraKind::perspective) return view;
  view.eye = Vec3(scene.camera.to_world[3]);
  view.forward = glm::normalize(Vec3(-scene.camera.to_world[2]));
  view.half_extent = static_cast<float>(std::tan(scene.camera.fov_y_deg * std::numbers::pi / 360.0));
  return view;
}

}  // namespace hemiray::bench

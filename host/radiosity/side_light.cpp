#include "host/radiosity/side_light.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "host/bvh/ray_queries.hpp"
#include "host/scene/features.hpp"

namespace hemiray {
namespace {

constexpr std::uint32_t kDirectPoints = 4;  // HR_DIRECT_POINTS of radiosity/direct.cl
constexpr std::uint32_t kLightFeatures = HR_FEATURE_LIGHTS | HR_FEATURE_POINT_LIGHTS | HR_FEATURE_DIRECTIONAL_LIGHTS |
                                         HR_FEATURE_SPOT_LIGHTS | HR_FEATURE_AREA_LIGHTS;

// Those that are not surfaces of the scene: these are patches already.
std::vector<shared::Light> lights_alone(const FlatScene& flat) {
  std::vector<shared::Light> lights;
  std::copy_if(flat.lights.begin(), flat.lights.end(), std::back_inserter(lights), [](const shared::Light& light) {
    return light.kind != HR_LIGHT_EMITTERS && light.primitive_count == 0;
  });
  return lights;
}

// What they bring to the sides [W/m^2].
std::vector<shared::float4> direct_light(Context& context, AccelBuilder& builder, const FlatScene& flat,
                                         const PatchMesh& mesh) {
  const std::vector<shared::Light> lights = lights_alone(flat);
  if (lights.empty()) return std::vector<shared::float4>(mesh.side_count());
  FlatScene lit = mesh.flat;
  lit.lights = lights;
  const DeviceScene scene(context, lit, HR_FEATURE_TRIANGLES | kLightFeatures);
  const Accel accel(builder, scene);
  Program program(context, "direct light", {"radiosity/direct.cl"}, accel.program_options(scene.features(), false));
  const Buffer<shared::float4> normals(context, "patch normals", std::span(mesh.normals));
  const Buffer<shared::float4> direct(context, "direct light", std::size_t{kDirectPoints} * mesh.side_count());
  shared::RenderParams params = query_params(scene);
  params.light_count = scene.light_count();
  launch(context, program.kernel("radiosity_add_direct"), direct.size(),
         arguments(scene.shading_arguments(), accel.tree_arguments(), arg("patch_normals", normals),
                   arg("direct", direct), arg("count", mesh.side_count()), arg("params", params)));
  const std::vector<shared::float4> points = direct.read();
  std::vector<shared::float4> means(mesh.side_count());
  for (std::size_t i = 0; i < points.size(); i++) {
    shared::float4& mean = means[i / kDirectPoints];
    mean.x += points[i].x / kDirectPoints;
    mean.y += points[i].y / kDirectPoints;
    mean.z += points[i].z / kDirectPoints;
  }
  return means;
}

}  // namespace

SideColors SideLight::with_direct(SideColors irradiance) const {
  for (std::size_t s = 0; s < irradiance.size(); s++) {
    irradiance[s][0] += static_cast<double>(direct[s].x);
    irradiance[s][1] += static_cast<double>(direct[s].y);
    irradiance[s][2] += static_cast<double>(direct[s].z);
  }
  return irradiance;
}

SideLight light_sides(Context& context, AccelBuilder& builder, const FlatScene& flat, PatchMesh& mesh) {
  SideLight light{mesh.emission, direct_light(context, builder, flat, mesh), {}};
  for (std::uint32_t s = 0; s < mesh.side_count(); s++) {
    const shared::float4 rho = mesh.reflectance[s], direct = light.direct[s];
    const shared::float4 tau = mesh.transmittance[s], other = light.direct[s ^ 1U];
    shared::float4& e = mesh.emission[s];
    e = {e.x + rho.x * direct.x + tau.x * other.x, e.y + rho.y * direct.y + tau.y * other.y,
         e.z + rho.z * direct.z + tau.z * other.z, e.w};
    if (e.x > 0.0F || e.y > 0.0F || e.z > 0.0F) light.sources.push_back(s);
  }
  return light;
}

}  // namespace hemiray

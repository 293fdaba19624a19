#include "host/radiosity/radiosity.hpp"

#include <algorithm>
#include <utility>

#include "host/base/clock.hpp"
#include "host/bvh/ray_queries.hpp"
#include "host/scene/features.hpp"

namespace hemiray {
namespace {

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
  const Buffer<shared::float4> direct(context, "direct light", mesh.side_count());
  shared::RenderParams params = query_params(scene);
  params.light_count = scene.light_count();
  launch(context, program.kernel("radiosity_add_direct"), mesh.side_count(),
         arguments(scene.shading_arguments(), accel.tree_arguments(), arg("normals", normals), arg("direct", direct),
                   arg("count", mesh.side_count()), arg("params", params)));
  return direct.read();
}

std::array<double, 3> rgb(const shared::float4& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

}  // namespace

Radiosity compute_radiosity(Context& context, const FlatScene& flat, const RadiosityOptions& options) {
  Radiosity result;
  RadiosityStatistics& statistics = result.statistics;
  double start = steady_ms();
  const auto lap = [&start] {
    const double before = std::exchange(start, steady_ms());
    return start - before;
  };
  result.mesh = make_patch_mesh(flat, options.mesh);
  PatchMesh& mesh = result.mesh;
  statistics.mesh_ms = lap();

  Parallel parallel(context);
  AccelBuilder builder(context, parallel);
  Hemicubes hemicubes(context, parallel, builder, mesh, options.factors.hemicube);
  const std::vector<shared::float4> direct = direct_light(context, builder, flat, mesh);
  std::vector<std::uint32_t> sources;
  const std::vector<shared::float4> own_emission = mesh.emission;
  for (std::uint32_t s = 0; s < mesh.side_count(); s++) {
    const shared::float4 rho = mesh.reflectance[s];
    shared::float4& e = mesh.emission[s];
    e = {e.x + rho.x * direct[s].x, e.y + rho.y * direct[s].y, e.z + rho.z * direct[s].z, e.w};
    if (e.x > 0.0F || e.y > 0.0F || e.z > 0.0F) sources.push_back(s);
  }
  context.finish();
  statistics.tree_ms = lap();

  FactorReport& report = statistics.factors;
  const FactorMatrix matrix = make_form_factors(
      context, parallel, mesh, hemicubes, sources, options.factors, report,
      [&](double fraction) { return !options.on_progress || options.on_progress("form factors", fraction); });
  statistics.interrupted = report.interrupted;
  context.finish();
  statistics.factors_ms = lap();
  statistics.rays = report.cube_rays + report.pair_rays + report.sample_rays;
  statistics.rows = matrix.rows();
  statistics.entries = matrix.entries();
  statistics.factor_bytes = matrix.bytes();

  result.solution = solve_radiosity(context, mesh, matrix, options.solve);
  statistics.solve_ms = lap();
  result.irradiance = result.solution.irradiance;
  for (std::uint32_t s = 0; s < mesh.side_count(); s++) {
    const auto area = static_cast<double>(mesh.normals[s / 2].w);
    const std::array<double, 3> rho = rgb(mesh.reflectance[s]), e = rgb(own_emission[s]), d = rgb(direct[s]);
    for (std::size_t c = 0; c < 3; c++) {
      result.irradiance[s][c] += d[c];
      statistics.emitted_w += area * (e[c] + d[c]);
      statistics.absorbed_w += area * (1.0 - rho[c]) * result.irradiance[s][c];
    }
  }
  statistics.peak_bytes = context.peak_bytes();
  return result;
}

}  // namespace hemiray

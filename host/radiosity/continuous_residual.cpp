#include "host/radiosity/continuous_residual.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/rng.hpp"
#include "host/bvh/ray_queries.hpp"

namespace hemiray {
namespace {

constexpr std::uint32_t kStrata = 12;  // squared: rays of each of the two estimates at a point
constexpr double kConfidence = 1.96;   // standard errors: 95 %
constexpr std::uint32_t kSideDimension = 106;

// Sides by area, one a stratum: the spread that the interval is made from is then no less than the true one.
std::vector<std::uint32_t> choose_sides(const PatchMesh& mesh, const std::vector<std::array<double, 3>>& radiosity,
                                        std::uint32_t samples, std::uint32_t seed_key) {
  std::vector<std::uint32_t> lit;
  std::vector<double> up_to;
  double area = 0.0;
  for (std::uint32_t s = 0; s < mesh.side_count(); s++) {
    const auto& b = radiosity[s];
    if (b[0] <= 0.0 && b[1] <= 0.0 && b[2] <= 0.0) continue;
    area += static_cast<double>(mesh.normals[s / 2].w);
    lit.push_back(s);
    up_to.push_back(area);
  }
  std::vector<std::uint32_t> sides;
  for (std::uint32_t k = 0; k < samples && !lit.empty(); k++) {
    const double u = static_cast<double>(rng_unit(rng_hash({k, 0, 0, kSideDimension ^ seed_key})[0]));
    const double at = area * (static_cast<double>(k) + u) / static_cast<double>(samples);
    const auto found = std::upper_bound(up_to.begin(), up_to.end(), at);
    sides.push_back(lit[std::min<std::size_t>(static_cast<std::size_t>(found - up_to.begin()), lit.size() - 1)]);
  }
  return sides;
}

}  // namespace

ContinuousResidual find_continuous_residual(Context& context, const Hemicubes& hemicubes, const PatchMesh& mesh,
                                            const std::vector<std::array<double, 3>>& radiosity, std::uint32_t samples,
                                            std::uint32_t seed) {
  ContinuousResidual result;
  const std::uint32_t seed_key = seed * 0x9E3779B9U;
  const std::vector<std::uint32_t> chosen = choose_sides(mesh, radiosity, samples, seed_key);
  if (chosen.size() < 2) return result;
  result.samples = samples;
  result.rays = 2 * kStrata * kStrata;
  std::vector<shared::float4> constant;
  for (const auto& b : radiosity) {
    constant.push_back({static_cast<float>(b[0]), static_cast<float>(b[1]), static_cast<float>(b[2]), 0.0F});
  }
  const DeviceScene& scene = hemicubes.scene();
  const Accel& accel = hemicubes.accel();
  Program program(context, "continuous residual", {"radiosity/continuous.cl"},
                  accel.program_options(scene.features(), false));
  const Buffer<shared::float4> normals(context, "patch normals", std::span(mesh.normals)),
      emission(context, "emission", std::span(mesh.emission)),
      reflectance(context, "reflectance", std::span(mesh.reflectance)),
      transmittance(context, "transmittance", std::span(mesh.transmittance)),
      light(context, "radiosity", std::span<const shared::float4>(constant)),
      products(context, "squares of residuals", samples);
  const Buffer<std::uint32_t> sides(context, "sides to probe", std::span<const std::uint32_t>(chosen));
  launch(
      context, program.kernel("radiosity_probe_residual"), samples,
      arguments(scene.shading_arguments(), accel.tree_arguments(), arg("patch_normals", normals), arg("sides", sides),
                arg("emission", emission), arg("reflectance", reflectance), arg("transmittance", transmittance),
                arg("radiosity", light), arg("count", samples), arg("strata", kStrata), arg("seed_key", seed_key),
                arg("products", products), arg("params", query_params(scene))));
  double sum = 0.0, squares = 0.0, light_squares = 0.0;
  for (const shared::float4& p : products.read()) {
    const double square = (static_cast<double>(p.x) + static_cast<double>(p.y) + static_cast<double>(p.z)) / 3.0;
    sum += square;
    squares += square * square;
  }
  for (const std::uint32_t s : chosen) {
    for (const double b : radiosity[s]) light_squares += b * b / 3.0;
  }
  const double n = samples, mean = sum / n;
  const double error = kConfidence * std::sqrt(std::max(0.0, (squares / n - mean * mean) / (n - 1.0)));
  const auto root = [](double square) { return std::sqrt(std::max(0.0, square)); };
  result.rms = root(mean);
  result.rms_low = root(mean - error);
  result.rms_high = root(mean + error);
  result.radiosity_rms = root(light_squares / n);
  return result;
}

}  // namespace hemiray

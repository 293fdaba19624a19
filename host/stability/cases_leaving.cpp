// Rays that leave a surface: they must not meet it again, nor pass the next one.
#include <cmath>
#include <utility>

#include "host/bench/flat_mesh.hpp"
#include "host/stability/rung.hpp"
#include "host/stability/shapes.hpp"

namespace hemiray::stability {
namespace {

Rung solid(std::string name, FlatScene flat, Vec3 center, float radius) {
  Rung rung;
  rung.name = std::move(name);
  rung.kind = RungKind::leaving;
  rung.rays = at_triangles(flat, {{center, 2.0F * radius, 4.0F * radius, false}, {center, 0.0F, 0.2F * radius, true}});
  rung.flat = std::move(flat);
  return rung;
}

Rung ball(std::string name, double radius, double at) {
  FlatScene flat = bench::FlatMesh().take();
  const DVec3 center = at * DVec3(1.0, -0.7, 0.3);
  shared::Sphere sphere{};
  const Vec3 c(center);
  sphere.center_radius = {c.x, c.y, c.z, static_cast<float>(radius)};
  flat.spheres.push_back(sphere);
  // At a mesh around the sphere and as large.
  const FlatScene around = moved(icosahedron(), DVec3(radius), center);
  const auto r = static_cast<float>(radius);
  Rung rung;
  rung.name = std::move(name);
  rung.kind = RungKind::leaving;
  rung.rays = at_triangles(around, {{c, 2.0F * r, 4.0F * r, false}, {c, 0.0F, 0.5F * r, true}});
  rung.flat = std::move(flat);
  return rung;
}

// Two sheets, the second behind the first as seen from where the rays start, `gap` apart, `at` from the origin.
Rung layers(std::string name, double gap, double at) {
  const DVec3 offset = at * DVec3(0.577, 0.577, 0.577);
  const FlatScene first = moved(askew(moved(sheet(3), DVec3(0.5))), DVec3(1.0), offset);
  const FlatScene tilted = askew(moved(sheet(3), DVec3(0.5), {0.0, 0.0, 1.0}));
  const DVec3 along =
      DVec3(bench::vertex_of(tilted, 0)) - DVec3(bench::vertex_of(askew(moved(sheet(3), DVec3(0.5))), 0));
  FlatScene flat = first;
  append(flat, moved(first, DVec3(1.0), gap * along));
  Rung rung;
  rung.name = std::move(name);
  rung.kind = RungKind::leaving;
  rung.after = After::layer;
  rung.rays = through_first_layer(flat, along, offset);
  rung.flat = std::move(flat);
  return rung;
}

}  // namespace

std::vector<Case> leaving_cases() {
  Case scale{"leaving, scale",
             "Rays go on, to either side, from an icosahedron of that radius: outside they meet nothing, inside the "
             "far side.",
             {}};
  constexpr std::pair<const char*, double> kScales[] = {
      {"1e-6", 1e-6}, {"1e-3", 1e-3}, {"1", 1.0}, {"1e3", 1e3}, {"1e6", 1e6}};
  for (const auto& [name, value] : kScales) {
    scale.rungs.emplace_back(
        [=] { return solid(name, moved(icosahedron(), DVec3(value)), Vec3(0.0F), static_cast<float>(value)); });
  }
  Case translation{"leaving, translation", "The same from one of radius 4 so far from the origin.", {}};
  constexpr std::pair<const char*, double> kOffsets[] = {{"0", 0.0},   {"1e2", 1e2}, {"1e3", 1e3}, {"1e4", 1e4},
                                                         {"1e5", 1e5}, {"1e6", 1e6}, {"1e7", 1e7}};
  for (const auto& [name, value] : kOffsets) {
    translation.rungs.emplace_back([=] {
      const DVec3 offset = value * DVec3(1.0, -0.7, 0.3);
      return solid(name, moved(icosahedron(), DVec3(4.0), offset), Vec3(offset), 4.0F);
    });
  }
  Case sphere{"leaving, sphere", "The same from a sphere of that radius at the origin, or at a distance.", {}};
  constexpr std::pair<const char*, double> kRadii[] = {{"1e-3", 1e-3}, {"1", 1.0}, {"1e3", 1e3}, {"1e6", 1e6}};
  for (const auto& [name, value] : kRadii) sphere.rungs.emplace_back([=] { return ball(name, value, 0.0); });
  constexpr std::pair<const char*, double> kFar[] = {{"1 at 1e2", 1e2}, {"1 at 1e4", 1e4}, {"1 at 1e6", 1e6}};
  for (const auto& [name, value] : kFar) sphere.rungs.emplace_back([=] { return ball(name, 1.0, value); });

  Case gap{"gap", "Rays go on through a sheet, 1 from the origin, to the same one behind it at that gap.", {}};
  // Close together about the bound of the hit point's rounding, where the rate falls from all to none.
  constexpr std::pair<const char*, double> kGaps[] = {
      {"1e-2", 1e-2}, {"1e-4", 1e-4},     {"1e-5", 1e-5}, {"4e-6", 4e-6},     {"2e-6", 2e-6}, {"1.4e-6", 1.4e-6},
      {"1e-6", 1e-6}, {"8e-7", 8e-7},     {"7e-7", 7e-7}, {"6e-7", 6e-7},     {"5e-7", 5e-7}, {"4.5e-7", 4.5e-7},
      {"4e-7", 4e-7}, {"3.5e-7", 3.5e-7}, {"3e-7", 3e-7}, {"2.5e-7", 2.5e-7}, {"2e-7", 2e-7}, {"1e-7", 1e-7}};
  for (const auto& [name, value] : kGaps) gap.rungs.emplace_back([=] { return layers(name, value, 1.0); });
  return {std::move(scale), std::move(translation), std::move(sphere), std::move(gap)};
}

}  // namespace hemiray::stability

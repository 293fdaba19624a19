// Where things are and how large.
#include <cmath>
#include <utility>

#include "host/stability/rung.hpp"
#include "host/stability/shapes.hpp"

namespace hemiray::stability {
namespace {

// From outside and, as `inside` says, from near the middle.
Rung solid(std::string name, FlatScene flat, Vec3 center, float radius, bool inside = true) {
  std::vector<Origins> origins{{center, 2.0F * radius, 4.0F * radius, false}};
  if (inside) origins.push_back({center, 0.0F, 0.2F * radius, true});
  Rung rung;
  rung.name = std::move(name);
  rung.rays = at_triangles(flat, std::move(origins));
  rung.flat = std::move(flat);
  return rung;
}

Rung scale_rung(const char* name, double scale) {
  return solid(name, moved(icosahedron(), DVec3(scale)), Vec3(0.0F), static_cast<float>(scale));
}

Rung translation_rung(const char* name, double by) {
  const DVec3 offset = by * DVec3(1.0, -0.7, 0.3);
  return solid(name, moved(icosahedron(), DVec3(4.0), offset), Vec3(offset), 4.0F);
}

// A small triangle before a large one, seen from 1 to 2 m.
Rung sizes_rung(const char* name, double ratio) {
  const double large = std::sqrt(ratio), small = 1.0 / large;
  FlatScene one = sheet(1);
  one.triangles.resize(1);
  one.triangle_objects.resize(1);
  FlatScene flat = askew(moved(one, DVec3(large)));
  append(flat, askew(moved(one, DVec3(small), {0.0, 0.0, 10.0 * small})));
  Rung rung;
  rung.name = name;
  rung.rays = at_triangles(flat, {{Vec3(0.0F), 1.0F, 2.0F, false}});
  rung.flat = std::move(flat);
  return rung;
}

}  // namespace

std::vector<Case> place_cases() {
  Case scale{"scale", "An icosahedron of that radius, from inside and from 2 to 4 radii away.", {}};
  constexpr std::pair<const char*, double> kScales[] = {{"1e-6", 1e-6}, {"1e-4", 1e-4}, {"1e-2", 1e-2}, {"1", 1.0},
                                                        {"1e2", 1e2},   {"1e4", 1e4},   {"1e6", 1e6}};
  for (const auto& [name, value] : kScales) scale.rungs.emplace_back([=] { return scale_rung(name, value); });

  Case translation{
      "translation", "An icosahedron of radius 4, so far from the origin, from inside and from 8 to 16.", {}};
  constexpr std::pair<const char*, double> kOffsets[] = {{"0", 0.0},   {"1e2", 1e2}, {"1e3", 1e3}, {"1e4", 1e4},
                                                         {"1e5", 1e5}, {"1e6", 1e6}, {"1e7", 1e7}};
  for (const auto& [name, value] : kOffsets) {
    translation.rungs.emplace_back([=] { return translation_rung(name, value); });
  }

  Case sizes{
      "sizes", "A triangle 1/so many times as large before another, about 1 in geometric mean, from 1 to 2 away.", {}};
  constexpr std::pair<const char*, double> kRatios[] = {
      {"1", 1.0}, {"1e2", 1e2}, {"1e4", 1e4}, {"1e6", 1e6}, {"1e8", 1e8}};
  for (const auto& [name, value] : kRatios) sizes.rungs.emplace_back([=] { return sizes_rung(name, value); });
  return {std::move(scale), std::move(translation), std::move(sizes)};
}

}  // namespace hemiray::stability

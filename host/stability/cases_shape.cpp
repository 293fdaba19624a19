// Shapes that are thin, touch, close, or are looked along.
#include <cmath>
#include <utility>

#include "host/bench/leak_meshes.hpp"
#include "host/stability/rung.hpp"
#include "host/stability/shapes.hpp"

namespace hemiray::stability {
namespace {

using bench::Dice;

Rung from_around(std::string name, FlatScene flat, float least, float most) {
  Rung rung;
  rung.name = std::move(name);
  rung.rays = at_triangles(flat, {{Vec3(0.0F), least, most, false}});
  rung.flat = std::move(flat);
  return rung;
}

Rung closed(std::string name, FlatScene flat, Vec3 center, float half_side) {
  Rung rung;
  rung.name = std::move(name);
  rung.rays = at_triangles(flat, {{center, 0.0F, half_side, true}});
  rung.flat = std::move(flat);
  return rung;
}

// Two sheets so many ulps of 1 apart.
Rung sheets(std::string name, int ulps) {
  FlatScene flat = moved(sheet(3), DVec3(1.0), {0.0, 0.0, 1.0});
  append(flat, moved(sheet(2), DVec3(1.0), {0.0, 0.0, 1.0 + ulps * 0x1p-23}));
  return from_around(std::move(name), std::move(flat), 3.0F, 5.0F);
}

Rung touching_boxes() {
  FlatScene flat = bench::closed_mesh(1, false, Vec3(0.0F));
  append(flat, bench::closed_mesh(2, false, Vec3(2.0F, 0.0F, 0.0F)));
  return from_around("touching boxes", askew(std::move(flat)), 5.0F, 9.0F);
}

// In one plane, over each other.
Rung overlapping() {
  FlatScene flat;
  Dice dice(23);
  for (int i = 0; i < 12; i++) {
    const double x = dice.in(-0.5F, 0.5F), y = dice.in(-0.5F, 0.5F);
    FlatScene one = moved(sheet(1), DVec3(dice.in(0.1F, 0.7F)), {x, y, 0.25});
    if (i == 0) {
      flat = std::move(one);
    } else {
      append(flat, one);
    }
  }
  return from_around("overlapping in a plane", std::move(flat), 2.0F, 4.0F);
}

// Along a sheet, at an angle to it: at vertices and points of sides, from a height of the angle times 2.
RayMaker grazing_rays(const FlatScene& flat, double angle) {
  return [positions = flat.positions, triangles = flat.triangles, angle](std::uint32_t count, std::uint32_t seed) {
    Dice dice(seed);
    Rays made;
    Vec3 origin;
    const auto vertex = [&](std::uint32_t i) {
      return DVec3(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]);
    };
    while (made.rays.size() < count) {
      if (made.rays.size() % kRaysFromOnePoint == 0) {
        const double turn = 6.2831853 * dice.unit(), up = dice.one_in(2) ? 1.0 : -1.0;
        origin = Vec3(DVec3(2.5 * std::cos(turn), 2.5 * std::sin(turn), up * 2.0 * angle));
      }
      const shared::uint4 t = triangles[dice.below(static_cast<std::uint32_t>(triangles.size()))];
      const DVec3 a = vertex(t.x), b = vertex(t.y);
      const DVec3 target = dice.one_in(3) ? a : a + static_cast<double>(dice.unit()) * (b - a);
      made.rays.push_back(make_ray(origin, Vec3(target - DVec3(origin))));
      made.inside.push_back(0);
    }
    return made;
  };
}

Rung grazing(std::string name, double angle) {
  Rung rung;
  rung.name = std::move(name);
  rung.flat = sheet(3);
  rung.rays = grazing_rays(rung.flat, angle);
  return rung;
}

}  // namespace

std::vector<Case> shape_cases() {
  Case thin{"slivers", "16 triangles of that aspect side by side, long sides of 1, from 1 to 3 away.", {}};
  constexpr std::pair<const char*, double> kAspects[] = {{"1", 1.0},   {"1e2", 1e2}, {"1e3", 1e3},
                                                         {"1e4", 1e4}, {"1e5", 1e5}, {"1e6", 1e6}};
  for (const auto& [name, value] : kAspects) {
    thin.rungs.emplace_back([=] { return from_around(name, slivers(16, value), 1.0F, 3.0F); });
  }

  // Thick ones beside them, so that 1 triangle in 19 is thin (host/scene/features.cpp).
  Case few{
      "slivers, few", "The same beside 288 thick triangles: so few that t is not mended (docs/architecture.md).", {}};
  for (const auto& [name, value] : kAspects) {
    if (value < 100.0) continue;
    few.rungs.emplace_back([=] {
      FlatScene flat = slivers(16, value);
      append(flat, moved(sheet(12), DVec3(0.5), {0.0, 0.0, -1.0}));
      return from_around(name, std::move(flat), 1.5F, 3.0F);
    });
  }

  Case coplanar{"coplanar", "Two sheets so many ulps apart at a distance of 1 from the origin; then what touches.", {}};
  for (const int ulps : {0, 1, 4, 16, 64, 1024}) {
    coplanar.rungs.emplace_back([=] { return sheets(std::to_string(ulps) + " ulps", ulps); });
  }
  coplanar.rungs.emplace_back(touching_boxes);
  coplanar.rungs.emplace_back(overlapping);

  Case inside{"closed", "Closed meshes from inside: no answer is a leak.", {}};
  inside.rungs.emplace_back([] { return closed("cube", bench::closed_mesh(1, false, Vec3(0.0F)), Vec3(0.0F), 0.7F); });
  inside.rungs.emplace_back(
      [] { return closed("cube askew", askew(bench::closed_mesh(2, false, Vec3(0.0F))), Vec3(0.0F), 0.5F); });
  inside.rungs.emplace_back(
      [] { return closed("ball of 192", bench::closed_mesh(4, true, Vec3(0.0F)), Vec3(0.0F), 0.4F); });
  inside.rungs.emplace_back(
      [] { return closed("ball of 192 at 100", bench::closed_mesh(4, true, Vec3(100.0F)), Vec3(100.0F), 0.4F); });
  inside.rungs.emplace_back([] {
    return closed("ball 1e3 x 1 x 1e-3", moved(bench::closed_mesh(2, true, Vec3(0.0F)), {1e3, 1.0, 1e-3}), Vec3(0.0F),
                  2e-4F);
  });

  Case along{"grazing", "A sheet looked along, at that angle [rad].", {}};
  constexpr std::pair<const char*, double> kAngles[] = {{"1e-1", 1e-1}, {"1e-2", 1e-2}, {"1e-3", 1e-3}, {"1e-4", 1e-4},
                                                        {"1e-5", 1e-5}, {"1e-6", 1e-6}, {"1e-7", 1e-7}};
  for (const auto& [name, value] : kAngles) along.rungs.emplace_back([=] { return grazing(name, value); });
  return {std::move(thin), std::move(few), std::move(coplanar), std::move(inside), std::move(along)};
}

}  // namespace hemiray::stability

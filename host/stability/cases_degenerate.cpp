// Vertices that are no good, and primitives that no tree can tell apart.
#include <algorithm>
#include <limits>
#include <utility>

#include "host/bench/leak_meshes.hpp"
#include "host/stability/rung.hpp"
#include "host/stability/shapes.hpp"

namespace hemiray::stability {
namespace {

using bench::Dice;

std::uint32_t vertex_count(const FlatScene& flat) { return static_cast<std::uint32_t>(flat.positions.size() / 3); }

// A cube whose vertices lie on a grid of 1/2, so that middles of edges are exact, of 192 triangles, and among them as
// many more as make up the share, by `spoil`. From inside.
template <typename Spoil>
Rung spoilt_cube(std::string name, std::size_t more, const Spoil& spoil) {
  FlatScene flat = bench::closed_mesh(4, false, Vec3(0.0F));
  Dice dice(31);
  const std::size_t good = flat.triangles.size();
  for (std::size_t i = 0; i < more; i++) {
    const shared::uint4 t = flat.triangles[dice.below(static_cast<std::uint32_t>(good))];
    spoil(flat, t, dice);
    flat.triangle_objects.push_back(0);
    // Not all behind the good ones.
    std::swap(flat.triangles.back(), flat.triangles[dice.below(static_cast<std::uint32_t>(flat.triangles.size()))]);
  }
  Rung rung;
  rung.name = std::move(name);
  rung.rays = at_triangles(flat, {{Vec3(0.0F), 0.0F, 0.7F, true}});
  rung.flat = std::move(flat);
  return rung;
}

void add_collinear(FlatScene& flat, const shared::uint4& t, Dice& dice) {
  if (dice.one_in(3)) {
    flat.triangles.push_back({t.x, t.x, t.x, 0});
  } else if (dice.one_in(2)) {
    flat.triangles.push_back({t.x, t.y, t.x, 0});
  } else {
    const Vec3 middle = 0.5F * (bench::vertex_of(flat, t.x) + bench::vertex_of(flat, t.y));
    flat.positions.insert(flat.positions.end(), {middle.x, middle.y, middle.z});
    flat.triangles.push_back({t.x, vertex_count(flat) - 1, t.y, 0});
  }
}

void add_not_finite(FlatScene& flat, const shared::uint4& t, Dice& dice) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Vec3 bad = bench::vertex_of(flat, t.x);
  const int axis = static_cast<int>(dice.below(3));
  const std::uint32_t kind = dice.below(3);
  bad[axis] = kind == 0 ? std::numeric_limits<float>::quiet_NaN() : kind == 1 ? kInfinity : -kInfinity;
  flat.positions.insert(flat.positions.end(), {bad.x, bad.y, bad.z});
  flat.triangles.push_back({vertex_count(flat) - 1, t.y, t.z, 0});
}

// A ball so small beside the scene, which two far triangles make 2e6 wide, that all its triangles have one Morton code.
Rung one_code(std::string name, double radius) {
  FlatScene flat = moved(sheet(1), DVec3(1.0), DVec3(1e6));
  append(flat, moved(sheet(1), DVec3(1.0), DVec3(-1e6)));
  const auto first = static_cast<std::uint32_t>(flat.triangles.size());
  append(flat, moved(bench::closed_mesh(4, true, Vec3(0.0F)), DVec3(radius)));
  const auto r = static_cast<float>(radius);
  Rung rung;
  rung.name = std::move(name);
  rung.rays = at_triangles(flat, {{Vec3(0.0F), 2.0F * r, 4.0F * r, false}, {Vec3(0.0F), 0.0F, 0.4F * r, true}}, first);
  rung.flat = std::move(flat);
  return rung;
}

Rung coincident(std::string name, std::uint32_t copies) {
  FlatScene flat = askew(sheet(1));
  const std::vector<shared::uint4> once = flat.triangles;
  while (flat.triangles.size() < copies) flat.triangles.push_back(once[flat.triangles.size() % once.size()]);
  flat.triangle_objects.assign(flat.triangles.size(), 0);
  Rung rung;
  rung.name = std::move(name);
  // A ray visits every one of the copies: a share of the rays, so that many of them are not all the time of a run.
  const std::uint32_t share = std::max(1U, copies / 2000);
  rung.rays = [make = at_triangles(flat, {{Vec3(0.0F), 2.0F, 4.0F, false}}), share](std::uint32_t count,
                                                                                    std::uint32_t seed) {
    const std::uint32_t groups = count / kRaysFromOnePoint;
    return make(std::max(1U, groups / share) * kRaysFromOnePoint, seed);
  };
  rung.flat = std::move(flat);
  return rung;
}

}  // namespace

std::vector<Case> degenerate_cases() {
  constexpr std::pair<const char*, std::size_t> kShares[] = {{"1 of 193", 1}, {"half", 192}, {"9 of 10", 1728}};
  Case collinear{"no area",
                 "A closed cube of 192 triangles, from inside, with triangles of duplicate and collinear "
                 "vertices, so many of all.",
                 {}};
  Case not_finite{"not finite", "The same with triangles of which a vertex is NaN or infinite.", {}};
  for (const auto& [name, more] : kShares) {
    collinear.rungs.emplace_back([=] { return spoilt_cube(name, more, add_collinear); });
    not_finite.rungs.emplace_back([=] { return spoilt_cube(name, more, add_not_finite); });
  }
  Case code{
      "one Morton code", "A ball of 192 triangles of that radius in a scene 2e6 wide, from inside and outside.", {}};
  constexpr std::pair<const char*, double> kRadii[] = {{"1", 1.0}, {"1e-2", 1e-2}, {"1e-4", 1e-4}, {"1e-6", 1e-6}};
  for (const auto& [name, value] : kRadii) code.rungs.emplace_back([=] { return one_code(name, value); });
  Case same{"coincident",
            "So many triangles, every other one the same; rays of the last rung are fewer, as each visits all.",
            {}};
  constexpr std::pair<const char*, std::uint32_t> kCopies[] = {{"10", 10}, {"1e3", 1000}, {"1e5", 100000}};
  for (const auto& [name, value] : kCopies) same.rungs.emplace_back([=] { return coincident(name, value); });
  return {std::move(collinear), std::move(not_finite), std::move(code), std::move(same)};
}

}  // namespace hemiray::stability

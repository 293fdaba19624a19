// The judges of disks, cones, quadrics and implicit surfaces, without a device: what is planted must be found.
#include <catch2/catch.hpp>
#include <cmath>

#include "host/scene/expression.hpp"
#include "host/scene/flat_scene.hpp"
#include "host/stability/implicit_oracle.hpp"
#include "host/stability/judge.hpp"
#include "tests/reference/polynomial_roots.hpp"

namespace hemiray::stability {
namespace {

constexpr shared::QueryHit kNone{0.0F, 0.0F, 0.0F, HR_NO_PRIMITIVE};

FlatScene scene_of(const std::vector<Shape>& shapes) {
  Scene scene;
  scene.materials.emplace_back();
  scene.shapes = shapes;
  return flatten_scene(scene);
}

Shape cylinder(DVec3 at) {
  Shape s;
  s.kind = ShapeKind::cylinder;
  s.radius = s.upper_radius = 1.0;
  s.half_height = 2.0;
  s.to_world[3] = glm::dvec4(at, 1.0);
  return s;
}

Shape implicit(const char* text, double clip) {
  Shape s;
  s.kind = ShapeKind::implicit;
  s.expression = parse_expression(text, {});
  s.clip = Clip::box;
  s.clip_half = DVec3(clip);
  return s;
}

Tally judge_one(const FlatScene& flat, const shared::QueryRay& ray, const shared::QueryHit& answer) {
  Rays rays;
  rays.rays.push_back(ray);
  rays.inside.push_back(0);
  const std::vector<Answers> answers{{{answer}, {}}};
  const Judged judged = judge_all(flat, rays, answers, 1);
  CHECK(judged.missed.size() == judged.tallies[0].missed);
  return judged.tallies[0];
}

std::uint64_t faults(const Tally& t) { return t.missed + t.false_hit + t.wrong_surface; }

}  // namespace

TEST_CASE("cylinders: side, cap and edge are judged within the bound") {
  const FlatScene flat = scene_of({cylinder({0, 0, 0}), cylinder({5, 0, 0})});
  const auto side = [](float t, std::uint32_t primitive) { return shared::QueryHit{t, HR_PART_SIDE, 0, primitive}; };
  const auto across = [](float z) { return make_ray({-3, 0, z}, {1, 0, 0}); };
  const Tally right = judge_one(flat, across(0.5F), side(2, 0));
  CHECK(faults(right) + right.borderline == 0);
  CHECK(judge_one(flat, across(0.5F), side(2.01F, 0)).false_hit == 1);
  CHECK(judge_one(flat, across(0.5F), kNone).missed == 1);
  CHECK(judge_one(flat, across(0.5F), side(4, 0)).wrong_surface == 1);  // the far side
  CHECK(judge_one(flat, across(0.5F), side(7, 1)).wrong_surface == 1);  // the cylinder behind
  CHECK(judge_one(flat, across(0.5F), side(2, 7)).false_hit == 1);      // there is none
  CHECK(judge_one(flat, across(0.5F), {2, HR_PART_UPPER_CAP, 0, 0}).false_hit == 1);
  // At the edge between side and cap a bound's width decides.
  CHECK(judge_one(flat, across(2.0F + 1e-6F), side(2, 0)).borderline == 1);
  CHECK(judge_one(flat, across(2.0F + 1e-4F), side(2, 0)).false_hit == 1);
  CHECK(judge_one(flat, across(2.0F - 1e-6F), kNone).borderline == 1);
  CHECK(judge_one(flat, across(2.0F - 1e-3F), kNone).missed == 1);
  // A silhouette, likewise.
  CHECK(judge_one(flat, make_ray({-3, 1.0F - 1e-6F, 0}, {1, 0, 0}), kNone).borderline == 1);
  CHECK(judge_one(flat, make_ray({-3, 0.99F, 0}, {1, 0, 0}), kNone).missed == 1);
}

TEST_CASE("cylinders: a ray that cuts the edge is judged by how deep it goes in") {
  Shape open = cylinder({0, 0, 0});
  open.capped = false;
  // In by the side, out by the rim's plane, along either at a slope of 1 in 400; deepest half way.
  const auto along_side = [](float way) { return make_ray({-1.0F - 0.01F, 0, 2.0F - way - 4.0F}, {2.5e-3F, 0, 1}); };
  const auto along_cap = [](float way) {
    return make_ray({-1.0F - 4.0F, 0, 2.0F - way / 400.0F - 0.01F}, {1, 0, 2.5e-3F});
  };
  for (const FlatScene& flat : {scene_of({cylinder({0, 0, 0})}), scene_of({open})}) {
    CHECK(judge_one(flat, along_side(2e-3F), kNone).borderline == 1);
    CHECK(judge_one(flat, along_side(0.5F), kNone).missed == 1);
    CHECK(judge_one(flat, along_cap(2e-3F), kNone).borderline == 1);
  }
  const FlatScene closed = scene_of({cylinder({0, 0, 0})});
  CHECK(judge_one(closed, along_cap(0.5F), kNone).missed == 1);
  CHECK(judge_one(closed, along_cap(0.5F), {4, HR_PART_SIDE, 0, 0}).missed == 0);
}

TEST_CASE("implicit surfaces: roots are found, and planted errors") {
  const FlatScene flat = scene_of({implicit("x^2 + y^2 + z^2 - 4", 2.5)});
  const auto ray_at = [](float y) { return make_ray({-3, y, 0}, {1, 0, 0}); };
  const auto hit = [](float t) { return shared::QueryHit{t, 0, 0, 0}; };
  const Tally right = judge_one(flat, ray_at(0), hit(1));
  CHECK(faults(right) + right.borderline == 0);
  CHECK(right.worst_ulps == 0.0);
  CHECK(judge_one(flat, ray_at(0), hit(1.0001F)).false_hit == 1);
  CHECK(judge_one(flat, ray_at(0), hit(5)).missed == 1);
  CHECK(judge_one(flat, ray_at(0), kNone).missed == 1);
  CHECK(judge_one(flat, ray_at(0), {1, 0, 0, 1}).false_hit == 1);
  CHECK(judge_one(flat, ray_at(2.4F), hit(3)).false_hit == 1);
  CHECK(faults(judge_one(flat, ray_at(2.4F), kNone)) == 0);
  // As near as floats come to the tangent plane.
  CHECK(judge_one(flat, ray_at(std::nextafter(2.0F, 0.0F)), kNone).missed == 1);
  CHECK(faults(judge_one(flat, ray_at(std::nextafter(2.0F, 3.0F)), kNone)) == 0);
  CHECK(judge_one(flat, ray_at(2.0F), kNone).borderline == 1);
}

TEST_CASE("roots by subdivision are those between the roots of the derivatives") {
  bench::Dice dice(41);
  for (int i = 0; i < 200; i++) {
    PrecisePolynomial p{1};
    const std::size_t degree = 1 + dice.below(16);
    Precise before = 0;
    bool close = false;
    for (std::size_t k = 0; k < degree; k++) {
      // Some pairs closer together than long double can tell.
      close = !close && k > 0 && dice.one_in(3);
      const Precise root =
          close ? Precise(before + Precise(dice.in(0.5F, 1.0F)) * Precise("1e-10")) : Precise(dice.in(-1.5F, 1.5F));
      p = reference::multiply(p, {-root, 1});
      before = root;
    }
    const std::vector<Precise> expected = reference::roots_between(p, -1, 1);
    const std::vector<Root> found = roots_of(p);
    INFO("polynomial " << i << " of degree " << degree);
    REQUIRE(found.size() == expected.size());
    for (std::size_t k = 0; k < found.size(); k++) {
      CHECK(std::abs(found[k].s - static_cast<long double>(expected[k])) < 1e-17L);
    }
  }
  CHECK(roots_of({2, 0, 1}).empty());
  CHECK(roots_of({Precise(0)}).size() == 1);  // zero everywhere
  const std::vector<Root> touching = roots_of(reference::multiply({Precise(-0.3), 1}, {Precise(-0.3), 1}));
  REQUIRE(touching.size() == 1);
  CHECK_FALSE(touching[0].crosses);
  CHECK(std::abs(touching[0].s - static_cast<long double>(Precise(0.3))) < 1e-15L);
}

TEST_CASE("implicit surfaces: every root is missed once it is taken away") {
  const FlatScene flat = scene_of({implicit("(x^2+y^2+z^2+1-0.1225)^2 - 4*(x^2+y^2)", 1.5)});
  const ImplicitOracle oracle(flat);
  bench::Dice dice(42);
  std::size_t certain = 0;
  for (int i = 0; i < 1000; i++) {
    const Vec3 from = 3.0F * any_direction(dice), to = 1.2F * any_direction(dice);
    const shared::QueryRay ray = make_ray(from, to - from);
    const ImplicitTruth truth = oracle.meet(ray);
    if (truth.meetings.empty() || !truth.meetings.front().certain) continue;
    certain++;
    Tally dropped, moved, exact;
    oracle.judge(ray, truth, kNone, dropped);
    CHECK(dropped.missed == 1);
    const auto t = static_cast<float>(truth.meetings.front().t);
    oracle.judge(ray, truth, {t, 0, 0, 0}, exact);
    CHECK(faults(exact) + exact.borderline == 0);
    oracle.judge(ray, truth, {t * 1.001F, 0, 0, 0}, moved);
    CHECK(faults(moved) == 1);
  }
  CHECK(certain > 300);
}

}  // namespace hemiray::stability

// The judge of the stability ladder, without a device: it must find every kind of planted error, and accept what is
// right within the bound.
#include <catch2/catch.hpp>
#include <cmath>

#include "host/stability/aim.hpp"
#include "host/stability/exact.hpp"
#include "host/stability/leaving.hpp"
#include "host/stability/oracle.hpp"
#include "host/stability/shapes.hpp"

namespace hemiray::stability {
namespace {

constexpr std::uint32_t kRays = 20'032;
constexpr double kInUlp = 0x1p-23;

shared::QueryHit answer_of(const Truth& truth) {
  if (truth.empty()) return {0.0F, 0.0F, 0.0F, HR_NO_PRIMITIVE};
  return {static_cast<float>(truth.front().t), 0.0F, 0.0F, truth.front().primitive};
}

Tally judge_one(const FlatScene& flat, const shared::QueryRay& ray, const shared::QueryHit& answer,
                bool inside = false) {
  const Oracle oracle(flat);
  Oracle::Session session(oracle);
  Tally tally;
  session.judge(ray, session.meet(ray), answer, inside, tally);
  return tally;
}

// All that is held against an answer.
std::uint64_t faults(const Tally& t) { return t.missed + t.false_hit + t.wrong_surface; }

}  // namespace

TEST_CASE("exact predicates see the last bit") {
  const Vec3 o(0.0F), d(0.0F, 0.0F, 1.0F);
  const float above = 1.0F + 0x1p-23F, below = 1.0F - 0x1p-23F;
  CHECK(exact_edge_sign(o, d, {above, 1, 0}, {1, below, 5}) == -1);  // above below - 1 = -2^-46
  CHECK(exact_edge_sign(o, d, {1, 1, 3}, {1, 1, 0}) == 0);
  CHECK(exact_edge_sign(o, d, {1, 0, 3}, {0, 1, -7}) == 1);
  CHECK(exact_edge_sign({1e-30F, 0, 0}, {0, 1e-38F, 1e30F}, {1e30F, 0, 0}, {0, 1e-40F, 0}) == 1);
  CHECK(exact_collinear({0, 0, 0}, {1, 2, 4}, {0.5F, 1, 2}));
  CHECK(exact_collinear({1, 2, 3}, {1, 2, 3}, {5, 5, 5}));
  CHECK_FALSE(exact_collinear({0, 0, 0}, {1, 2, 4}, {0.5F, 1, moved_by_ulps(2, 1)}));
  CHECK(exact_plane_t({0, 0, 3}, {0, 0, -2}, {-1, -1, 1}, {1, -1, 1}, {0, 1, 1}) == 1.0L);
  CHECK(std::abs(exact_plane_t({0, 0, 1e7F}, {0, 0, -3e-7F}, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0}) -
                 1e7L / static_cast<long double>(3e-7F)) < 1e-3L);
}

TEST_CASE("the oracle accepts the exact answers, and answers within the bound") {
  for (const double at : {0.0, 1e4}) {
    const FlatScene flat = moved(icosahedron(), DVec3(1.0), DVec3(at));
    const Vec3 c(static_cast<float>(at));
    const Rays rays = at_triangles(flat, {{c, 2, 4, false}, {c, 0, 0.2F, true}})(kRays, 1);
    const Oracle oracle(flat);
    CHECK(oracle.distinct_triangles() == 20);
    Oracle::Session session(oracle);
    Tally tally;
    std::size_t hits = 0;
    for (std::size_t i = 0; i < rays.rays.size(); i++) {
      const Truth truth = session.meet(rays.rays[i]);
      CHECK((rays.inside[i] == 0 || !truth.empty()));
      hits += truth.empty() ? 0 : 1;
      session.judge(rays.rays[i], truth, answer_of(truth), rays.inside[i] != 0, tally);
      if (truth.empty()) continue;
      shared::QueryHit off = answer_of(truth);
      off.t = moved_by_ulps(off.t, 3);
      session.judge(rays.rays[i], truth, off, rays.inside[i] != 0, tally);
    }
    CHECK(faults(tally) == 0);
    CHECK(tally.borderline == 0);
    CHECK(tally.worst_ulps <= 6.6);  // 3 and the rounding, twice as many where an ulp doubles
    CHECK(hits > kRays / 2);
    CHECK(hits < kRays);
  }
}

TEST_CASE("the oracle finds planted errors: a hit dropped, moved, on another triangle, and the surface behind") {
  const FlatScene flat = icosahedron();
  const Rays rays = at_triangles(flat, {{Vec3(0.0F), 2, 4, false}, {Vec3(0.0F), 0, 0.2F, true}})(kRays, 2);
  const Oracle oracle(flat);
  Oracle::Session session(oracle);
  Tally dropped, shifted, renamed, behind;
  std::uint64_t inside = 0, hits = 0, seconds = 0;
  for (std::size_t i = 0; i < rays.rays.size(); i++) {
    const shared::QueryRay& ray = rays.rays[i];
    const Truth truth = session.meet(ray);
    const bool in = rays.inside[i] != 0;
    if (truth.empty()) continue;
    hits++;
    inside += in ? 1 : 0;
    session.judge(ray, truth, {0, 0, 0, HR_NO_PRIMITIVE}, in, dropped);
    shared::QueryHit hit = answer_of(truth);
    hit.t *= 1.01F;
    session.judge(ray, truth, hit, in, shifted);
    hit = answer_of(truth);
    hit.primitive = 999;  // there is none
    session.judge(ray, truth, hit, in, renamed);
    if (truth.size() < 2 || truth.back().t < truth.front().t * 1.2) continue;
    seconds++;
    session.judge(ray, truth, {static_cast<float>(truth.back().t), 0, 0, truth.back().primitive}, in, behind);
  }
  CHECK(dropped.missed + dropped.borderline == hits);
  CHECK(dropped.missed > inside);  // all of these, and those from outside that do not just touch
  CHECK(dropped.missed >= hits * 6 / 10);
  CHECK(shifted.false_hit >= hits * 8 / 10);  // along a surface a bit of t is within the bound
  CHECK(renamed.false_hit == hits);
  CHECK(seconds > hits / 4);
  CHECK(behind.missed == behind.wrong_surface);
  CHECK(behind.missed + behind.borderline == seconds);
  CHECK(behind.missed >= seconds * 6 / 10);
}

TEST_CASE("at an outline what lies within the bound is borderline, what lies beyond is wrong") {
  FlatScene flat = moved(sheet(1), DVec3(1.0), {0.0, 0.0, -2.0});
  const auto ray_at = [](float x, float y) { return make_ray({x, y, 0}, {0, 0, -1}); };
  const shared::QueryHit hit{2.0F, 0, 0, 0}, none{0, 0, 0, HR_NO_PRIMITIVE};
  const auto bound = static_cast<float>(kBoundUlps * kInUlp * 2.0);
  // The rim of a sheet at x = -1; its diagonal is an inner edge.
  for (const float y : {-0.5F, 0.3F}) {
    const float outside = -1.0F - 0.5F * bound, far_outside = -1.0F - 4.0F * bound, inside = -1.0F + 0.5F * bound;
    CHECK(judge_one(flat, ray_at(outside, y), hit).borderline == 1);
    CHECK(judge_one(flat, ray_at(far_outside, y), hit).false_hit == 1);
    CHECK(judge_one(flat, ray_at(inside, y), none).borderline == 1);
    CHECK(judge_one(flat, ray_at(-1.0F + 4.0F * bound, y), none).missed == 1);
    CHECK(judge_one(flat, ray_at(inside, y), none, true).missed == 1);
  }
  for (const float x : {-0.5F, 0.25F, 0.75F}) {
    const shared::QueryRay on_diagonal = ray_at(x, -x);
    const Oracle oracle(flat);
    Oracle::Session session(oracle);
    CHECK(session.meet(on_diagonal).size() == 2);
    CHECK(judge_one(flat, on_diagonal, none).missed == 1);
    CHECK(faults(judge_one(flat, on_diagonal, hit)) == 0);
    CHECK(faults(judge_one(flat, on_diagonal, {2.0F, 0, 0, 1})) == 0);
  }
}

TEST_CASE("what has no area or is not finite is nothing, and the same triangle twice is one") {
  FlatScene flat = sheet(1);
  flat.triangles.push_back({0, 0, 1, 0});
  flat.positions.insert(flat.positions.end(), {NAN, 0.0F, 0.0F});
  flat.triangles.push_back({0, 1, 4, 0});
  flat.triangles.push_back({flat.triangles[1].y, flat.triangles[1].z, flat.triangles[1].x, 0});
  const Oracle oracle(flat);
  CHECK(oracle.distinct_triangles() == 2);
  const shared::QueryRay ray = make_ray({0.5F, 0.5F, 1}, {0, 0, -1});
  CHECK(faults(judge_one(flat, ray, {1.0F, 0, 0, 1})) == 0);
  CHECK(faults(judge_one(flat, ray, {1.0F, 0, 0, 4})) == 0);
  CHECK(judge_one(flat, ray, {1.0F, 0, 0, 2}).false_hit == 1);
  CHECK(judge_one(flat, ray, {1.0F, 0, 0, 3}).false_hit == 1);
}

TEST_CASE("spheres are judged within the bound of their radius") {
  FlatScene flat = bench::FlatMesh().take();
  shared::Sphere sphere{};
  sphere.center_radius = {0, 0, 0, 1};
  flat.spheres.push_back(sphere);
  const auto ray_at = [](float x) { return make_ray({x, 0, 3}, {0, 0, -1}); };
  const shared::QueryHit none{0, 0, 0, HR_NO_PRIMITIVE};
  CHECK(faults(judge_one(flat, ray_at(0), {2, 0, 0, 0})) == 0);
  CHECK(judge_one(flat, ray_at(0), {4, 0, 0, 0}).false_hit == 1);  // the far side
  CHECK(judge_one(flat, ray_at(0), none).missed == 1);
  CHECK(judge_one(flat, ray_at(0.5F), {2, 0, 0, 0}).false_hit == 1);
  CHECK(judge_one(flat, ray_at(1.0F - 1e-6F), none).borderline == 1);
  CHECK(judge_one(flat, ray_at(1.0F - 1e-4F), none).missed == 1);
  CHECK(judge_one(flat, ray_at(1.0F + 1e-6F), {3, 0, 0, 0}).borderline == 1);
  CHECK(judge_one(flat, ray_at(1.0F + 1e-4F), {3, 0, 0, 0}).false_hit == 1);
}

TEST_CASE("planted errors of rays that leave a surface are found") {
  Rung rung;
  rung.kind = RungKind::leaving;
  rung.flat = icosahedron();
  const Oracle oracle(rung.flat);
  Oracle::Session session(oracle);
  Rays rays;
  rays.rays = {make_ray({0, 0, 3}, {0.01F, 0.02F, -1})};
  rays.inside = {0};
  const Truth truth = session.meet(rays.rays[0]);
  REQUIRE(truth.size() == 2);
  const shared::QueryHit first = answer_of(truth), none{0, 0, 0, HR_NO_PRIMITIVE};
  const auto judge = [&](float side, shared::QueryHit next) {
    const Vec3 out(0.0F, 0.0F, side);
    const LeavingRays answers{{first}, {make_ray({0.02F, 0.04F, 0.9F}, out)}, {next}};
    return judge_leaving(rung, rays, {{0, 0, side, side}}, answers);
  };
  const shared::QueryHit again{1e-7F, 0, 0, first.primitive}, far{1.7F, 0, 0, truth.back().primitive};
  CHECK(judge(1.0F, none).self_hit == 0);
  CHECK(judge(1.0F, again).self_hit == 1);
  CHECK(judge(-1.0F, far).self_hit + judge(-1.0F, far).tunnelled == 0);
  CHECK(judge(-1.0F, again).self_hit == 1);
  CHECK(judge(-1.0F, none).tunnelled == 1);

  rung.after = After::layer;
  rung.flat = moved(sheet(1), DVec3(1.0), {0.0, 0.0, 1.0});
  append(rung.flat, moved(sheet(1), DVec3(1.0), {0.0, 0.0, 0.5}));
  const auto through = [&](shared::QueryHit next) {
    const LeavingRays answers{{{2.0F, 0, 0, 0}}, {make_ray({0, 0, 1}, {0, 0, -1})}, {next}};
    return judge_leaving(rung, rays, {{0, 0, -1, -1}}, answers);
  };
  CHECK(through({0.5F, 0, 0, 2}).tunnelled + through({0.5F, 0, 0, 2}).self_hit == 0);
  CHECK(through(none).tunnelled == 1);
  CHECK(through({1e-7F, 0, 0, 1}).self_hit == 1);
}

}  // namespace hemiray::stability

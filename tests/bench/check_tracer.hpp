// What every tracer must do, whoever made it: the same checks for ours and for peers.
#pragma once

#include <catch2/catch.hpp>

#include "host/bench/tracer.hpp"
#include "tests/bench/brute_force.hpp"

namespace hemiray::test {

/// Closest and any hits of 4096 rays against brute force, wherever that is sure.
inline void check_answers(bench::Tracer& tracer, const FlatScene& flat) {
  const std::vector<shared::QueryRay> rays = rays_into_soup(4096, 12);
  tracer.load_rays(rays);
  tracer.intersect();
  tracer.occluded();
  const std::vector<shared::QueryHit> hits = tracer.hits();
  const std::vector<std::uint32_t> occlusions = tracer.occlusions();
  REQUIRE(hits.size() == rays.size());
  REQUIRE(occlusions.size() == rays.size());
  std::size_t sure = 0, met = 0;
  for (std::size_t i = 0; i < rays.size(); i++) {
    const BruteForceHit expected = brute_force_hit(flat, rays[i]);
    if (!expected.sure) continue;
    sure++;
    INFO(tracer.name() << ", ray " << i);
    REQUIRE(hits[i].primitive == expected.hit.primitive);
    const bool meets = expected.hit.primitive != HR_NO_PRIMITIVE;
    REQUIRE(occlusions[i] == (meets ? 1U : 0U));
    if (!meets) continue;
    met++;
    REQUIRE(hits[i].t == Approx(expected.hit.t).epsilon(1e-4));
    REQUIRE(hits[i].u == Approx(expected.hit.u).margin(1e-3));
    REQUIRE(hits[i].v == Approx(expected.hit.v).margin(1e-3));
  }
  CHECK(sure > rays.size() * 9 / 10);
  CHECK(met > rays.size() / 5);
}

/// Answers after a build, after another one in its place, and through another's tree.
inline void check_tracer(bench::Tracer& tracer, bench::Tracer& sharer) {
  const FlatScene first = triangle_soup(200, 10), second = triangle_soup(200, 11);
  CHECK(tracer.build(first) > 0.0);
  check_answers(tracer, first);
  CHECK(tracer.build(second) > 0.0);
  check_answers(tracer, second);
  REQUIRE(sharer.share_build(tracer));
  check_answers(sharer, second);
  CHECK_THROWS_AS(tracer.load_rays(rays_into_soup(65, 1)), std::logic_error);
}

}  // namespace hemiray::test

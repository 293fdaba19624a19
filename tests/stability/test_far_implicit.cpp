// Implicit surfaces passed along tangents from far away: what float and double make of the ray's way must not count as
// the surface's error, or every ray near the outline is open.
#include <catch2/catch.hpp>

#include <cmath>

#include "host/gpu/device.hpp"
#include "host/scene/expression.hpp"
#include "host/stability/ladder.hpp"

namespace hemiray::stability {
namespace {

// Along z the saddle is met at z = +-sqrt(-5 x), along y at y = +-sqrt(5 x): a pair of roots closer than 1e-3 of the
// clip, or as little beside the surface.
Rays past_the_middle(std::uint32_t count, std::uint32_t seed, double distance) {
  bench::Dice dice(seed);
  Rays made;
  while (made.rays.size() < count) {
    const int axis = dice.one_in(2) ? 1 : 2;
    const float way = dice.one_in(2) ? 1.0F : -1.0F;
    Vec3 from(0.0F), d(0.0F);
    from.x = (dice.one_in(2) ? 1.0F : -1.0F) * std::exp2(dice.in(-33.0F, -24.0F));
    from[axis] = -way * static_cast<float>(distance) + static_cast<float>(dice.below(3));
    d[axis] = way;
    made.rays.push_back(make_ray(from, d));
    made.inside.push_back(0);
  }
  return made;
}

Rung tangents_from(double distance) {
  Shape shape;
  shape.kind = ShapeKind::implicit;
  shape.expression = parse_expression("x - 0.2*(y^2 - z^2)", {});
  shape.clip = Clip::sphere;
  shape.clip_radius = 1.0;
  Scene scene;
  scene.materials.emplace_back();
  scene.shapes.push_back(std::move(shape));
  Rung rung;
  rung.name = "tangents";
  rung.flat = flatten_scene(scene);
  rung.rays = [distance](std::uint32_t count, std::uint32_t seed) { return past_the_middle(count, seed, distance); };
  return rung;
}

}  // namespace

TEST_CASE("implicit surfaces seen from afar: rays along tangents are told, near and far alike") {
  Context context(choose_device(""));
  LadderOptions options;
  options.rays = 2048;
  for (const double distance : {1e1, 1e3, 1e5, 1e7}) {
    INFO("from " << distance << " sizes away");
    Ladder ladder(context, options);
    const RungResult result = ladder.run("far", tangents_from(distance)).value();
    CHECK(result.broken.empty());
    CHECK(result.open_regions == 0U);
    CHECK(result.ours.borderline == 0);
    // One of the hits is lost: it is missed, not uncertain, since the device can tell.
    std::size_t hits = 0;
    LadderOptions losing = options;
    losing.tamper = [&hits](std::vector<shared::QueryHit>& all) {
      for (shared::QueryHit& hit : all) {
        if (hit.primitive == HR_NO_PRIMITIVE) continue;
        if (hits++ == 0) hit.primitive = HR_NO_PRIMITIVE;
      }
    };
    const RungResult lost = Ladder(context, losing).run("far", tangents_from(distance)).value();
    CHECK(hits > 768);
    CHECK(lost.ours.missed == 1);
    CHECK(lost.ours.uncertain == 0);
  }
}

}  // namespace hemiray::stability

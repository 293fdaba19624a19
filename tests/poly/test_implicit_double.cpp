// Implicit surfaces in double precision: distances against closed forms, and what single precision makes of the same
// rays.
#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "host/gpu/program.hpp"
#include "host/scene/expression.hpp"
#include "kernels/shared/scene_types.h"
#include "tests/support/kernel_folder.hpp"

namespace hemiray {
namespace {

using Real = long double;

// found = {t as the sum of three floats, regions left open}, {how far the surface's point is from the ray's [m], ...};
// t = -1 for a miss. Points are compared in the arithmetic that is tested.
constexpr const char* kProbe = R"(#include "lib/implicit.h"
kernel void first_hits(global const uint4* tapes, global const Shape* surface, global const float4* ray_of,
                       global float4* found) {
  const uint i = (uint)get_global_id(0);
  const float4 from = ray_of[2 * i], way = ray_of[2 * i + 1];
  const real3 o = (real3)(from.x, from.y, from.z), d = (real3)(way.x, way.y, way.z);
  const Ray ray = make_ray(o, d, 0, INFINITY);
  real t = -1;
  uint uncertain = 0;
  const bool hit = intersect_implicit(tapes, surface, &ray, INFINITY, &t, &uncertain);
  if (!hit) t = -1;
  real off = 0;
  if (hit) {
    real3 p, error, n;
    implicit_surface(tapes, surface, o, d, t, &p, &error, &n);
    const real3 away = p - (o + d * t);
    off = square_root(dot3(away, away));
  }
  const float high = (float)t;
  const float middle = (float)(t - high);
  found[2 * i] = (float4)(high, middle, (float)(t - high - middle), (float)uncertain);
  found[2 * i + 1] = (float4)((float)off, 0, 0, 0);
}
)";

struct Shot {
  Vec3 origin, direction;
};

std::vector<shared::float4> shoot(const std::string& text, const ExpressionConstants& constants,
                                  const std::vector<Shot>& shots, bool double_precision) {
  const Expression expression = parse_expression(text, constants);
  shared::Shape surface{};
  surface.to_own_x = {1, 0, 0, 0};
  surface.to_own_y = {0, 1, 0, 0};
  surface.to_own_z = {0, 0, 1, 0};
  surface.clip = {2, 2, 2, 0};
  surface.lo.w = 3.5F;  // reaches around the clip
  surface.form.y = std::bit_cast<float>(static_cast<std::uint32_t>(expression.tape.size()));
  surface.kind = HR_SHAPE_IMPLICIT;
  surface.flags = HR_SHAPE_CLIP_BOX;
  std::vector<shared::float4> rays;
  for (const Shot& s : shots) {
    rays.push_back({s.origin.x, s.origin.y, s.origin.z, 0});
    rays.push_back({s.direction.x, s.direction.y, s.direction.z, 0});
  }
  const test::KernelFolder folder("probe/hits.cl",
                                  (double_precision ? "#define HR_DOUBLE\n" : "") + std::string(kProbe));
  Context context(choose_device(""));
  Program program(context, "hits", {"probe/hits.cl"}, {});
  const std::vector<shared::Shape> one = {surface};
  const Buffer<shared::uint4> tapes(context, "tapes", std::span<const shared::uint4>(expression.tape));
  const Buffer<shared::Shape> device_surface(context, "surface", std::span<const shared::Shape>(one));
  const Buffer<shared::float4> ray_of(context, "rays", std::span<const shared::float4>(rays));
  const Buffer<shared::float4> found(context, "found", 2 * shots.size());
  launch(context, program.kernel("first_hits"), shots.size(),
         arguments(arg("tapes", tapes), arg("surface", device_surface), arg("ray_of", ray_of), arg("found", found)));
  return found.read();
}

struct Worst {
  Real t = 0;    // largest error of a distance, as a share of the ray's length so far and the origin's coordinates
  Real off = 0;  // largest distance between the hit and the surface [m]
  int hits = 0, wrong = 0, open = 0;
};

Worst compare(const std::vector<Shot>& shots, const std::vector<shared::float4>& found,
              const std::vector<std::optional<Real>>& truth) {
  Worst worst;
  for (std::size_t i = 0; i < shots.size(); i++) {
    const shared::float4& told = found[2 * i];
    const bool hit = told.x >= 0.0F;
    worst.open += told.w > 0.0F ? 1 : 0;
    if (hit != truth[i].has_value()) {
      worst.wrong++;
      continue;
    }
    if (!hit) continue;
    worst.hits++;
    const Real t = Real{told.x} + Real{told.y} + Real{told.z};
    worst.t = std::max(worst.t, std::abs(t - *truth[i]) / (1 + *truth[i]));
    worst.off = std::max(worst.off, Real{found[2 * i + 1].x});
  }
  return worst;
}

// The nearest t > 0 at which a line meets circles of radius r about (+-R, 0), or one about 0 where R = 0.
std::optional<Real> nearest_circle(Real x, Real z, Real dx, Real dz, Real big, Real small) {
  std::optional<Real> best;
  for (const Real center : {big, -big}) {
    const Real a = dx * dx + dz * dz, b = (x - center) * dx + z * dz, c = (x - center) * (x - center) + z * z;
    const Real disc = b * b - a * (c - small * small);
    if (disc < 0) continue;
    for (const Real t : {(-b - std::sqrt(disc)) / a, (-b + std::sqrt(disc)) / a}) {
      if (t > 0 && (!best || t < *best)) best = t;
    }
  }
  return best;
}

struct Kind {
  const char* name;
  const char* text;
  double big, small;
};

}  // namespace

TEST_CASE("implicit surfaces in double precision: distances to sphere and torus are those of closed forms") {
  if (!choose_device("").has_fp64) return;
  // Constants that floats hold, so that surface and closed form are the same.
  for (const Kind& kind : {Kind{"sphere", "x^2 + y^2 + z^2 - r^2", 0.0, 1.25},
                           Kind{"torus", "(x^2+y^2+z^2+R^2-r^2)^2 - 4*R^2*(x^2+y^2)", 1.0, 0.375}}) {
    std::mt19937 engine(5);
    std::uniform_real_distribution<float> in(-1.0F, 1.0F);
    std::vector<Shot> shots;
    std::vector<std::optional<Real>> truth;
    while (shots.size() < 2000) {  // in a plane through the axis, where a torus is two circles
      const Vec3 from(2.5F * in(engine), 0.0F, 2.5F * in(engine)), at(1.5F * in(engine), 0.0F, 0.4F * in(engine));
      const Vec3 way = at - from;
      if (glm::length(way) < 0.1F) continue;
      shots.push_back({from, way});
      truth.push_back(nearest_circle(from.x, from.z, way.x, way.z, kind.big, kind.small));
    }
    const ExpressionConstants constants = {{"R", kind.big}, {"r", kind.small}};
    const Worst fine = compare(shots, shoot(kind.text, constants, shots, true), truth);
    const Worst coarse = compare(shots, shoot(kind.text, constants, shots, false), truth);
    INFO(kind.name << ": worst error of t " << static_cast<double>(fine.t) << " in double, "
                   << static_cast<double>(coarse.t) << " in single precision; points off by "
                   << static_cast<double>(fine.off) << " and " << static_cast<double>(coarse.off) << " m");
    CHECK(fine.wrong == 0);
    CHECK(fine.open == 0);
    CHECK(fine.hits > 1000);
    CHECK(fine.t <= 0x1p-53L);
    CHECK(fine.off < 1e-14L);
    CHECK(coarse.wrong == 0);
    CHECK(coarse.t > 0x1p-28L);
    CHECK(coarse.off > 1e-9L);
  }
}

}  // namespace hemiray

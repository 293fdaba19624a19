// Implicit polynomial surfaces: rays anywhere, along tangents, and from the surface.
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>

#include "host/scene/expression.hpp"
#include "host/stability/rung.hpp"

namespace hemiray::stability {
namespace {

using bench::Dice;

struct Surface {
  const char* name;
  const char* text;
  ExpressionConstants constants{};
  double clip = 1.0;  // half edge of the cube about it
};

// As in tests/poly and the scenes.
std::vector<Surface> surfaces() {
  return {{"sphere", "x^2 + y^2 + z^2 - 4", {}, 2.5},
          {"torus", "(x^2+y^2+z^2+R^2-r^2)^2 - 4*R^2*(x^2+y^2)", {{"R", 1.0}, {"r", 0.35}}, 1.5},
          {"Steiner", "x^2*y^2 + y^2*z^2 + z^2*x^2 - x*y*z", {}, 1.1},
          {"heart", "(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3", {}, 1.5},
          {"Barth sextic",
           "4*(t^2*x^2-y^2)*(t^2*y^2-z^2)*(t^2*z^2-x^2) - (1+2*t)*(x^2+y^2+z^2-1)^2",
           {{"t", 0.5 * (1.0 + std::sqrt(5.0))}},
           1.6},
          {"Chmutov 8", "(2*(2*(2*x^2-1)^2-1)^2-1) + (2*(2*(2*y^2-1)^2-1)^2-1) + (2*(2*(2*z^2-1)^2-1)^2-1)", {}, 1.05},
          {"Chmutov 16",
           "(2*(2*(2*(2*x^2-1)^2-1)^2-1)^2-1) + (2*(2*(2*(2*y^2-1)^2-1)^2-1)^2-1) + (2*(2*(2*(2*z^2-1)^2-1)^2-1)^2-1)",
           {},
           1.02}};
}

const Surface& surface_named(const std::vector<Surface>& all, std::string_view name) {
  return *std::find_if(all.begin(), all.end(), [&](const Surface& s) { return s.name == name; });
}

DVec3 in_cube(Dice& dice, double half_side) {
  const double x = dice.in(-1, 1), y = dice.in(-1, 1), z = dice.in(-1, 1);
  return half_side * DVec3(x, y, z);
}

DVec3 normal_at(const Expression& f, const DVec3& p) {
  DVec3 g;
  for (int k = 0; k < 3; k++) {
    DVec3 step(0.0);
    step[k] = 1e-5;
    g[k] = evaluate(f, p + step) - evaluate(f, p - step);
  }
  return g / std::max(glm::length(g), 1e-30);
}

// How far beside tangents rays pass, as powers of two [of the clip's size].
struct Beside {
  float least = -30.0F, most = -10.0F;
};

// A third through the clip at random, a third past points of the surface along tangents, a third from points on the
// surface, as shadow rays leave it; or all along tangents.
struct Aim {
  Expression f;
  double clip;
  DMat4 to_world;
  Beside beside;
  bool only_tangents;

  void add(Rays& made, const DVec3& from, const DVec3& way) const {
    const DVec3 origin(to_world * glm::dvec4(from, 1.0)), d(to_world * glm::dvec4(way, 0.0));
    made.rays.push_back(make_ray(Vec3(origin), Vec3(glm::normalize(d))));
    made.inside.push_back(0);
  }
  void add_some(Rays& made, Dice& dice) const {
    const DVec3 from = 3.0 * clip * DVec3(any_direction(dice)), way = glm::normalize(in_cube(dice, clip) - from);
    if (!only_tangents) add(made, from, way);
    // The first change of sign in steps that may pass over some.
    const double step = clip / 64.0;
    double t = clip, before = evaluate(f, from + t * way);
    for (; t < 5.0 * clip; t += step) {
      const double now = evaluate(f, from + (t + step) * way);
      if (before * now < 0.0) break;
      before = now;
    }
    if (t >= 5.0 * clip) return;
    double lo = t, hi = t + step;
    for (int i = 0; i < 50; i++) {
      const double middle = 0.5 * (lo + hi);
      (evaluate(f, from + middle * way) * before > 0.0 ? lo : hi) = middle;
    }
    const DVec3 p = from + lo * way, n = normal_at(f, p), tangent = glm::cross(n, DVec3(any_direction(dice)));
    if (glm::length(tangent) < 0.1) return;
    const std::uint32_t side = dice.below(5);
    const double off = clip * std::exp2(static_cast<double>(dice.in(beside.least, beside.most)));
    const DVec3 along = glm::normalize(tangent);
    add(made, p - 2.0 * clip * along + n * (side == 0 ? 0.0 : side < 3 ? off : -off), along);
    if (!only_tangents) add(made, p + 3e-7 * n, glm::dot(n, way) < 0.0 ? DVec3(any_direction(dice)) : -way);
  }
};

FlatScene flat_scene_of(Shape shape) {
  Scene scene;
  scene.materials.emplace_back();
  scene.shapes.push_back(std::move(shape));
  return flatten_scene(scene);
}

// A quarter of the rays, a sixteenth above degree 8: the oracle finds all roots in multi-precision.
Rung rung_of(std::string name, const Surface& surface, const DMat4& to_world, Beside beside = {},
             bool only_tangents = false) {
  Shape shape;
  shape.kind = ShapeKind::implicit;
  shape.expression = parse_expression(surface.text, surface.constants);
  shape.clip = Clip::box;
  shape.clip_half = DVec3(surface.clip);
  shape.to_world = to_world;
  const std::uint32_t share = shape.expression.degree > 8 ? 16 : 4;
  Rung rung;
  rung.name = std::move(name);
  rung.rays = [share, aim = Aim{shape.expression, surface.clip, to_world, beside, only_tangents}](std::uint32_t count,
                                                                                                  std::uint32_t seed) {
    Dice dice(seed);
    Rays made;
    const std::size_t wanted = std::max(kRaysFromOnePoint, count / share);
    while (made.rays.size() < wanted) aim.add_some(made, dice);
    made.rays.resize(wanted);
    made.inside.resize(wanted);
    return made;
  };
  rung.flat = flat_scene_of(std::move(shape));
  return rung;
}

DMat4 placed(double scale, double at) {
  const DMat4 moved = glm::translate(DMat4(1.0), at * DVec3(1.0, -0.7, 0.3));
  return glm::scale(glm::rotate(moved, 0.7, glm::normalize(DVec3(1.0, 2.0, 3.0))), DVec3(scale));
}

// A saddle cut by a clip of size 1.
constexpr const char* kSaddle = "x - 0.2*(y^2 - z^2)";

DVec3 on_saddle(double y, double z) { return {0.2 * (y * y - z * z), y, z}; }

// How far to go in its direction from the saddle's middle to where the clip cuts it.
double way_to_cut(Clip clip, double cosine, double sine) {
  double lo = 0.0, hi = 2.0;
  for (int i = 0; i < 50; i++) {
    const double way = 0.5 * (lo + hi);
    const DVec3 p = glm::abs(on_saddle(way * cosine, way * sine));
    const double size = clip == Clip::sphere ? glm::length(p) : std::max({p.x, p.y, p.z});
    (size < 1.0 ? lo : hi) = way;
  }
  return lo;
}

// Half of the rays at most an eighth beside the cut, half along axes, where their origins are exact.
RayMaker at_cut(Clip clip, const DMat4& to_world, double distance) {
  return [=](std::uint32_t count, std::uint32_t seed) {
    Dice dice(seed);
    Rays made;
    while (made.rays.size() < count) {
      const double turn = 6.2831853 * static_cast<double>(dice.unit()), cosine = std::cos(turn), sine = std::sin(turn);
      double way = 1.5 * static_cast<double>(dice.unit());
      if (dice.one_in(2)) {
        const double beside = std::exp2(static_cast<double>(dice.in(-12.0F, -3.0F)));
        way = way_to_cut(clip, cosine, sine) * (dice.one_in(2) ? 1.0 + beside : 1.0 - beside);
      }
      Vec3 d = any_direction(dice);
      if (dice.one_in(2)) {
        d = Vec3(0.0F);
        d[static_cast<int>(dice.below(3))] = dice.one_in(2) ? 1.0F : -1.0F;
      }
      const DVec3 target(to_world * glm::dvec4(on_saddle(way * cosine, way * sine), 1.0));
      made.rays.push_back(make_ray(Vec3(target - distance * DVec3(d)), d));
      made.inside.push_back(0);
    }
    return made;
  };
}

Rung cut_saddle(std::string name, Clip clip, double distance) {
  Shape shape;
  shape.kind = ShapeKind::implicit;
  shape.expression = parse_expression(kSaddle, {});
  shape.clip = clip;
  shape.clip_half = DVec3(1.0);
  shape.clip_radius = 1.0;
  shape.to_world = placed(1.0, 0.0);
  Rung rung;
  rung.name = std::move(name);
  rung.rays = at_cut(clip, shape.to_world, distance);
  rung.flat = flat_scene_of(std::move(shape));
  return rung;
}

}  // namespace

std::vector<Case> implicit_cases() {
  Case forms{"implicit",
             "Polynomial surfaces of degree 2 to 16: a third of the rays anywhere, a third along tangents missed by "
             "1e-3 to 1e-9 of the size or not at all, a third from the surface. A quarter of the rays, a sixteenth at "
             "degree 16.",
             {}};
  for (const Surface& surface : surfaces()) {
    forms.rungs.emplace_back([surface] { return rung_of(surface.name, surface, DMat4(1.0)); });
  }
  Case places{"implicit, size and place", "The torus turned, so large and so far from the origin.", {}};
  constexpr std::pair<const char*, std::pair<double, double>> kPlaces[] = {{"1e-3", {1e-3, 0.0}},
                                                                           {"1e3", {1e3, 0.0}},
                                                                           {"1e6", {1e6, 0.0}},
                                                                           {"1 at 1e2", {1.0, 1e2}},
                                                                           {"1 at 1e4", {1.0, 1e4}}};
  for (const auto& [name, place] : kPlaces) {
    places.rungs.emplace_back([name = name, place = place] {
      return rung_of(name, surface_named(surfaces(), "torus"), placed(place.first, place.second));
    });
  }
  Case tangents{
      "implicit, tangent", "The heart passed along tangents, at most so far beside it in parts of its size.", {}};
  constexpr std::pair<const char*, float> kTangents[] = {
      {"2^-8", -8.0F}, {"2^-14", -14.0F}, {"2^-20", -20.0F}, {"2^-26", -26.0F}};
  for (const auto& [name, most] : kTangents) {
    tangents.rungs.emplace_back([name = name, most = most] {
      return rung_of(name, surface_named(surfaces(), "heart"), DMat4(1.0), {most - 2.0F, most}, true);
    });
  }
  Case cuts{"implicit, clip",
            "A saddle cut by a box or sphere, from so many times its size; half of the rays near the cut.",
            {}};
  constexpr std::pair<const char*, double> kDistances[] = {
      {"1e1", 1e1}, {"1e2", 1e2}, {"1e3", 1e3}, {"1e5", 1e5}, {"1e7", 1e7}};
  for (const auto& [name, distance] : kDistances) {
    for (const Clip clip : {Clip::box, Clip::sphere}) {
      cuts.rungs.emplace_back([clip, name = std::string(name), distance = distance] {
        return cut_saddle(clip == Clip::box ? name + ", box" : name + ", sphere", clip, distance);
      });
    }
  }
  return {std::move(forms), std::move(places), std::move(tangents), std::move(cuts)};
}

}  // namespace hemiray::stability

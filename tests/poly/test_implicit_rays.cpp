// Rays at implicit surfaces: the kernels' first root against multiprecision, through their silhouettes, along tangents
// and from points on them.
#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "host/gpu/program.hpp"
#include "host/scene/expression.hpp"
#include "host/stability/precise_line.hpp"
#include "kernels/shared/scene_types.h"
#include "tests/reference/polynomial_roots.hpp"
#include "tests/support/kernel_folder.hpp"

namespace hemiray {
namespace {

using reference::Precise;
using reference::PrecisePolynomial;
using DMat3 = glm::dmat3;

constexpr const char* kProbe = R"(#include "lib/implicit.h"
kernel void first_hits(global const uint4* tapes, global const Shape* surface, global const float4* ray_of,
                       global float4* found, global uint* open) {
  const uint i = (uint)get_global_id(0);
  const real3 o = ray_of[2 * i].xyz, d = ray_of[2 * i + 1].xyz;
  const Ray ray = make_ray(o, d, ray_of[2 * i].w, INFINITY);
  real t = -1;
  uint uncertain = 0;
  const bool hit = intersect_implicit(tapes, surface, &ray, INFINITY, &t, &uncertain);
  open[i] = uncertain;
  real3 p = 0, error = 0, n = 0;
  if (hit) implicit_surface(tapes, surface, o, d, t, &p, &error, &n);
  found[3 * i] = (float4)(p, hit ? t : -1);
  found[3 * i + 1] = (float4)(n, 0);
  found[3 * i + 2] = (float4)(error, 0);
}
kernel void polynomials(global const uint4* tapes, global const Shape* surface, global const float4* ray_of,
                        global float2* found) {
  const uint i = (uint)get_global_id(0);
  const real3 o = ray_of[2 * i].xyz, d = ray_of[2 * i + 1].xyz;
  const float m = ray_of[2 * i].w;
  Poly_f p;
  poly_along_f(tapes, surface, o, d, m, 2.0f, HR_MAX_DEGREE, &p);
  HR_WIDE(Poly) w;
  poly_along_wide(tapes, surface, o, d, HR_WIDE_OF(m), HR_WIDE_OF(2), HR_MAX_DEGREE, &w);
  for (uint k = 0; k < HR_COEFFICIENTS; k++) {
    found[36 * i + k] = (float2)(k <= p.degree ? p.c[k] : 0, 0);
    found[36 * i + 18 + k] = k <= w.degree ? as_two(w.c[k]) : (float2)(0);
  }
  found[36 * i + 17] = (float2)(p.error, 0);
  found[36 * i + 35] = (float2)((float)w.error, 0);
}
)";
const std::string kAsTwo =
    "#include \"lib/implicit.h\"\n#define poly_along_wide HR_WIDE(poly_along)\n#ifdef HR_WITHOUT_DOUBLE\n"
    "#define as_two(v) (v)\n#else\n#define as_two(v) ((float2)((float)(v), (float)((v) - "
    "(double)(float)(v))))\n#endif\n";

struct Form {
  const char* name;
  const char* text;
  ExpressionConstants constants{};
  float clip = 2.0F;        // a cube of that half edge
  double most_open = 1e-3;  // share of rays that may end uncertain
};

const double kGolden = 0.5 * (1.0 + std::sqrt(5.0));

// The scenes' surfaces. Steiner's has lines of double points, where rays cannot be told; Barth's has 50 nodes.
std::vector<Form> forms() {
  return {{"sphere", "x^2 + y^2 + z^2 - 4", {}, 2.5F},
          {"torus", "(x^2+y^2+z^2+R^2-r^2)^2 - 4*R^2*(x^2+y^2)", {{"R", 1.0}, {"r", 0.35}}, 1.5F},
          {"Barth sextic",
           "4*(t^2*x^2-y^2)*(t^2*y^2-z^2)*(t^2*z^2-x^2) - (1+2*t)*(x^2+y^2+z^2-1)^2",
           {{"t", kGolden}},
           1.6F},
          {"Steiner", "x^2*y^2 + y^2*z^2 + z^2*x^2 - x*y*z", {}, 1.1F, 0.02},
          {"heart", "(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3", {}, 1.5F},
          {"Chmutov 8", "(2*(2*(2*x^2-1)^2-1)^2-1) + (2*(2*(2*y^2-1)^2-1)^2-1) + (2*(2*(2*z^2-1)^2-1)^2-1)", {}, 1.05F},
          {"Chmutov 16",
           "(2*(2*(2*(2*x^2-1)^2-1)^2-1)^2-1) + (2*(2*(2*(2*y^2-1)^2-1)^2-1)^2-1) + (2*(2*(2*(2*z^2-1)^2-1)^2-1)^2-1)",
           {},
           1.02F},
          {"lens", "((x^2+y^2)/c^2 + (z/b)^2 - 1)", {{"c", 1.0}, {"b", 0.4}}, 1.2F}};
}

struct Shot {
  Vec3 origin, direction;
  float t_min = 0.0F;
};

shared::Shape place(const Form& form, const Expression& expression, const DMat3& turn, double scale, DVec3 center) {
  shared::Shape s{};
  const DMat3 m = glm::transpose(turn) / scale;  // to the object
  const auto row = [&m, &center](int i) {
    return shared::float4{static_cast<float>(m[0][i]), static_cast<float>(m[1][i]), static_cast<float>(m[2][i]),
                          static_cast<float>(center[i])};
  };
  s.to_own_x = row(0);
  s.to_own_y = row(1);
  s.to_own_z = row(2);
  s.clip = {form.clip, form.clip, form.clip, 0};
  s.lo.w = 1.74F * form.clip * static_cast<float>(scale);  // reaches around the clip
  s.form.y = std::bit_cast<float>(static_cast<std::uint32_t>(expression.tape.size()));
  s.kind = HR_SHAPE_IMPLICIT;
  s.flags = HR_SHAPE_CLIP_BOX;
  return s;
}

// f(M (o + d (m + h s) - c)) without rounding to speak of.
PrecisePolynomial along(const Expression& expression, const shared::Shape& s, const Shot& shot, double m, double h) {
  const shared::QueryRay ray{{shot.origin.x, shot.origin.y, shot.origin.z, shot.t_min},
                             {shot.direction.x, shot.direction.y, shot.direction.z, 0.0F}};
  return stability::polynomial_along(expression.tape, s, ray, m, h);
}

DVec3 to_object(const shared::Shape& s, const DVec3& v) {
  const auto dot = [&v](const shared::float4& row) { return row.x * v.x + row.y * v.y + row.z * v.z; };
  return {dot(s.to_own_x), dot(s.to_own_y), dot(s.to_own_z)};
}

// The part of the ray in the clip's cube.
std::optional<std::pair<double, double>> in_clip(const shared::Shape& s, const Shot& shot) {
  const DVec3 o = to_object(s, DVec3(shot.origin) - DVec3(s.to_own_x.w, s.to_own_y.w, s.to_own_z.w));
  const DVec3 d = to_object(s, DVec3(shot.direction));
  double t0 = shot.t_min, t1 = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; k++) {
    const double clip = s.clip.x;
    if (d[k] == 0.0) {
      if (std::abs(o[k]) > clip) return std::nullopt;
      continue;
    }
    const double a = (-clip - o[k]) / d[k], b = (clip - o[k]) / d[k];
    t0 = std::max(t0, std::min(a, b));
    t1 = std::min(t1, std::max(a, b));
  }
  if (!(t0 < t1)) return std::nullopt;
  return std::pair(t0, t1);
}

struct Answers {
  std::vector<shared::float4> found;
  std::vector<std::uint32_t> open;
};

// One kernel of the probe over all shots, and what it found.
template <typename T>
std::vector<T> run(const std::string& kernel, const Expression& expression, const shared::Shape& surface,
                   const std::vector<Shot>& shots, const std::string& defines, std::size_t each,
                   std::vector<std::uint32_t>* open_regions) {
  std::vector<shared::float4> rays;
  for (const Shot& s : shots) {
    rays.push_back({s.origin.x, s.origin.y, s.origin.z, s.t_min});
    rays.push_back({s.direction.x, s.direction.y, s.direction.z, 0});
  }
  const test::KernelFolder folder("probe/hits.cl", defines + kAsTwo + kProbe);
  Context context(choose_device(""));
  Program program(context, "hits", {"probe/hits.cl"}, {});
  const std::vector<shared::Shape> one = {surface};
  const Buffer<shared::uint4> tapes(context, "tapes", std::span<const shared::uint4>(expression.tape));
  const Buffer<shared::Shape> device_surface(context, "surface", std::span<const shared::Shape>(one));
  const Buffer<shared::float4> ray_of(context, "rays", std::span<const shared::float4>(rays));
  const Buffer<T> found(context, "found", each * shots.size());
  const Buffer<std::uint32_t> open(context, "open", shots.size());
  Arguments all =
      arguments(arg("tapes", tapes), arg("surface", device_surface), arg("ray_of", ray_of), arg("found", found));
  if (open_regions) all.push_back(arg("open", open));
  launch(context, program.kernel(kernel), shots.size(), all);
  if (open_regions) *open_regions = open.read();
  return found.read();
}

Answers shoot(const Expression& expression, const shared::Shape& surface, const std::vector<Shot>& shots,
              const std::string& defines) {
  Answers answers;
  answers.found = run<shared::float4>("first_hits", expression, surface, shots, defines, 3, &answers.open);
  return answers;
}

struct Tally {
  std::size_t hits = 0, open = 0, missed = 0, invented = 0, imprecise = 0;
  double worst_ulps = 0.0;
};

// In ulps of the largest coordinate or distance: a point cannot be told more precisely.
double ulps(double t, const Precise& exact, const Shot& shot) {
  const Vec3 o = glm::abs(shot.origin);
  const double size = std::max({std::abs(static_cast<double>(exact)), double{o.x}, double{o.y}, double{o.z}, 1e-30});
  return std::abs(static_cast<double>(Precise(t - exact))) / (std::exp2(std::floor(std::log2(size))) * 0x1p-23);
}

constexpr double kAtClip = 1e-4;  // of the distances: nearer to the clip's ends a root may count or not

// What is true of a ray: all roots in the clip and a little beyond, and where those begin and end that must count.
struct Truth {
  bool in_clip = false;
  std::vector<Precise> roots;
  Precise begin, end;
};

Truth truth_of(const Expression& expression, const shared::Shape& surface, const Shot& shot) {
  Truth truth;
  const auto range = in_clip(surface, shot);
  if (!range) return truth;
  truth.in_clip = true;
  const auto [t0, t1] = *range;
  const double pad = kAtClip * (std::abs(t0) + std::abs(t1));
  const double m = 0.5 * (t0 + t1), h = 0.5 * (t1 - t0) + pad;
  const PrecisePolynomial p = along(expression, surface, shot, m, h);
  for (const Precise& s : reference::roots_between(p, -1, 1)) truth.roots.push_back(Precise(m) + Precise(h) * s);
  truth.begin = t0 == shot.t_min ? Precise(t0) : Precise(t0 + pad);
  truth.end = t1 - pad;
  return truth;
}

// Ulps beyond which a hit is no root of the ray. At a near-tangent a root is where the error lets it be: float-float's
// is 300 times that of double, its root's 18 times.
constexpr double kSameRoot = 1e3, kSameRootFloatFloat = 18e3;

Tally judge(const std::vector<Shot>& shots, const std::vector<Truth>& truths, const Answers& answers,
            double same_root) {
  Tally tally;
  for (std::size_t i = 0; i < shots.size(); i++) {
    const double t = answers.found[3 * i].w;
    const bool hit = t >= 0.0, sure = answers.open[i] == 0;
    const Truth& truth = truths[i];
    tally.hits += hit ? 1 : 0;
    tally.open += sure ? 0 : 1;
    const auto first = std::find_if(truth.roots.begin(), truth.roots.end(),
                                    [&truth](const Precise& r) { return r > truth.begin && r < truth.end; });
    if (!hit) {
      if (first != truth.roots.end() && sure) tally.missed++;
      continue;
    }
    double nearest = std::numeric_limits<double>::infinity();
    Precise met = 0;
    for (const Precise& r : truth.roots) {
      const double off = ulps(t, r, shots[i]);
      if (off < nearest) met = r;
      nearest = std::min(nearest, off);
    }
    if (!(nearest <= same_root)) {
      tally.invented++;
      continue;
    }
    if (first != truth.roots.end() && *first < met && sure) tally.missed++;
    if (nearest > 1.0) tally.imprecise++;
    tally.worst_ulps = std::max(tally.worst_ulps, nearest);
  }
  return tally;
}

class Places {
 public:
  explicit Places(unsigned seed) : engine_(seed) {}
  double in(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine_); }
  DVec3 in_cube(double size) { return {in(-size, size), in(-size, size), in(-size, size)}; }
  DVec3 direction() {
    for (;;) {
      const DVec3 v = in_cube(1.0);
      const double length = glm::length(v);
      if (length > 0.1 && length < 1.0) return v / length;
    }
  }

 private:
  std::mt19937 engine_;
};

DVec3 gradient(const Expression& expression, const DVec3& p) {
  DVec3 g;
  for (int k = 0; k < 3; k++) {
    DVec3 step(0.0);
    step[k] = 1e-5;
    g[k] = evaluate(expression, p + step) - evaluate(expression, p - step);
  }
  return glm::normalize(g);
}

// A third through the clip at random, a third past points of the surface along tangents, higher or lower by up to 1e-3
// and down to nothing, a third from points on the surface, as shadow rays leave it.
std::vector<Shot> make_shots(const Form& form, const Expression& expression, const DMat3& turn, double scale,
                             const DVec3& center, std::size_t count, Places& places) {
  std::vector<Shot> shots;
  const auto world = [&](const DVec3& p) { return center + turn * (scale * p); };
  const auto add = [&](const DVec3& from, const DVec3& way) {
    shots.push_back({Vec3(world(from)), Vec3(glm::normalize(turn * way))});
  };
  while (shots.size() < count) {
    const DVec3 from = 3.0 * form.clip * places.direction(), way = glm::normalize(places.in_cube(form.clip) - from);
    add(from, way);
    double before = 0.0, t = 1.5 * form.clip;
    for (; t < 5.0 * form.clip; t += 0.02) {
      const double now = evaluate(expression, from + t * way);
      if (before * now < 0.0) break;
      before = now;
    }
    if (t >= 5.0 * form.clip) continue;
    double lo = t - 0.02, hi = t;
    for (int i = 0; i < 50; i++) {
      const double mid = 0.5 * (lo + hi);
      (evaluate(expression, from + mid * way) * before > 0.0 ? lo : hi) = mid;
    }
    const DVec3 p = from + lo * way, n = gradient(expression, p);
    if (!(std::abs(glm::length(n) - 1.0) < 0.1)) continue;
    const DVec3 tangent = glm::normalize(glm::cross(n, places.direction()));
    const double off = (shots.size() % 2 == 0 ? 1.0 : -1.0) * std::exp2(places.in(-30.0, -10.0));
    add(p - 2.0 * form.clip * tangent + (shots.size() % 5 == 0 ? 0.0 : off) * n, tangent);
    add(p + 3e-7 * n, glm::dot(n, way) < 0.0 ? places.direction() : -way);
  }
  shots.resize(count);
  return shots;
}

std::size_t ray_count() {
  const char* wanted = std::getenv("HEMIRAY_TEST_RAYS");
  return wanted ? static_cast<std::size_t>(std::atoll(wanted)) : 1000;
}

}  // namespace

TEST_CASE("implicit surfaces: no first root is missed and none invented") {
  Places places(11);
  const DMat3 turn = glm::transpose(DMat3(glm::rotate(DMat4(1.0), 0.7, glm::normalize(DVec3(1, 2, 3)))));
  for (const Form& form : forms()) {
    const Expression expression = parse_expression(form.text, form.constants);
    for (const bool far : {false, true}) {
      const double scale = far ? 0.1 : 1.0;
      const DVec3 center = far ? DVec3(10, -20, 5) : DVec3(0.0);
      const DMat3 turned = far ? turn : DMat3(1.0);
      const shared::Shape surface = place(form, expression, turned, scale, center);
      const std::size_t count = ray_count() / (far ? 4 : 1) / (expression.degree > 8 ? 4 : 1);
      const std::vector<Shot> shots = make_shots(form, expression, turned, scale, center, count, places);
      std::vector<Truth> truths;
      for (const Shot& shot : shots) truths.push_back(truth_of(expression, surface, shot));
      std::vector<std::string> methods = {"#define HR_WITHOUT_DOUBLE\n"};
      if (choose_device("").has_fp64) methods.insert(methods.begin(), {"", "#define HR_POLY_STURM\n"});
      for (const std::string& defines : methods) {
        const Tally tally =
            judge(shots, truths, shoot(expression, surface, shots, defines),
                  defines.find("WITHOUT_DOUBLE") == std::string::npos ? kSameRoot : kSameRootFloatFloat);
        const std::string report = std::string(form.name) + (far ? ", small and far" : "") + ", degree " +
                                   std::to_string(expression.degree) + ", " + defines + ": " +
                                   std::to_string(shots.size()) + " rays, " + std::to_string(tally.hits) + " hits, " +
                                   std::to_string(tally.open) + " uncertain, " + std::to_string(tally.imprecise) +
                                   " beyond 1 ulp, worst " + std::to_string(tally.worst_ulps) + " ulps";
        INFO(report);
        if (std::getenv("HEMIRAY_TEST_RAYS")) WARN(report);
        CHECK(tally.missed == 0);
        CHECK(tally.invented == 0);
        CHECK(tally.hits > shots.size() / 4);
        CHECK(static_cast<double>(tally.open) <= form.most_open * static_cast<double>(shots.size()) + 1.0);
      }
    }
  }
}

TEST_CASE("implicit surfaces: the bound of the coefficients' error holds, and is not idle") {
  Places places(12);
  for (const Form& form : forms()) {
    const Expression expression = parse_expression(form.text, form.constants);
    const shared::Shape surface = place(form, expression, DMat3(1.0), 0.7, DVec3(0.3, -0.2, 5.0));
    // About t = t_min; half of them from so far away that d t and o, which cancel, must not count as rounded.
    std::vector<Shot> shots;
    for (int i = 0; i < 100; i++) {
      const DVec3 near = DVec3(0.3, -0.2, 5.0) + 3.0 * places.direction();
      shots.push_back({Vec3(near), Vec3(-glm::normalize(near + 0.1 * places.in_cube(1.0))), 3.0F});
      const DVec3 way = places.direction();
      shots.push_back({Vec3(DVec3(0.3, -0.2, 5.0) - 1e6 * way), Vec3(way), 1e6F});
    }
    for (const bool wide : {false, true}) {
      for (const std::string defines : {"", "#define HR_WITHOUT_DOUBLE\n"}) {
        // Two floats cannot bring back what double knows.
        if (defines.empty() && (wide || !choose_device("").has_fp64)) continue;
        const auto found = run<shared::float2>("polynomials", expression, surface, shots, defines, 36, nullptr);
        double worst[2] = {};
        for (std::size_t i = 0; i < shots.size(); i++) {
          const PrecisePolynomial exact = along(expression, surface, shots[i], shots[i].t_min, 2.0);
          const std::size_t first = 36 * i + (wide ? 18 : 0);
          Precise off = 0;
          for (std::size_t k = 0; k <= HR_MAX_DEGREE; k++) {
            const Precise c = Precise(found[first + k].x) + Precise(found[first + k].y);
            off += abs(Precise(c - (k < exact.size() ? exact[k] : Precise(0))));
          }
          worst[i % 2] = std::max(worst[i % 2], static_cast<double>(off) / double{found[first + 17].x});
        }
        INFO(form.name << (wide ? ", wide " : ", float ") << defines << ": largest errors " << worst[0] << " and, far, "
                       << worst[1] << " of their bounds");
        for (const double one : worst) {
          CHECK(one <= 1.0);
          if (!wide) CHECK(one > 0.02);
        }
      }
    }
  }
}

TEST_CASE("implicit sphere: the source's worked example, to the last bit") {
  const Form form = {"sphere", "x^2 + y^2 + z^2 - 4", {}, 2.5F};
  const Expression expression = parse_expression(form.text, {});
  const shared::Shape surface = place(form, expression, DMat3(1.0), 1.0, DVec3(0.0));
  const Answers answers = shoot(expression, surface, {{{1, 1, 0}, {2, 1, 1}}}, "");
  const double root = std::sqrt(21.0);
  CHECK(answers.open[0] == 0);
  CHECK(answers.found[0].w == static_cast<float>((-3 + root) / 6));
  CHECK(answers.found[0].x == Approx(root / 3).epsilon(2e-7));
  CHECK(answers.found[0].y == Approx((3 + root) / 6).epsilon(2e-7));
  CHECK(answers.found[0].z == Approx((-3 + root) / 6).epsilon(2e-7));
  CHECK(answers.found[1].x == Approx(root / 6).epsilon(2e-7));  // the normal is the point halved
  CHECK(answers.found[1].y == Approx((3 + root) / 12).epsilon(2e-7));
}

}  // namespace hemiray

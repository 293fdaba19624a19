#include "host/radiosity/level_set.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "host/scene/tape_value.hpp"

namespace hemiray {
namespace {

constexpr double kPad = 0.02;        // of the box, beyond bounds that are mostly exact to 1/250
constexpr double kOnClip = 1e-6;     // of the box: points that were rounded to float are still on the clip
constexpr double kSnap = 0.3;        // of a cell: a grid point so near moves onto the surface, else there are slivers
constexpr double kSharp = 0.75;      // cosine between a triangle and its corners' normals: 41 degrees
constexpr double kMostSharp = 0.01;  // share of triangles
constexpr int kLeastCells = 6, kMostCells = 48;
constexpr int kNewtonSteps = 8;

DVec3 rgb(const shared::float4& v) { return {v.x, v.y, v.z}; }

// A number with its gradient.
struct Dual {
  double value = 0.0;
  DVec3 slope{0.0};
  Dual(double v, const DVec3& s = DVec3(0.0)) : value(v), slope(s) {}  // NOLINT(google-explicit-constructor)
};
Dual operator-(const Dual& a) { return {-a.value, -a.slope}; }
Dual operator+(const Dual& a, const Dual& b) { return {a.value + b.value, a.slope + b.slope}; }
Dual operator-(const Dual& a, const Dual& b) { return {a.value - b.value, a.slope - b.slope}; }
Dual operator*(const Dual& a, const Dual& b) { return {a.value * b.value, a.value * b.slope + b.value * a.slope}; }
Dual square(const Dual& a) { return a * a; }

// The degree of a polynomial, of constants 0.
struct Degree {
  int value = 0;
  explicit Degree(double) {}
  explicit Degree(int degree) : value(degree) {}
};
Degree operator-(const Degree& a) { return a; }
Degree operator+(const Degree& a, const Degree& b) { return Degree(std::max(a.value, b.value)); }
Degree operator-(const Degree& a, const Degree& b) { return a + b; }
Degree operator*(const Degree& a, const Degree& b) { return Degree(a.value + b.value); }
Degree square(const Degree& a) { return a * a; }

// The tetrahedra around a cube's diagonal (Kuhn): neighbouring cubes cut their common face alike.
constexpr std::array<std::array<int, 4>, 6> kTetrahedra = {
    {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};

// A point of the grid: on the front where f >= 0; exactly 0 where it was moved onto the surface.
struct Node {
  std::size_t index = 0;
  DVec3 place{0.0};
  double f = 0.0;
};

}  // namespace

LevelSet::LevelSet(const shared::Shape& shape, std::span<const shared::uint4> tapes) {
  if (shape.kind == HR_SHAPE_IMPLICIT) {
    tape_ = tapes.subspan(std::bit_cast<std::uint32_t>(shape.form.x), std::bit_cast<std::uint32_t>(shape.form.y));
    middle_ = rgb(shape.linear);
  } else {
    const DVec3 own = rgb(shape.form), mixed = rgb(shape.mixed);
    a_ = DMat3(own.x, mixed.x, mixed.z, mixed.x, own.y, mixed.y, mixed.z, mixed.y, own.z);
    b_ = rgb(shape.linear);
    c_ = static_cast<double>(shape.form.w);
  }
  if ((shape.flags & HR_SHAPE_CLIP_SPHERE) != 0) ball_ = static_cast<double>(shape.clip.w);
  find_box(shape);
}

// The clip's box, or an ellipsoid's own, less what the bounds in the world leave out.
void LevelSet::find_box(const shared::Shape& shape) {
  DVec3 half = ball_ > 0.0 ? DVec3(ball_) : rgb(shape.clip);
  if ((shape.flags & (HR_SHAPE_CLIP_SPHERE | HR_SHAPE_CLIP_BOX)) == 0) {
    const DMat3 spread = glm::inverse(a_) * -c_;
    half = (1.0 + kPad) * glm::sqrt(glm::max(DVec3(spread[0][0], spread[1][1], spread[2][2]), 0.0));
  }
  const DMat3 to_own = glm::transpose(DMat3(rgb(shape.to_own_x), rgb(shape.to_own_y), rgb(shape.to_own_z)));
  const DVec3 place(shape.to_own_x.w, shape.to_own_y.w, shape.to_own_z.w);
  DVec3 lo(INFINITY), hi(-INFINITY);
  for (int corner = 0; corner < 8; corner++) {
    const DVec3 world((corner & 1) != 0 ? shape.hi.x : shape.lo.x, (corner & 2) != 0 ? shape.hi.y : shape.lo.y,
                      (corner & 4) != 0 ? shape.hi.z : shape.lo.z);
    const DVec3 own = to_own * (world - place);
    lo = glm::min(lo, own);
    hi = glm::max(hi, own);
  }
  const DVec3 pad = kPad * half;
  lo_ = glm::max(middle_ - half, lo - pad);
  hi_ = glm::min(middle_ + half, hi + pad);
}

LevelSet::Value LevelSet::at(const DVec3& p) const {
  if (tape_.empty()) {
    const DVec3 product = a_ * p;
    return {glm::dot(p, product + 2.0 * b_) + c_, 2.0 * (product + b_)};
  }
  const Dual f = evaluate_tape<Dual>(tape_, {p.x, {1, 0, 0}}, {p.y, {0, 1, 0}}, {p.z, {0, 0, 1}});
  return {f.value, f.slope};
}

int LevelSet::degree() const {
  return tape_.empty() ? 2 : evaluate_tape<Degree>(tape_, Degree(1), Degree(1), Degree(1)).value;
}

double LevelSet::size() const { return 0.5 * std::max({hi_.x - lo_.x, hi_.y - lo_.y, hi_.z - lo_.z}); }

LevelSet::Plane LevelSet::ball_at(const DVec3& p) const {
  const DVec3 from = p - middle_;
  const double distance = glm::length(from);
  return {distance - ball_, distance > 0.0 ? from / distance : DVec3(0.0)};
}

// Newton's method to the surface, and to the ball's or along a face of the box; nothing where it leads farther than
// `reach`.
std::optional<DVec3> LevelSet::onto(const DVec3& from, bool to_ball, int fixed_axis, double reach) const {
  DVec3 p = from;
  for (int step = 0; step < kNewtonSteps; step++) {
    Value v = at(p);
    if (fixed_axis >= 0) v.gradient[fixed_axis] = 0.0;
    const double gg = glm::dot(v.gradient, v.gradient);
    if (!(gg > 0.0)) return {};
    if (to_ball) {
      const Plane ball = ball_at(p);
      const double gn = glm::dot(v.gradient, ball.gradient), determinant = gg - gn * gn;
      if (!(determinant > 1e-6 * gg)) return {};
      const double by_f = (-v.f + gn * ball.value) / determinant, by_ball = -ball.value - gn * by_f;
      p += by_f * v.gradient + by_ball * ball.gradient;
    } else {
      p -= v.f / gg * v.gradient;
    }
    if (!(glm::distance(p, from) <= reach)) return {};
  }
  return p;
}

std::optional<DVec3> LevelSet::halfway(const DVec3& a, const DVec3& b) const {
  const DVec3 middle = 0.5 * (a + b);
  const double near = kOnClip * size();
  const auto on_ball = [&](const DVec3& p) { return ball_ > 0.0 && std::abs(ball_at(p).value) < near; };
  int axis = -1;
  for (int k = 0; k < 3 && ball_ == 0.0; k++) {
    for (const double face : {lo_[k], hi_[k]}) {
      if (std::abs(a[k] - face) < near && std::abs(b[k] - face) < near) axis = k;
    }
  }
  return onto(middle, on_ball(a) && on_ball(b), axis, kMostArrow * glm::distance(a, b));
}

std::vector<LevelSet::Triangle> LevelSet::march(int cells) const {
  const double step = 2.0 * size() / cells;
  std::array<int, 3> count{};
  for (int k = 0; k < 3; k++)
    count[static_cast<std::size_t>(k)] = std::max(1, static_cast<int>(std::ceil((hi_[k] - lo_[k]) / step - 1e-9)));
  const auto index = [&](int x, int y, int z) {
    return static_cast<std::size_t>((z * (count[1] + 1) + y) * (count[0] + 1) + x);
  };
  std::vector<Node> nodes(index(0, 0, count[2] + 1));
  for (int z = 0; z <= count[2]; z++) {
    for (int y = 0; y <= count[1]; y++) {
      for (int x = 0; x <= count[0]; x++) {
        const std::array<int, 3> at_grid = {x, y, z};
        Node& node = nodes[index(x, y, z)];
        DVec3 free(1.0);
        for (int k = 0; k < 3; k++) {
          const int i = at_grid[static_cast<std::size_t>(k)], n = count[static_cast<std::size_t>(k)];
          node.place[k] = i == n ? hi_[k] : lo_[k] + (hi_[k] - lo_[k]) * i / n;
          if (i == 0 || i == n) free[k] = 0.0;
        }
        node.index = index(x, y, z);
        node.f = at(node.place).f;
        DVec3 p = node.place;
        for (int i = 0; i < kNewtonSteps; i++) {
          const Value v = at(p);
          const DVec3 g = v.gradient * free;
          const double gg = glm::dot(g, g);
          if (!(gg > 0.0)) break;
          p -= v.f / gg * g;
          if (!(glm::distance(p, node.place) < kSnap * step)) break;
          if (i + 1 == kNewtonSteps) {
            node.place = p;
            node.f = 0.0;
          }
        }
      }
    }
  }
  // Where the surface crosses from front to back: the same bits from whichever tetrahedron.
  const auto crossing = [this](const Node& front, const Node& back) {
    if (front.f == 0.0) return front.place;
    DVec3 p = front.place, q = back.place;
    for (int i = 0; i < 60; i++) {
      const DVec3 middle = 0.5 * (p + q);
      (at(middle).f >= 0.0 ? p : q) = middle;
    }
    return p;
  };
  std::vector<Triangle> triangles;
  const auto add = [&](const DVec3& a, DVec3 b, DVec3 c, const DVec3& forward) {
    if (a == b || b == c || c == a) return;
    if (glm::dot(glm::cross(b - a, c - a), forward) < 0.0) std::swap(b, c);
    if (ball_ > 0.0) {
      add_within_ball({a, b, c}, triangles);
    } else {
      triangles.push_back({a, b, c});
    }
  };
  for (int z = 0; z < count[2]; z++) {
    for (int y = 0; y < count[1]; y++) {
      for (int x = 0; x < count[0]; x++) {
        for (const auto& tetrahedron : kTetrahedra) {
          std::vector<const Node*> fronts, backs;
          DVec3 forward(0.0);
          for (const int corner : tetrahedron) {
            const Node& node = nodes[index(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2 & 1))];
            (node.f >= 0.0 ? fronts : backs).push_back(&node);
          }
          if (fronts.empty() || backs.empty()) continue;
          for (const Node* node : fronts) forward += node->place / static_cast<double>(fronts.size());
          for (const Node* node : backs) forward -= node->place / static_cast<double>(backs.size());
          std::vector<DVec3> corners;  // in turn around the cut
          if (fronts.size() == 2) {
            corners = {crossing(*fronts[0], *backs[0]), crossing(*fronts[0], *backs[1]),
                       crossing(*fronts[1], *backs[1]), crossing(*fronts[1], *backs[0])};
            add(corners[0], corners[2], corners[3], forward);
          } else {
            for (const Node* front : fronts) {
              for (const Node* back : backs) corners.push_back(crossing(*front, *back));
            }
          }
          add(corners[0], corners[1], corners[2], forward);
        }
      }
    }
  }
  return triangles;
}

void LevelSet::add_within_ball(const Triangle& triangle, std::vector<Triangle>& triangles) const {
  std::vector<DVec3> polygon;
  for (std::size_t i = 0; i < 3; i++) {
    const DVec3 &a = triangle[i], &b = triangle[(i + 1) % 3];
    const double va = ball_at(a).value, vb = ball_at(b).value;
    if (va <= 0.0) polygon.push_back(a);
    if ((va <= 0.0) == (vb <= 0.0)) continue;
    DVec3 in = va <= 0.0 ? a : b, out = va <= 0.0 ? b : a;
    const double reach = glm::distance(in, out);
    for (int k = 0; k < 60; k++) {
      const DVec3 middle = 0.5 * (in + out);
      (ball_at(middle).value <= 0.0 ? in : out) = middle;
    }
    polygon.push_back(onto(in, true, -1, reach).value_or(in));
  }
  for (std::size_t i = 2; i < polygon.size(); i++) {
    if (polygon[0] != polygon[i - 1] && polygon[i - 1] != polygon[i] && polygon[i] != polygon[0]) {
      triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
    }
  }
}

double LevelSet::share_of_sharp(const std::vector<Triangle>& triangles) const {
  std::size_t sharp = 0;
  for (const Triangle& t : triangles) {
    const DVec3 cross = glm::cross(t[1] - t[0], t[2] - t[0]);
    sharp += std::ranges::any_of(t, [&](const DVec3& p) {
      const DVec3 g = at(p).gradient;
      return glm::dot(cross, g) < kSharp * glm::length(cross) * glm::length(g);
    });
  }
  return static_cast<double>(sharp) / static_cast<double>(std::max<std::size_t>(triangles.size(), 1));
}

std::vector<LevelSet::Triangle> LevelSet::triangles() const {
  int cells = std::max(kLeastCells, 2 * degree());  // a line may cross the surface as often as its degree says
  for (;; cells = std::min(kMostCells, cells * 3 / 2)) {
    std::vector<Triangle> found = march(cells);
    if (cells >= kMostCells || (!found.empty() && share_of_sharp(found) <= kMostSharp)) return found;
  }
}

}  // namespace hemiray

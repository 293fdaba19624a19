#include "host/radiosity/round_surface.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>

namespace hemiray {
namespace {

constexpr int kSides = 12;  // of a cone, before edges are halved
// A vertex is on the rim if its distance from the axis is the radius but for roundings to float and back.
constexpr double kOnRim = 1e-5;

constexpr double kGolden = std::numbers::phi;
constexpr std::array<std::array<double, 3>, 12> kIcosahedron = {{{-1, kGolden, 0},
                                                                 {1, kGolden, 0},
                                                                 {-1, -kGolden, 0},
                                                                 {1, -kGolden, 0},
                                                                 {0, -1, kGolden},
                                                                 {0, 1, kGolden},
                                                                 {0, -1, -kGolden},
                                                                 {0, 1, -kGolden},
                                                                 {kGolden, 0, -1},
                                                                 {kGolden, 0, 1},
                                                                 {-kGolden, 0, -1},
                                                                 {-kGolden, 0, 1}}};
constexpr std::array<std::array<std::uint32_t, 3>, 20> kIcosahedronFaces = {
    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};

DVec3 rgb(const shared::float4& v) { return {v.x, v.y, v.z}; }

}  // namespace

DVec3 RoundSurface::halfway(const DVec3& a, const DVec3& b) const {
  const DVec3 p = to_own * (a - place), q = to_own * (b - place);
  DVec3 middle = 0.5 * (p + q);
  if (kind == Kind::level) {
    middle = level->halfway(p, q).value_or(middle);
  } else if (kind == Kind::sphere) {
    middle *= radius / glm::length(middle);
  } else {
    const auto off_rim = [this](const DVec3& point) {
      const double r = radius + slope * point.z;
      return std::abs(std::hypot(point.x, point.y) - r) > kOnRim * radius;
    };
    const double across = std::hypot(middle.x, middle.y);
    if (off_rim(p) || off_rim(q) || !(across > 0.0)) return 0.5 * (a + b);
    const double scale = (radius + slope * middle.z) / across;
    middle = {middle.x * scale, middle.y * scale, middle.z};
  }
  return place + to_world * middle;
}

double RoundSurface::arrow(const DVec3& a, const DVec3& b) const {
  const bool unknown = kind == Kind::level && !level->halfway(to_own * (a - place), to_own * (b - place));
  return unknown ? kMostArrow * glm::distance(a, b) : glm::length(halfway(a, b) - 0.5 * (a + b));
}

double RoundSurface::distance(const DVec3& p) const {
  const DVec3 own = to_own * (p - place);
  if (kind == Kind::level) {
    const LevelSet::Value v = level->at(own);
    const double steepness = glm::length(glm::transpose(to_own) * v.gradient);
    return steepness > 0.0 ? std::abs(v.f) / steepness : 0.0;
  }
  if (kind == Kind::sphere) return glm::length(to_world * (own * (radius / glm::length(own) - 1.0)));
  const double across = std::hypot(own.x, own.y);
  if (!(across > 0.0)) return 0.0;
  const double off = (radius + slope * own.z) / across - 1.0;
  return glm::length(to_world * DVec3(own.x * off, own.y * off, 0.0));
}

DVec3 RoundSurface::normal(const DVec3& p) const {
  const DVec3 own = to_own * (p - place);
  const DVec3 out = kind == Kind::level    ? level->at(own).gradient
                    : kind == Kind::sphere ? own
                                           : DVec3(own.x, own.y, -slope * std::hypot(own.x, own.y));
  return out == DVec3(0.0) ? out : glm::normalize(glm::transpose(to_own) * out);
}

RoundSurface round_sphere(const shared::Sphere& sphere) {
  RoundSurface surface;
  surface.place = rgb(sphere.center_radius);
  surface.radius = static_cast<double>(sphere.center_radius.w);
  return surface;
}

RoundSurface round_shape(const shared::Shape& shape, std::span<const shared::uint4> tapes) {
  RoundSurface surface;
  surface.kind = RoundSurface::Kind::cone;
  surface.to_own = glm::transpose(DMat3(rgb(shape.to_own_x), rgb(shape.to_own_y), rgb(shape.to_own_z)));
  surface.to_world = glm::inverse(surface.to_own);
  surface.place = {shape.to_own_x.w, shape.to_own_y.w, shape.to_own_z.w};
  if (shape.kind == HR_SHAPE_QUADRIC || shape.kind == HR_SHAPE_IMPLICIT) {
    surface.kind = RoundSurface::Kind::level;
    surface.level = std::make_shared<LevelSet>(shape, tapes);
    surface.radius = surface.level->size();
    return surface;
  }
  surface.radius = static_cast<double>(shape.form.x);
  if (shape.kind == HR_SHAPE_CONE) {
    surface.slope = static_cast<double>(shape.form.y);
    surface.half_height = static_cast<double>(shape.form.z);
  }
  return surface;
}

std::vector<RoundFace> round_faces(const RoundSurface& surface, const shared::Shape* shape) {
  std::vector<RoundFace> faces;
  const auto place = [&surface](const DVec3& own) { return surface.place + surface.to_world * own; };
  if (shape == nullptr) {
    for (const auto& f : kIcosahedronFaces) {
      RoundFace face{{}, false};
      for (std::size_t i = 0; i < 3; i++) {
        const auto& v = kIcosahedron[f[i]];
        face.corners[i] = place(surface.radius * glm::normalize(DVec3(v[0], v[1], v[2])));
      }
      faces.push_back(face);
    }
    return faces;
  }
  const bool turned = glm::determinant(surface.to_own) < 0.0;
  const auto add = [&](const DVec3& a, const DVec3& b, const DVec3& c, bool flat) {
    faces.push_back({{place(a), place(turned ? c : b), place(turned ? b : c)}, flat});
  };
  if (surface.kind == RoundSurface::Kind::level) {
    for (const LevelSet::Triangle& t : surface.level->triangles()) add(t[0], t[1], t[2], false);
    return faces;
  }
  const double h = surface.half_height;
  const auto rim = [&](int i, double z) {
    const double angle = 2.0 * std::numbers::pi * (i % kSides) / kSides, r = surface.radius + surface.slope * z;
    return DVec3(r * std::cos(angle), r * std::sin(angle), z);
  };
  const bool disk = shape->kind == HR_SHAPE_DISK;
  const double lower = surface.radius - surface.slope * h, upper = surface.radius + surface.slope * h;
  const double none = kOnRim * surface.radius;
  for (int i = 0; i < kSides; i++) {
    if (disk) {
      add({0, 0, 0}, rim(i, 0.0), rim(i + 1, 0.0), true);
      continue;
    }
    if (lower > none) add(rim(i, -h), rim(i + 1, -h), upper > none ? rim(i + 1, h) : DVec3(0, 0, h), false);
    if (upper > none) add(lower > none ? rim(i, -h) : DVec3(0, 0, -h), rim(i + 1, h), rim(i, h), false);
    if ((shape->flags & HR_SHAPE_CAPPED) == 0) continue;
    if (lower > none) add({0, 0, -h}, rim(i + 1, -h), rim(i, -h), true);
    if (upper > none) add({0, 0, h}, rim(i, h), rim(i + 1, h), true);
  }
  return faces;
}

}  // namespace hemiray

#include "host/radiosity/patch_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "host/base/error.hpp"
#include "host/radiosity/cut_patches.hpp"
#include "host/radiosity/round_surface.hpp"

namespace hemiray {
namespace {

constexpr double kDefaultChord = 0.01;  // of a round surface's radius
constexpr std::uint32_t kMostPatches = 1U << 22U;

// A triangle's corners while it is cut: places decide, so that both sides of an edge decide alike.
struct Corner {
  Vec3 position;
  std::uint32_t vertex = 0;  // of what is written, or of nothing while counting
};

// The radius in the world, of something that is no ball any more its largest.
double size_of(const RoundSurface& round) {
  const DMat3& m = round.to_world;
  return round.radius * std::max({glm::length(m[0]), glm::length(m[1]), glm::length(m[2])});
}

struct Targets {
  double edge_m;
  double chord_m;
};

double length2(const Vec3& a, const Vec3& b) {
  const DVec3 d = DVec3(a) - DVec3(b);
  return glm::dot(d, d);
}

Vec3 middle_of(const Vec3& a, const Vec3& b, const RoundSurface* round) {
  return Vec3(round == nullptr ? 0.5 * (DVec3(a) + DVec3(b)) : round->halfway(DVec3(a), DVec3(b)));
}

bool is_too_long(const Vec3& a, const Vec3& b, const RoundSurface* round, const Targets& targets) {
  if (length2(a, b) > targets.edge_m * targets.edge_m) return true;
  if (round == nullptr) return false;
  // A triangle of three such edges lies below its surface by up to edge^2 / (6 r), its edges by edge^2 / (8 r).
  return round->arrow(DVec3(a), DVec3(b)) * 4.0 / 3.0 > targets.chord_m;
}

// Longest-edge bisection (Rivara 1984): an edge is halved if and only if it is too long, whoever looks at it, so there
// are no T-junctions; of a flat triangle no angle falls below half of the smallest one. `split` tells of a new vertex,
// `leaf` takes what is small enough.
template <typename Split, typename Leaf>
void bisect(std::array<Corner, 3> t, const RoundSurface* round, const Targets& targets, const Split& split,
            const Leaf& leaf) {
  std::size_t longest = 3;
  double longest2 = -1.0;
  for (std::size_t i = 0; i < 3; i++) {
    const Vec3 &a = t[i].position, &b = t[(i + 1) % 3].position;
    if (length2(a, b) > longest2 && is_too_long(a, b, round, targets)) {
      longest = i;
      longest2 = length2(a, b);
    }
  }
  if (longest == 3) {
    leaf(t);
    return;
  }
  const Corner &a = t[longest], &b = t[(longest + 1) % 3], &c = t[(longest + 2) % 3];
  Corner middle{middle_of(a.position, b.position, round), 0};
  if (middle.position == a.position || middle.position == b.position) {  // no float lies between
    leaf(t);
    return;
  }
  middle.vertex = split(a, b, middle.position);
  bisect({a, middle, c}, round, targets, split, leaf);
  bisect({middle, b, c}, round, targets, split, leaf);
}

// What the scene's surfaces are before they are cut.
struct Face {
  std::array<std::uint32_t, 3> vertices;  // of the mesh that is written
  std::uint32_t material, object, face;
  const RoundSurface* round;  // or null
  bool flat;                  // lies in a plane, even if its rim is round
};

class Mesher {
 public:
  Mesher(const FlatScene& from, const PatchOptions& options) : from_(from), options_(options) {
    if (!from.planes.empty()) {
      throw InputError("radiosity", "the scene has an unbounded plane, which has no patches; use a quad in its place");
    }
    take_attributes();
    for (std::size_t i = 0; i < from.triangles.size(); i++) {
      const shared::uint4 t = from.triangles[i];
      faces_.push_back({{t.x, t.y, t.z}, t.w, from.triangle_objects[i], face_count_++, nullptr, true});
    }
    round_.reserve(from.spheres.size() + from.shapes.size());
    for (const shared::Sphere& s : from.spheres) add_round(round_sphere(s), nullptr, s.material, s.object);
    for (const shared::Shape& s : from.shapes) add_round(round_shape(s, from.tapes), &s, s.material, s.object);
    if (faces_.empty()) throw InputError("radiosity", "the scene has no surface that could be cut into patches");
  }

  PatchMesh make() {
    const double edge = options_.edge_m > 0.0 ? options_.edge_m : edge_for_budget();
    if (count(edge, kMostPatches) > kMostPatches) {
      throw InputError("patches",
                       fmt::format("edges of {} m make more than {} patches; take longer ones", edge, kMostPatches));
    }
    cut(edge);
    mesh_.face_count = face_count_;
    return std::move(mesh_);
  }

 private:
  // Smooth normals, texture coordinates and colours come along; a sphere's vertices have normals.
  void take_attributes() {
    FlatScene& to = mesh_.flat;
    to.positions = from_.positions;
    to.normals = from_.normals;
    to.uvs = from_.uvs;
    to.colors = from_.colors;
    to.materials = from_.materials;
    to.textures = from_.textures;
    to.texels = from_.texels;
    if ((!from_.spheres.empty() || !from_.shapes.empty()) && to.normals.empty())
      to.normals.resize(to.positions.size(), 0.0F);
  }

  // Each part is one face: all of it is reached by light, or nothing.
  void add_round(const RoundSurface& surface, const shared::Shape* shape, std::uint32_t material,
                 std::uint32_t object) {
    round_.push_back(surface);
    const RoundSurface* round = &round_.back();
    std::map<std::array<float, 3>, std::uint32_t> side, caps;  // vertices of the one have normals
    for (const RoundFace& f : round_faces(surface, shape)) {
      Face face{{}, material, object, face_count_ + (f.flat ? 1U : 0U), round, f.flat};
      for (std::size_t i = 0; i < 3; i++) {
        const Vec3 p(f.corners[i]);
        const auto [found, is_new] = (f.flat ? caps : side).try_emplace({p.x, p.y, p.z}, 0U);
        if (is_new)
          found->second = append_vertex(mesh_.flat, p, f.flat ? Vec3(0.0F) : Vec3(round->normal(f.corners[i])));
        face.vertices[i] = found->second;
      }
      faces_.push_back(face);
    }
    face_count_ += 2;
  }

  [[nodiscard]] Targets targets_for(const Face& face, double edge_m) const {
    if (face.round == nullptr) return {edge_m, 0.0};
    return {edge_m, options_.chord_m > 0.0 ? options_.chord_m : kDefaultChord * size_of(*face.round)};
  }

  [[nodiscard]] std::array<Corner, 3> corners_of(const Face& face) const {
    std::array<Corner, 3> t;
    for (std::size_t i = 0; i < 3; i++) t[i] = {position_of(mesh_.flat, face.vertices[i]), face.vertices[i]};
    return t;
  }

  // How many patches edges of that length make, or more than `most`.
  [[nodiscard]] std::uint64_t count(double edge_m, std::uint64_t most) const {
    std::uint64_t patches = 0;
    for (const Face& face : faces_) {
      const double size2 =
          length2(position_of(mesh_.flat, face.vertices[0]), position_of(mesh_.flat, face.vertices[1]));
      if (size2 / (edge_m * edge_m) > 4.0 * static_cast<double>(most)) return most + 1;
      bisect(
          corners_of(face), face.round, targets_for(face, edge_m),
          [](const Corner&, const Corner&, const Vec3&) { return 0U; },
          [&patches](const std::array<Corner, 3>&) { patches++; });
      if (patches > most) return most + 1;
    }
    return patches;
  }

  // The shortest edges that the budget allows; the scene's own if it has more patches already.
  [[nodiscard]] double edge_for_budget() const {
    double longest2 = 0.0;
    for (const Face& face : faces_) {
      const auto t = corners_of(face);
      for (std::size_t i = 0; i < 3; i++) {
        longest2 = std::max(longest2, length2(t[i].position, t[(i + 1) % 3].position));
      }
    }
    double too_short = 0.0, good = std::sqrt(longest2);
    constexpr int kSteps = 24;
    for (int i = 0; i < kSteps; i++) {
      const double middle = too_short == 0.0 ? good * 0.5 : 0.5 * (too_short + good);
      (count(middle, options_.patches) <= options_.patches ? good : too_short) = middle;
      if (too_short > 0.0 && good - too_short < 1e-3 * good) break;
    }
    return good;
  }

  void cut(double edge_m) {
    for (const Face& face : faces_) {
      const auto split = [&](const Corner& a, const Corner& b, const Vec3& place) {
        return middles_.halfway(a.vertex, b.vertex, place, face.flat ? nullptr : face.round);
      };
      const std::size_t first = mesh_.blockers.size();
      bisect(corners_of(face), face.round, targets_for(face, edge_m), split, [&](const std::array<Corner, 3>& t) {
        if (!add_patch(t, face)) return;
        const auto& v = face.vertices;
        if (face.round != nullptr) {
          mesh_.blockers.push_back(mesh_.flat.triangles.back());
        } else if (mesh_.blockers.size() == first) {
          mesh_.blockers.push_back({v[0], v[1], v[2], face.material});
        }
        mesh_.blocker_of.push_back(static_cast<std::uint32_t>(mesh_.blockers.size() - 1));
      });
    }
  }

  // False: it has no area, so nothing leaves it and nothing meets it.
  bool add_patch(const std::array<Corner, 3>& t, const Face& face) {
    const Vec3 &a = t[0].position, &b = t[1].position, &c = t[2].position;
    const std::optional<shared::float4> plane = plane_of(a, b, c);
    if (!plane) return false;
    mesh_.normals.push_back(*plane);
    mesh_.flat.triangles.push_back({t[0].vertex, t[1].vertex, t[2].vertex, face.material});
    mesh_.flat.triangle_objects.push_back(face.object);
    mesh_.faces.push_back(face.face);
    for (std::size_t i = 0; i < 3; i++) {
      mesh_.edge_m = std::max(mesh_.edge_m, std::sqrt(length2(t[i].position, t[(i + 1) % 3].position)));
    }
    if (face.round == nullptr) return true;
    // Of a cap only what its rim leaves out.
    for (std::size_t i = 0; i < 3 && face.flat; i++) {
      const DVec3 p(t[i].position), q(t[(i + 1) % 3].position);
      mesh_.chord_m = std::max(mesh_.chord_m, glm::length(face.round->halfway(p, q) - 0.5 * (p + q)));
    }
    if (!face.flat)
      mesh_.chord_m = std::max(mesh_.chord_m, face.round->distance((DVec3(a) + DVec3(b) + DVec3(c)) / 3.0));
    return true;
  }

  const FlatScene& from_;
  const PatchOptions& options_;
  PatchMesh mesh_;
  EdgeMiddles middles_{mesh_.flat};
  std::vector<Face> faces_;
  std::vector<RoundSurface> round_;
  std::uint32_t face_count_ = 0;
};

}  // namespace

PatchMesh make_patch_mesh(const FlatScene& flat, const PatchOptions& options) {
  PatchMesh mesh = Mesher(flat, options).make();
  read_patch_materials(flat, mesh);
  return mesh;
}

}  // namespace hemiray

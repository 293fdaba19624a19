#include "host/bench/leak_meshes.hpp"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "host/bench/flat_mesh.hpp"

namespace hemiray::bench {
namespace {

constexpr std::uint32_t kRaysFromOnePoint = 64;
constexpr std::array<std::uint32_t, 3> kPatchCells = {4, 16, 64};

// The vertices of a cube's lattice, made as they are first asked for.
class Lattice {
 public:
  Lattice(FlatMesh& mesh, std::uint32_t cells, bool round, Vec3 offset)
      : mesh_(&mesh), cells_(cells), round_(round), offset_(offset) {}

  std::uint32_t vertex(const std::array<std::uint32_t, 3>& place) {
    const std::uint64_t side = cells_ + std::uint64_t{1};
    const std::uint64_t key = (place[0] * side + place[1]) * side + place[2];
    const auto [found, is_new] = indices_.try_emplace(key, mesh_->vertex_count());
    if (is_new) {
      DVec3 p = DVec3(place[0], place[1], place[2]) * (2.0 / cells_) - 1.0;
      if (round_) p = glm::normalize(p);
      mesh_->vertex(Vec3(p + DVec3(offset_)));
    }
    return found->second;
  }

 private:
  FlatMesh* mesh_;
  std::uint32_t cells_;
  bool round_;
  Vec3 offset_;
  std::unordered_map<std::uint64_t, std::uint32_t> indices_;
};

// Neighbouring cells of one of the cube's six faces.
struct Patch {
  std::uint32_t face = 0, i = 0, j = 0, side = 1;
};

Patch random_patch(std::uint32_t cells, Dice& dice) {
  Patch patch;
  patch.face = dice.below(6);
  patch.side = std::min(cells, kPatchCells[dice.below(kPatchCells.size())]);
  patch.i = dice.below(cells - patch.side + 1);
  patch.j = dice.below(cells - patch.side + 1);
  return patch;
}

// By the order in which closed_mesh() makes them: face by face, row by row, two a cell.
std::uint32_t random_triangle(const Patch& patch, std::uint32_t cells, Dice& dice) {
  const std::uint32_t i = patch.i + dice.below(patch.side), j = patch.j + dice.below(patch.side);
  return ((patch.face * cells + i) * cells + j) * 2 + dice.below(2);
}

}  // namespace

FlatScene closed_mesh(std::uint32_t cells, bool round, Vec3 offset) {
  FlatMesh mesh;
  Lattice lattice(mesh, cells, round, offset);
  for (std::size_t axis = 0; axis < 3; axis++) {
    for (const std::uint32_t side : {0U, cells}) {
      for (std::uint32_t i = 0; i < cells; i++) {
        for (std::uint32_t j = 0; j < cells; j++) {
          const auto corner = [&](std::uint32_t u, std::uint32_t v) {
            std::array<std::uint32_t, 3> place{};
            place[axis] = side;
            place[(axis + 1) % 3] = i + u;
            place[(axis + 2) % 3] = j + v;
            return lattice.vertex(place);
          };
          const std::uint32_t a = corner(0, 0), c = corner(1, 1);
          std::uint32_t b = corner(1, 0), d = corner(0, 1);
          if (side == 0) std::swap(b, d);
          mesh.triangle(a, b, c);
          mesh.triangle(a, c, d);
        }
      }
    }
  }
  return std::move(mesh).take();
}

std::string to_string(LeakTarget target) { return target == LeakTarget::edges ? "edges" : "vertices"; }

std::vector<LeakMesh> leak_meshes(std::uint32_t cells) {
  std::vector<LeakMesh> meshes;
  for (const bool round : {true, false}) {
    for (const float moved : {0.0F, 100.0F}) {
      const std::string name = std::string(round ? "sphere" : "box") + (moved > 0 ? " moved by 100" : "");
      meshes.push_back({name, closed_mesh(cells, round, Vec3(moved)), Vec3(moved), cells});
    }
  }
  return meshes;
}

std::vector<shared::QueryRay> leak_rays(const LeakMesh& mesh, LeakTarget target, std::uint32_t count,
                                        std::uint32_t seed) {
  Dice dice(seed);
  std::vector<shared::QueryRay> rays(count);
  Vec3 origin = mesh.center;
  Patch patch;
  for (std::uint32_t i = 0; i < count; i++) {
    if (i % kRaysFromOnePoint == 0) {
      const float x = dice.in(-0.4F, 0.4F), y = dice.in(-0.4F, 0.4F), z = dice.in(-0.4F, 0.4F);
      origin = mesh.center + Vec3(x, y, z);
      patch = random_patch(mesh.cells, dice);
    }
    const shared::uint4 t = mesh.flat.triangles[random_triangle(patch, mesh.cells, dice)];
    const std::array<std::uint32_t, 4> corners{t.x, t.y, t.z, t.x};
    const std::uint32_t edge = dice.below(3);
    const DVec3 a = vertex_of(mesh.flat, corners[edge]), b = vertex_of(mesh.flat, corners[edge + 1]);
    const DVec3 aim = target == LeakTarget::vertices ? a : a + static_cast<double>(dice.unit()) * (b - a);
    const Vec3 direction(aim - DVec3(origin));
    rays[i] = {{origin.x, origin.y, origin.z, 0.0F}, {direction.x, direction.y, direction.z, 1e30F}};
  }
  return rays;
}

std::size_t count_leaks(std::span<const shared::QueryHit> hits) {
  return static_cast<std::size_t>(
      std::count_if(hits.begin(), hits.end(), [](const auto& hit) { return hit.primitive == HR_NO_PRIMITIVE; }));
}

std::size_t count_leaks(std::span<const std::uint32_t> occlusions) {
  return static_cast<std::size_t>(std::count(occlusions.begin(), occlusions.end(), 0U));
}

}  // namespace hemiray::bench

#include "host/radiosity/refine_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "host/radiosity/cut_patches.hpp"
#include "host/radiosity/mesh_edges.hpp"

namespace hemiray {
namespace {

constexpr std::uint32_t kNoEdge = 0xFFFFFFFFU;  // inside of what was a patch

// A patch, or a part of one, with the edges it has of the mesh: edge k runs from corner k to the next.
struct Part {
  std::array<std::uint32_t, 3> vertices, edges;
};

Vec3 middle_of(const FlatScene& flat, std::uint32_t a, std::uint32_t b) {
  return Vec3(0.5 * (DVec3(position_of(flat, a)) + DVec3(position_of(flat, b))));
}

class Refiner {
 public:
  explicit Refiner(const PatchMesh& mesh) : mesh_(mesh), edges_(mesh) {
    whole_.resize(edges_.lengths2.size(), false);
    for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
      const Part part = part_of(i);
      for (std::size_t k = 0; k < 3; k++) {
        const std::uint32_t a = part.vertices[k], b = part.vertices[(k + 1) % 3];
        const Vec3 middle = middle_of(mesh.flat, a, b);
        if (middle == position_of(mesh.flat, a) || middle == position_of(mesh.flat, b)) whole_[part.edges[k]] = true;
      }
    }
  }

  // Edges to halve, for these patches.
  [[nodiscard]] std::vector<bool> halved_for(std::span<const std::uint32_t> patches) const {
    std::vector<bool> halved(whole_.size(), false);
    for (const std::uint32_t i : patches) {
      for (const std::uint32_t edge : part_of(i).edges) halved[edge] = !whole_[edge];
    }
    for (bool again = true; again;) {
      again = false;
      for (std::uint32_t i = 0; i < mesh_.patch_count(); i++) {
        const Part part = part_of(i);
        const std::uint32_t longest = longest_of(part);
        if (cuts_of(part, halved) == 0 || halved[longest] || whole_[longest]) continue;
        halved[longest] = again = true;
      }
    }
    return halved;
  }

  // Each halved edge of a patch makes one more.
  [[nodiscard]] std::uint64_t patches_with(const std::vector<bool>& halved) const {
    std::uint64_t patches = mesh_.patch_count();
    for (std::uint32_t i = 0; i < mesh_.patch_count(); i++) patches += cuts_of(part_of(i), halved);
    return patches;
  }

  RefinedMesh make(const std::vector<bool>& halved) const {
    RefinedMesh result;
    result.mesh = mesh_;
    PatchMesh& mesh = result.mesh;
    EdgeMiddles middles(mesh.flat);
    result.parents.resize(mesh_.patch_count());
    std::iota(result.parents.begin(), result.parents.end(), 0U);
    for (std::uint32_t i = 0; i < mesh_.patch_count(); i++) {
      if (cuts_of(part_of(i), halved) == 0) continue;
      std::uint32_t place = i;  // the first part takes the patch's number
      cut(part_of(i), halved, middles, mesh.flat, [&](const std::array<std::uint32_t, 3>& v) {
        const std::optional<shared::float4> plane =
            plane_of(position_of(mesh.flat, v[0]), position_of(mesh.flat, v[1]), position_of(mesh.flat, v[2]));
        if (!plane) return;  // as of a scene's triangles without area
        if (place != i) append_copy(mesh, i);
        mesh.flat.triangles[place] = {v[0], v[1], v[2], mesh_.flat.triangles[i].w};
        mesh.normals[place] = *plane;
        if (place != i) result.parents.push_back(i);
        result.parts.push_back(place);
        place = mesh.patch_count();
      });
      result.cut++;
    }
    std::ranges::sort(result.parts);
    mesh.edge_m = std::sqrt(std::ranges::max(MeshEdges(mesh).lengths2));
    mesh.reflectance.clear();
    mesh.transmittance.clear();
    mesh.emission.clear();
    read_patch_materials(mesh.flat, mesh);
    return result;
  }

 private:
  [[nodiscard]] Part part_of(std::uint32_t i) const {
    const shared::uint4& t = mesh_.flat.triangles[i];
    const std::uint32_t* e = &edges_.of_patches[std::size_t{3} * i];
    return {{t.x, t.y, t.z}, {e[0], e[1], e[2]}};
  }

  static std::uint32_t cuts_of(const Part& part, const std::vector<bool>& halved) {
    return static_cast<std::uint32_t>(std::ranges::count_if(part.edges, [&](std::uint32_t e) { return halved[e]; }));
  }

  [[nodiscard]] bool is_longer(std::uint32_t a, std::uint32_t b) const {
    return edges_.lengths2[a] != edges_.lengths2[b] ? edges_.lengths2[a] > edges_.lengths2[b] : a < b;
  }

  [[nodiscard]] std::uint32_t longest_of(const Part& part) const {
    std::uint32_t longest = part.edges[0];
    for (const std::uint32_t edge : part.edges) longest = is_longer(edge, longest) ? edge : longest;
    return longest;
  }

  // Bisected at its longest halved edge, then both halves at theirs. `leaf` takes the parts' vertices.
  template <typename Leaf>
  void cut(const Part& part, const std::vector<bool>& halved, EdgeMiddles& middles, const FlatScene& flat,
           const Leaf& leaf) const {
    std::size_t at = 3;
    for (std::size_t k = 0; k < 3; k++) {
      const std::uint32_t edge = part.edges[k];
      if (edge != kNoEdge && halved[edge] && (at == 3 || is_longer(edge, part.edges[at]))) at = k;
    }
    if (at == 3) {
      leaf(part.vertices);
      return;
    }
    const std::uint32_t a = part.vertices[at], b = part.vertices[(at + 1) % 3], c = part.vertices[(at + 2) % 3];
    const std::uint32_t m = middles.halfway(a, b, middle_of(flat, a, b), nullptr);
    cut({{a, m, c}, {kNoEdge, kNoEdge, part.edges[(at + 2) % 3]}}, halved, middles, flat, leaf);
    cut({{m, b, c}, {kNoEdge, part.edges[(at + 1) % 3], kNoEdge}}, halved, middles, flat, leaf);
  }

  // But for its corners and what follows from them.
  static void append_copy(PatchMesh& mesh, std::uint32_t patch) {
    const auto again = [patch](auto& list) {
      const auto copy = list[patch];
      list.push_back(copy);
    };
    again(mesh.flat.triangles);
    again(mesh.flat.triangle_objects);
    again(mesh.normals);
    again(mesh.faces);
    again(mesh.blocker_of);
  }

  const PatchMesh& mesh_;
  MeshEdges edges_;
  std::vector<bool> whole_;  // edges that cannot be halved
};

}  // namespace

RefinedMesh refine_patch_mesh(const PatchMesh& mesh, std::span<const std::uint32_t> patches, std::uint32_t most) {
  const Refiner refiner(mesh);
  std::size_t fits = 0, too_many = patches.size() + 1;  // first ones of them: more make no fewer patches
  while (too_many - fits > 1) {
    const std::size_t middle = fits + (too_many - fits) / 2;
    (refiner.patches_with(refiner.halved_for(patches.first(middle))) <= most ? fits : too_many) = middle;
  }
  return refiner.make(refiner.halved_for(patches.first(fits)));
}

}  // namespace hemiray

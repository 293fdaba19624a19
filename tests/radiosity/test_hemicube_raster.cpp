// Rasterised hemicubes against ray-cast ones, cell by cell: the tree, its traversal and the triangle test of these have
// nothing in common with edge functions in an item buffer.
#include <catch2/catch.hpp>

#include <algorithm>
#include <numeric>

#include "host/base/error.hpp"
#include "tests/radiosity/radiosity_bench.hpp"

namespace hemiray {
namespace {

using test::RadiosityBench;

// Of cells, that may show another side: those whose middle lies within rounding of an edge, or of where two triangles
// pierce each other. Directions round by some 3e-7 of a face, cells are 1/32 of it: a cell that an edge goes through is
// in doubt once in 3e4, and there is about one such edge a cell.
constexpr double kCellsAtEdges = 1e-4;

std::vector<std::uint32_t> look(RadiosityBench& bench, const PatchMesh& mesh, HemicubeOptions options, CubeView view,
                                const std::vector<std::uint32_t>& sides) {
  options.view = view;
  Hemicubes hemicubes(bench.context, bench.parallel, bench.builder, mesh, options);
  return hemicubes.look_from(sides).read(0, sides.size() * hemicubes.cells());
}

// `count` sides from all over the mesh, fronts and backs.
std::vector<std::uint32_t> some_sides(const PatchMesh& mesh, std::uint32_t count) {
  std::vector<std::uint32_t> sides;
  for (std::uint32_t k = 0; k < count; k++) {
    sides.push_back(static_cast<std::uint32_t>(std::uint64_t{k} * mesh.side_count() / count + k % 2) %
                    mesh.side_count());
  }
  return sides;
}

FlatScene room_with_things() {
  FlatScene flat = test::flat_without_materials();
  const std::uint32_t grey = test::add_material(flat, Vec3(0.5F), Vec3(0.0F));
  test::add_room(flat, Vec3(3.0F, 2.0F, 2.5F), grey);
  test::add_quad(flat, Vec3(0.7F, 0.9F, 0.6F), Vec3(0.8F, 0.1F, 0), Vec3(0, 0.1F, 0.9F), grey);
  test::add_quad(flat, Vec3(1.9F, -0.2F, 0.5F), Vec3(0.1F, 0, 0.8F), Vec3(0, 1.3F, 0.1F), grey);  // through the floor
  test::add_sphere(flat, Vec3(2.0F, 1.2F, 1.7F), 0.4F);
  return flat;
}

struct Case {
  const char* name;
  PatchMesh mesh;
};

std::vector<Case> scenes() {
  std::vector<Case> all;
  all.push_back({"a room cut finely", make_patch_mesh(room_with_things(), {0.0, 2000, 0.0})});
  all.push_back({"a room of large triangles", make_patch_mesh(room_with_things(), {100.0, 0, 0.05})});
  // Triangles pierce each other and the planes of the sides that look.
  FlatScene soup = test::soup(700, 0, 0.6F, 11);
  soup.materials.clear();
  test::add_material(soup, Vec3(0.5F), Vec3(0.0F));
  all.push_back({"a soup of triangles", make_patch_mesh(soup, {100.0, 0, 0.0})});
  return all;
}

}  // namespace

TEST_CASE("rasterised hemicubes see what rays see, but for cells at edges") {
  RadiosityBench bench;
  for (const Case& scene : scenes()) {
    const std::vector<std::uint32_t> sides = some_sides(scene.mesh, 60);
    for (const auto& [resolution, divisions] : {std::pair{64U, 1U}, {50U, 2U}, {8U, 3U}}) {
      HemicubeOptions options;
      options.resolution = resolution;
      options.divisions = divisions;
      const std::vector<std::uint32_t> rays = look(bench, scene.mesh, options, CubeView::rays, sides),
                                       drawn = look(bench, scene.mesh, options, CubeView::raster, sides);
      REQUIRE(rays.size() == drawn.size());
      std::size_t differ = 0, patches = 0;
      for (std::size_t i = 0; i < rays.size(); i++) {
        differ += rays[i] != drawn[i];
        patches += drawn[i] != HR_NO_SIDE;
      }
      CAPTURE(scene.name, scene.mesh.patch_count(), resolution, differ, rays.size(), patches);
      CHECK(patches > rays.size() / 10);
      CHECK(static_cast<double>(differ) <= kCellsAtEdges * static_cast<double>(rays.size()));
    }
  }
}

TEST_CASE("tiny: hemicubes are drawn alike by vectors and by loops, in whatever order triangles come") {
  DeviceProfile loops = profile_for(choose_device(""));
  loops.explicit_vectors = 0;
  FlatScene flat = test::soup(40, 0, 1.0F, 3);
  flat.materials.clear();
  test::add_material(flat, Vec3(0.5F), Vec3(0.0F));
  const auto drawn = [](Context& context, const FlatScene& scene, std::uint32_t side) {
    const PatchMesh mesh = make_patch_mesh(scene, {100.0, 0, 0.0});
    HemicubeRaster raster(context, mesh, 12);
    const Buffer<std::uint32_t> rows(context, "rows", std::span<const std::uint32_t>(std::vector{side}));
    Buffer<std::uint32_t> seen(context, "seen", 3 * 12 * 12);
    shared::HemicubeParams cube{};
    cube.resolution = 12;
    cube.divisions = cube.row_count = 1;
    cube.side_count = mesh.side_count();
    raster.draw(rows, cube, seen);
    return seen.read();
  };
  Context context(choose_device("")), looping(choose_device(""), loops);
  const std::vector<std::uint32_t> seen = drawn(context, flat, 6);
  CHECK(std::count(seen.begin(), seen.end(), HR_NO_SIDE) < static_cast<std::ptrdiff_t>(seen.size()) / 2);
  CHECK(drawn(looping, flat, 6) == seen);
  std::reverse(flat.triangles.begin(), flat.triangles.end());
  std::vector<std::uint32_t> backwards = drawn(context, flat, 2 * (39 - 6 / 2));
  for (std::uint32_t& side : backwards) {
    if (side != HR_NO_SIDE) side = 2 * (39 - side / 2) + side % 2;
  }
  CHECK(backwards == seen);
}

TEST_CASE("no cell of a drawn hemicube is empty in a closed room, aligned with it or not") {
  RadiosityBench bench;
  FlatScene flat = test::flat_without_materials();
  test::add_room(flat, Vec3(1.0F, 2.0F, 1.5F), test::add_material(flat, Vec3(0.5F), Vec3(0.0F)));
  const PatchMesh mesh = make_patch_mesh(flat, {0.0, 1500, 0.0});
  std::vector<std::uint32_t> fronts;
  for (std::uint32_t i = 0; i < mesh.patch_count(); i += 7) fronts.push_back(2 * i);
  for (const bool turned : {false, true}) {
    HemicubeOptions options;
    options.turned = turned;  // aligned: edges and vertices go through the middles of cells
    const std::vector<std::uint32_t> seen = look(bench, mesh, options, CubeView::raster, fronts);
    CAPTURE(turned, seen.size());
    CHECK(std::count(seen.begin(), seen.end(), HR_NO_SIDE) == 0);
    CHECK(std::all_of(seen.begin(), seen.end(), [](std::uint32_t side) { return side % 2 == 0; }));
  }
}

TEST_CASE("of two patches in one place, the first is drawn") {
  RadiosityBench bench;
  FlatScene flat = test::flat_without_materials();
  const std::uint32_t grey = test::add_material(flat, Vec3(0.5F), Vec3(0.0F));
  test::add_quad(flat, Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0), grey);
  for (int copies = 0; copies < 20; copies++) {
    test::add_quad(flat, Vec3(-3, -3, 0.7F), Vec3(0, 7, 0), Vec3(7, 0, 0), grey);
  }
  const PatchMesh mesh = make_patch_mesh(flat, {100.0, 0, 0.0});
  std::size_t first = 0;
  for (const std::uint32_t side : look(bench, mesh, {}, CubeView::raster, {0})) {
    CHECK((side == HR_NO_SIDE || side == 4 || side == 6));
    first += side != HR_NO_SIDE;
  }
  CHECK(first > 4000);
}

}  // namespace hemiray

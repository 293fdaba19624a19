// OBJ and MTL reading: indices, polygons, groups, materials, and the places that errors name.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "host/base/error.hpp"
#include "host/scene/mtl_reader.hpp"
#include "host/scene/obj_reader.hpp"
#include "host/scene/triangulate.hpp"
#include "tests/support/image_files.hpp"
#include "tests/support/temp_folder.hpp"

using namespace hemiray;

namespace {

Scene read(const std::string& text, const std::map<std::string, std::string>& files = {}) {
  return read_obj(text, "m.obj", [&](const std::string& name) -> std::optional<std::vector<std::uint8_t>> {
    const auto found = files.find(name);
    if (found == files.end()) return std::nullopt;
    return std::vector<std::uint8_t>(found->second.begin(), found->second.end());
  });
}

double area(const std::vector<Vec3>& points, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  double sum = 0.0;
  for (const auto& t : triangles) {
    sum += 0.5 * glm::length(glm::cross(DVec3(points[t[1]] - points[t[0]]), DVec3(points[t[2]] - points[t[0]])));
  }
  return sum;
}

Material material_of(const std::string& statements) {
  Notes notes;
  const std::vector<MtlMaterial> all = read_mtl("newmtl m\n" + statements, "m.mtl", notes);
  REQUIRE(all.size() == 1);
  return to_material(all[0], notes);
}

bool has_note(const Scene& scene, const std::string& part) {
  return std::any_of(scene.notes.begin(), scene.notes.end(),
                     [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

}  // namespace

TEST_CASE("an OBJ quad becomes two triangles with flipped texture coordinates and unit normals") {
  const Scene scene = read(
      "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\n"
      "vt 0 0\nvt 1 0.25\nvn 0 0 4\n"
      "f 1/1/1 2/2/1 3/2/1 4/1/1\n");
  REQUIRE(scene.meshes.size() == 1);
  const Mesh& mesh = scene.meshes[0];
  REQUIRE(mesh.triangles.size() == 2);
  CHECK(mesh.triangles[0] == UVec3(0, 1, 2));
  CHECK(mesh.triangles[1] == UVec3(0, 2, 3));
  CHECK(mesh.rectangle);
  CHECK(mesh.uvs[0] == Vec2(0.0F, 1.0F));
  CHECK(mesh.uvs[1] == Vec2(1.0F, 0.75F));
  CHECK(mesh.normals[2] == Vec3(0.0F, 0.0F, 1.0F));
  CHECK(mesh.positions[2] == Vec3(2.0F, 1.0F, 0.0F));
}

TEST_CASE("OBJ corners are shared exactly where position, texture coordinate and normal agree") {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 1\n";
  CHECK(read(points + "f 1 2 3\nf 2 4 3\n").meshes[0].positions.size() == 4);
  CHECK(read(points + "f 1/1 2/1 3/1\nf 2/2 4/1 3/1\n").meshes[0].positions.size() == 5);
}

TEST_CASE("negative OBJ indices count back from the line they stand on") {
  const Scene scene = read("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 0 0\nf -4 -3 -1\n");
  const Mesh& mesh = scene.meshes[0];
  REQUIRE(mesh.triangles.size() == 1);  // the second one is collinear
  CHECK(scene.dropped_triangles == 1);
  CHECK(mesh.positions[0] == Vec3(0.0F));
  CHECK(mesh.positions[1] == Vec3(1.0F, 0.0F, 0.0F));
}

TEST_CASE("OBJ line ends, continuations and comments") {
  const Scene unix_lines = read("v 0 0 0 # origin\nv 1 0 0\nv 0 \\\n 1 0\n# f 9 9 9\nf 1 2\\\n 3 # done");
  CHECK(unix_lines.meshes[0].positions[2] == Vec3(0.0F, 1.0F, 0.0F));
  CHECK(read("v 0 0 0\r\nv 1 0 0\r\nv 0 \\\r\n1 0\r\nf 1 2 3\r\n").meshes[0].triangles.size() == 1);
  CHECK(read("v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r").meshes[0].triangles.size() == 1);
  CHECK(read("\xEF\xBB\xBFv 0 0 0\nv +1e0 .0 0.\nv 0 1 1e-999\nf 1 2 3").meshes[0].positions[1].x == 1.0F);
  // Only a # that starts a token is a comment: old compilers print infinity as 1.#INF.
  CHECK_THROWS_WITH(read("v 0 0 0\nv 1.#INF 0 0\n"), "m.obj:2:3: v: '1.#INF' is not a number");
}

TEST_CASE("each OBJ group with faces becomes one mesh, also when it is taken up again") {
  const Scene scene = read(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
      "g empty\ng left\nf 1 2 3\ng right\nf 1 2 3\no whole\ng left\nf 1 2 3\no\ng left\nf 3 2 1\n");
  REQUIRE(scene.meshes.size() == 3);
  REQUIRE(scene.objects.size() == 3);
  CHECK(scene.objects[0].name == "left");
  CHECK(scene.meshes[0].triangles.size() == 2);
  CHECK(scene.objects[1].name == "right");
  CHECK(scene.objects[2].name == "whole/left");
}

TEST_CASE("OBJ vertex colours are linear, clamped, and white where a vertex has none") {
  const Scene scene = read("v 0 0 0\nv 1 0 0 0.5 2 0\nv 0 1 0 1 1 1 0.3\nf 1 2 3\n");
  REQUIRE(scene.meshes[0].colors.size() == 3);
  CHECK(scene.meshes[0].colors[0] == Vec3(1.0F));
  CHECK(scene.meshes[0].colors[1] == Vec3(0.5F, 1.0F, 0.0F));
  CHECK(has_note(scene, "clamped"));
  CHECK(scene.materials[0].kd == Vec3(1.0F));
  CHECK(read("v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n").meshes[0].colors.empty());
}

TEST_CASE("concave polygons keep their area") {
  const auto check = [](const std::vector<Vec3>& points, double expected, std::size_t triangle_count) {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (std::size_t shift = 0; shift < points.size(); ++shift) {  // whatever corner comes first
      std::vector<Vec3> turned(points.begin() + static_cast<std::ptrdiff_t>(shift), points.end());
      turned.insert(turned.end(), points.begin(), points.begin() + static_cast<std::ptrdiff_t>(shift));
      for (const bool reversed : {false, true}) {
        if (reversed) std::reverse(turned.begin(), turned.end());
        triangles.clear();
        CHECK(triangulate(turned, triangles) == 0);
        CHECK(triangles.size() == triangle_count);
        CHECK(area(turned, triangles) == Approx(expected));
        DVec3 sum(0.0);  // all triangles face the same way, so signed and unsigned areas agree
        for (const auto& t : triangles) {
          sum += 0.5 * glm::cross(DVec3(turned[t[1]] - turned[t[0]]), DVec3(turned[t[2]] - turned[t[0]]));
        }
        CHECK(glm::length(sum) == Approx(expected));
      }
    }
  };
  check({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 0.5F, 0}, {0, 2, 0}}, 2.5, 3);                                 // a notch
  check({{0, 0, 0}, {0, 4, 0}, {0, 4, 4}, {0, 3, 4}, {0, 3, 1}, {0, 1, 1}, {0, 1, 4}, {0, 0, 4}}, 10.0, 6);  // a U
  check({{0, 0, 0}, {1, 0, 1}, {2, 0, 2}, {2, 2, 2}, {0, 2, 0}}, 4.0 * std::sqrt(2.0), 3);  // a straight corner
  // A square with a square hole, cut open along a bridge whose two sides coincide.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const std::vector<Vec3> ring = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0},
                                  {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}};
  CHECK(triangulate(ring, triangles) == 0);
  CHECK(area(ring, triangles) == Approx(12.0));
}

TEST_CASE("degenerate polygons give no triangles and end") {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  CHECK(triangulate(std::vector<Vec3>(5, Vec3(1.0F)), triangles) == 3);
  CHECK(triangulate(std::vector<Vec3>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}, triangles) == 2);
  CHECK(triangles.empty());
  CHECK(triangulate(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, triangles) == 1);
  CHECK(triangles.size() == 2);
  triangles.clear();
  const std::vector<Vec3> star = {{0, 1, 0}, {0.6F, -0.8F, 0}, {-0.95F, 0.3F, 0}, {0.95F, 0.3F, 0}, {-0.6F, -0.8F, 0}};
  triangulate(star, triangles);  // crosses itself: any answer, but one of valid corners
  for (const auto& t : triangles) CHECK(*std::max_element(t.begin(), t.end()) < star.size());
}

TEST_CASE("random star-shaped polygons keep their area") {
  std::uint32_t state = 20261122;
  const auto random = [&state] {  // a small generator whose numbers are the same everywhere
    state = state * 1664525U + 1013904223U;
    return static_cast<double>(state >> 8) / 16777216.0;
  };
  for (int round = 0; round < 200; ++round) {
    const int n = 4 + round % 60;
    std::vector<Vec3> points;
    for (int i = 0; i < n; ++i) {
      const double angle = 2.0 * 3.14159265358979 * i / n;
      const double r = 0.1 + random();
      points.emplace_back(r * std::cos(angle), 0.3 * r * std::cos(angle) + 5.0, r * std::sin(angle));
    }
    DVec3 newell(0.0);
    for (int i = 0; i < n; ++i) {
      newell += 0.5 * glm::cross(DVec3(points[static_cast<std::size_t>(i)]),
                                 DVec3(points[static_cast<std::size_t>((i + 1) % n)]));
    }
    std::vector<std::array<std::uint32_t, 3>> triangles;
    const std::size_t dropped = triangulate(points, triangles);
    CHECK(triangles.size() + dropped == static_cast<std::size_t>(n) - 2);
    CHECK(area(points, triangles) == Approx(glm::length(newell)).epsilon(1e-5));  // corners are rounded to float
  }
}

TEST_CASE("MTL illumination models map to surfaces as documented") {
  const std::string base = "Kd 0.5 0.4 0.3\nKs 0.25\nTf 0.25 0.25 0.25\nNi 1.4\nNs 80\n";
  const auto illum = [&](int model) { return material_of(base + "illum " + std::to_string(model) + "\n"); };
  const Vec3 ks(0.25F);
  const Vec3 zero(0.0F);
  CHECK(illum(0).ks == zero);
  CHECK(illum(1).ks == zero);
  CHECK(illum(2).ks == ks);
  CHECK(illum(2).kr == zero);
  CHECK(illum(2).shininess == 80.0F);
  for (const int model : {3, 5, 8}) {
    CHECK(illum(model).kr == ks);
    CHECK(illum(model).ks == zero);
    CHECK_FALSE(illum(model).fresnel);
    CHECK(illum(model).kt == zero);
  }
  for (const int model : {4, 6, 7, 9}) {
    CHECK(illum(model).kt == Vec3(0.5F));  // squared over the two interfaces it is Tf
    CHECK(illum(model).ior == 1.4F);
    CHECK(illum(model).kd == Vec3(0.5F, 0.4F, 0.3F));
    CHECK(illum(model).fresnel == (model == 7));
  }
  CHECK(illum(4).kr == ks);
  CHECK(illum(6).kr == ks);
  CHECK(illum(7).kr == Vec3(1.0F));
  CHECK(illum(9).kr == zero);
  CHECK(illum(9).ks == ks);
  CHECK(illum(10).ks == ks);
  CHECK(material_of("Kd 1 1 1\nKs 0.5\n").ks == Vec3(0.5F));  // without illum: 2 where Ks is given
  CHECK(material_of("Ks 0 0 0\nillum 7\n").kr == zero);
  const Material black = material_of("Ks 1\nTf 0 0 0\nNi 1.5\nillum 7\n");
  CHECK(black.kr.x == Approx(0.04F));
}

TEST_CASE("MTL dissolve is straight-through transparency") {
  const Material glass = material_of("Kd 0.8 0.8 0.8\nKs 0.5\nNi 1.5\nd 0.25\nillum 2\n");
  CHECK(glass.kt == Vec3(0.75F));
  CHECK(glass.ior == 1.0F);
  CHECK_FALSE(glass.fresnel);
  CHECK(glass.kd.x == Approx(0.2F));
  CHECK(glass.ks.x == Approx(0.125F));
  CHECK(material_of("Tr 0.75\n").kt == glass.kt);
  CHECK(material_of("d 1\nTr 0\n").kt == Vec3(0.0F));
  CHECK(material_of("d 0.36\nillum 6\n").kt.x == Approx(0.8F));  // 1 - d is what the body lets through
}

TEST_CASE("MTL colours, emission and oddities") {
  const Material material = material_of("Ka 0.1 0.2 0.3\nKd 0.5\nKe 10 20 30\n");
  CHECK(material.ka == Vec3(0.1F, 0.2F, 0.3F));
  CHECK(material.kd == Vec3(0.5F));
  CHECK(material.emission == Vec3(10.0F, 20.0F, 30.0F));
  CHECK_FALSE(material_of("Kd 1\n").ka.has_value());
  Notes notes;
  read_mtl("newmtl a b\nKd 2 0 0\nv 1 2 3\nv 1 2 3\n", "m.mtl", notes);
  CHECK(notes.lines() ==
        std::vector<std::string>{"m.mtl: Kd above 1 is taken as 1", "m.mtl: 'v' is not supported, ignored"});
}

TEST_CASE("OBJ materials and textures come from the libraries it names") {
  test::PngSpec png;
  png.width = 2;
  png.height = 1;
  png.color_type = 2;  // RGB
  png.rows = test::gradient_rgb(2, 1);
  const test::Bytes image = test::make_png(png);
  const std::string image_text(image.begin(), image.end());
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const Scene scene =
      read("mtllib sub/a.mtl b c.mtl\n" + triangle +
               "usemtl red paint\nf 1 2 3\nusemtl green\nf 1 2 3\nusemtl nothing\nf 1 2 3\nusemtl nothing\nf 1 2 3\n",
           {{"sub/a.mtl",
             "newmtl red paint # the red one\nmap_Kd -clamp on tex\\my image.png\nnewmtl unused\nmap_Kd gone.png\n"},
            {"c.mtl", "newmtl green\nKd 0 1 0\n"},
            {"sub/tex/my image.png", image_text}});
  REQUIRE(scene.materials.size() == 3);
  CHECK(scene.materials[0].name == "red paint");
  CHECK(scene.materials[0].kd == Vec3(1.0F));
  REQUIRE(scene.materials[0].kd_texture == 0);
  CHECK(scene.textures[0].width == 2);
  CHECK(scene.textures[0].wrap_u == Wrap::clamp);
  CHECK(scene.textures[0].color_space == ColorSpace::srgb);
  CHECK(scene.materials[1].kd == Vec3(0.0F, 1.0F, 0.0F));
  CHECK(scene.materials[2].name == "default");
  CHECK(scene.meshes[0].triangle_materials == std::vector<std::uint32_t>{0, 1, 2, 2});
  CHECK(scene.notes ==
        std::vector<std::string>{"m.obj:1:8: material library 'b' not found",
                                 "m.obj: material 'nothing' is not defined, the default material is used"});
}

TEST_CASE("an OBJ file and its library are read from disk") {
  const test::TempFolder folder;
  folder.write("a.mtl", "newmtl x\nKd 0.25 0 0\n");
  const auto file = folder.write("model.obj", "mtllib a.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Scene scene = load_obj(file);
  CHECK(scene.title == "model");
  CHECK(scene.materials.at(0).kd == Vec3(0.25F, 0.0F, 0.0F));
}

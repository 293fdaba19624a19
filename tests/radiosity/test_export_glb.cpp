// The glTF file of a solution, byte by byte: what the specification and viewers rely on.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "host/base/error.hpp"
#include "host/radiosity/export_glb.hpp"
#include "tests/radiosity/radiosity_bench.hpp"

namespace hemiray {
namespace {

using Columns = std::vector<std::array<double, 3>>;

std::uint32_t word(const std::string& file, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, file.data() + at, sizeof value);
  return value;
}

// A binary glTF file of two chunks, taken apart.
struct Glb {
  explicit Glb(const std::string& file) {
    REQUIRE(file.size() > 28);
    CHECK(file.substr(0, 4) == "glTF");
    CHECK(word(file, 4) == 2);
    CHECK(word(file, 8) == file.size());
    const std::size_t length = word(file, 12);
    CHECK(length % 4 == 0);
    CHECK(file.substr(16, 4) == "JSON");
    json = nlohmann::json::parse(file.substr(20, length));
    const std::size_t second = 20 + length;
    CHECK(word(file, second) == file.size() - second - 8);
    CHECK(file.substr(second + 4, 4) == std::string("BIN\0", 4));
    binary = file.substr(second + 8);
    CHECK(json["buffers"][0]["byteLength"] <= binary.size());
  }
  // Values of a vertex attribute, float vectors of three.
  [[nodiscard]] Columns attribute(const std::string& name) const {
    const auto& accessor = json["accessors"][json["meshes"][0]["primitives"][0]["attributes"][name].get<std::size_t>()];
    CHECK(accessor["componentType"] == 5126);
    CHECK(accessor["type"] == "VEC3");
    const auto& view = json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const auto count = accessor["count"].get<std::size_t>(), first = view["byteOffset"].get<std::size_t>();
    CHECK(first % 4 == 0);
    CHECK(view["byteLength"] == count * 12);
    REQUIRE(first + count * 12 <= binary.size());
    std::vector<float> floats(count * 3);
    std::memcpy(floats.data(), binary.data() + first, count * 12);
    Columns values(count);
    for (std::size_t i = 0; i < floats.size(); i++) values[i / 3][i % 3] = static_cast<double>(floats[i]);
    return values;
  }
  nlohmann::json json;
  std::string binary;
};

// A room of 12 patches and a lamp of 2 in it, 1 to 14 W/m^2 of red on the fronts and half of green.
struct LitRoom {
  LitRoom() {
    FlatScene flat = test::flat_without_materials();
    test::add_room(flat, Vec3(1.0F, 2.0F, 1.5F), test::add_material(flat, Vec3(0.5F, 0.25F, 0.1F), Vec3(0.0F)));
    test::add_quad(flat, Vec3(0.3F, 1.8F, 0.3F), Vec3(0.4F, 0, 0), Vec3(0, 0, 0.4F),
                   test::add_material(flat, Vec3(0.0F), Vec3(1000.0F)));
    mesh = make_patch_mesh(flat, {0.0, 14, 0.0});
    irradiance.assign(mesh.side_count(), {0.0, 0.0, 0.0});
    for (std::uint32_t i = 0; i < mesh.patch_count(); i++) irradiance[std::size_t{2} * i] = {i + 1.0, 0.5 * i + 0.5, 0};
  }
  PatchMesh mesh;
  Columns irradiance;
};

}  // namespace

TEST_CASE("the glTF file of a solution has what glTF asks for, and the radiosity of every corner") {
  const LitRoom room;
  REQUIRE(room.mesh.patch_count() == 14);
  GlbFacts facts;
  const Glb glb(solution_as_glb(room.mesh, room.irradiance, {false, 20.0}, 0.1, facts));
  CHECK(facts.exposure == 0.1);
  CHECK(glb.json["asset"]["version"] == "2.0");
  CHECK(glb.json["extensionsUsed"] == nlohmann::json::array({"KHR_materials_unlit"}));
  CHECK(glb.json["materials"][0]["extensions"].contains("KHR_materials_unlit"));
  CHECK(glb.json["meshes"][0]["primitives"][0]["material"] == 0);

  const Columns positions = glb.attribute("POSITION"), normals = glb.attribute("NORMAL"),
                colors = glb.attribute("COLOR_0"), radiosity = glb.attribute("_RADIOSITY");
  REQUIRE(positions.size() == 42);  // backs are dark
  REQUIRE(normals.size() == 42);
  REQUIRE(colors.size() == 42);
  REQUIRE(radiosity.size() == 42);
  const auto& bounds = glb.json["accessors"][0];
  int clamped = 0;
  for (std::size_t c = 0; c < 3; c++) {
    const auto by_axis = [c](const auto& a, const auto& b) { return a[c] < b[c]; };
    CHECK(bounds["min"][c] == (*std::ranges::min_element(positions, by_axis))[c]);
    CHECK(bounds["max"][c] == (*std::ranges::max_element(positions, by_axis))[c]);
    for (std::size_t i = 0; i < 42; i++) {
      const shared::float4& n = room.mesh.normals[i / 3];
      CHECK(normals[i][c] == static_cast<double>(c == 0 ? n.x : c == 1 ? n.y : n.z));
      const double rho = c == 0 ? 0.5 : c == 1 ? 0.25 : 0.1;
      const double expected = i / 3 < 12 ? rho * room.irradiance[i / 3 * 2][c] : 1000.0;
      CHECK(radiosity[i][c] == Approx(expected).epsilon(1e-6));
      CHECK(colors[i][c] == Approx(std::min(1.0, 0.1 * radiosity[i][c])).epsilon(1e-6));
      CHECK(colors[i][c] <= 1.0);
      clamped += 0.1 * radiosity[i][c] > 1.0 ? 1 : 0;
    }
  }
  CHECK(clamped == 18);
}

TEST_CASE("of what lies in the dark no glTF file is made") {
  LitRoom room;
  room.mesh.emission.assign(room.mesh.side_count(), {});
  room.irradiance.assign(room.mesh.side_count(), {0.0, 0.0, 0.0});
  GlbFacts facts;
  CHECK_THROWS_AS(solution_as_glb(room.mesh, room.irradiance, {}, 0.0, facts), InputError);
}

}  // namespace hemiray

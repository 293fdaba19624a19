// Transforms of the JSON scene format: order, direction of rotation, exactness, and what a sphere or plane may take.
#include <catch2/catch.hpp>

#include "host/base/error.hpp"
#include "host/scene/json_scene.hpp"
#include "host/scene/json_transform.hpp"

using namespace hemiray;

namespace {

constexpr double kRounding = 1e-14;  // a few double operations on numbers near 1

DMat4 transform(const std::string& text) {
  const nlohmann::json json = nlohmann::json::parse(text);
  const std::string file = "test.json";
  return read_transform(JsonNode(json, file));
}

bool maps(const DMat4& m, const DVec3& from, const DVec3& to, double tolerance = kRounding) {
  return glm::length(DVec3(m * glm::dvec4(from, 1.0)) - to) <= tolerance;
}

Scene parse_object(const std::string& object) {
  return parse_json_scene(R"({"hemiray": 1, "objects": [)" + object + "]}", "test.json", {});
}

}  // namespace

TEST_CASE("transforms: translate, scale, rotate") {
  CHECK(maps(transform(R"({"translate": [1, 2, 3]})"), {1, 1, 1}, {2, 3, 4}));
  CHECK(maps(transform(R"({"scale": 2})"), {1, 2, 3}, {2, 4, 6}));
  CHECK(maps(transform(R"({"scale": [2, -1, 0.5]})"), {1, 2, 4}, {2, -2, 2}));
  // Counter-clockwise when the axis points at the viewer: x to y about z, z to x about y, y to z about x.
  CHECK(maps(transform(R"({"rotate": {"axis": "z", "degrees": 90}})"), {1, 0, 0}, {0, 1, 0}, 0.0));
  CHECK(maps(transform(R"({"rotate": {"axis": "y", "degrees": 90}})"), {0, 0, 1}, {1, 0, 0}, 0.0));
  CHECK(maps(transform(R"({"rotate": {"axis": [5, 0, 0], "degrees": -270}})"), {0, 1, 0}, {0, 0, 1}, 0.0));
  CHECK(maps(transform(R"({"rotate": {"axis": [1, 1, 1], "degrees": 120}})"), {1, 0, 0}, {0, 1, 0}));
  CHECK(maps(transform(R"({"rotate": {"axis": "z", "degrees": 30}})"), {2, 0, 0}, {std::sqrt(3.0), 1, 0}));
}

TEST_CASE("transforms: within one object scale, then rotate, then translate") {
  const DMat4 m = transform(R"({"translate": [10, 0, 0], "scale": [2, 1, 1], "rotate": {"axis": "z", "degrees": 90}})");
  CHECK(maps(m, {1, 0, 0}, {10, 2, 0}));
}

TEST_CASE("transforms: in an array the first listed is applied first") {
  const DMat4 moved_first = transform(R"([{"translate": [1, 0, 0]}, {"rotate": {"axis": "z", "degrees": 90}}])");
  CHECK(maps(moved_first, {0, 0, 0}, {0, 1, 0}));
  const DMat4 turned_first = transform(R"([{"rotate": {"axis": "z", "degrees": 90}}, {"translate": [1, 0, 0]}])");
  CHECK(maps(turned_first, {0, 0, 0}, {1, 0, 0}));
  CHECK(maps(transform("[]"), {1, 2, 3}, {1, 2, 3}, 0.0));
}

TEST_CASE("transforms: a matrix is written row by row") {
  const DMat4 m = transform(R"({"matrix": [1, 2, 0, 10,  0, 1, 0, 20,  0, 0, 1, 30,  0, 0, 0, 1]})");
  CHECK(maps(m, {1, 1, 1}, {13, 21, 31}, 0.0));
}

TEST_CASE("transforms: similarities are told from other matrices") {
  const DMat4 similar = transform(R"([{"rotate": {"axis": [1, 2, 3], "degrees": 77}}, {"scale": 3}])");
  REQUIRE(similarity_scale(similar).has_value());
  CHECK(*similarity_scale(similar) == Approx(3.0));
  CHECK(similarity_scale(transform(R"({"scale": [-2, 2, 2]})")).has_value());  // a mirrored sphere is a sphere
  CHECK_FALSE(similarity_scale(transform(R"({"scale": [1, 1, 1.001]})")).has_value());
  CHECK_FALSE(similarity_scale(transform(R"({"matrix": [1,0.01,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]})")).has_value());
}

TEST_CASE("transforms: spheres and planes") {
  const Scene scene = parse_object(R"(
    {"type": "sphere", "center": [1, 0, 0], "radius": 0.5,
     "transform": [{"scale": 2}, {"rotate": {"axis": "y", "degrees": 90}}, {"translate": [0, 1, 0]}]},
    {"type": "plane", "point": [0, 1, 0], "normal": [0, 5, 0],
     "transform": [{"rotate": {"axis": "x", "degrees": 90}}, {"translate": [0, 0, 2]}]})");
  CHECK(glm::length(scene.spheres.at(0).center - DVec3(0, 1, -2)) < kRounding);
  CHECK(scene.spheres.at(0).radius == Approx(1.0));
  CHECK(glm::length(scene.planes.at(0).point - DVec3(0, 0, 3)) < kRounding);
  CHECK(glm::length(scene.planes.at(0).normal - DVec3(0, 0, 1)) < kRounding);

  CHECK_THROWS_WITH(
      parse_object(R"({"type": "sphere", "center": [0, 0, 0], "radius": 1, "transform": {"scale": [1, 2, 1]}})"),
      Catch::StartsWith("test.json: /objects/0/transform: a sphere must stay a sphere"));
  CHECK_THROWS_WITH(
      parse_object(R"({"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "transform": {"scale": 2}})"),
      Catch::StartsWith("test.json: /objects/0/transform: a plane can only be moved and turned"));
}

TEST_CASE("transforms: singular ones are refused") {
  CHECK_THROWS_AS(transform(R"({"scale": 0})"), InputError);
  CHECK_THROWS_AS(transform(R"({"scale": [1, 0, 1]})"), InputError);
  CHECK_THROWS_AS(transform(R"({"matrix": [1,2,3,0, 2,4,6,0, 0,0,1,0, 0,0,0,1]})"), InputError);
  CHECK_THROWS_AS(transform(R"({"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0.5,1]})"), InputError);
  CHECK_THROWS_AS(transform(R"([{"scale": 1e17}, {"scale": 1e17}])"), InputError);
  CHECK_NOTHROW(transform(R"({"scale": [1, 1, 1e-14]})"));  // thin, but not flat
}

// The JSON scene format: what each key means, its defaults, and that scene.schema.json knows the same keys.
#include <bit>
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "host/base/error.hpp"
#include "host/base/spelling.hpp"
#include "host/scene/features.hpp"
#include "host/scene/flat_scene.hpp"
#include "host/scene/json_keys.hpp"
#include "host/scene/json_scene.hpp"
#include "host/scene/load.hpp"
#include "host/scene/summary.hpp"
#include "tests/support/temp_folder.hpp"

using namespace hemiray;

namespace {

Scene parse(const std::string& members) {
  Scene scene = parse_json_scene("{\"hemiray\": 1" + (members.empty() ? "" : ", " + members) + "}", "test.json", {});
  validate_scene(scene);
  return scene;
}

Material parse_material(const std::string& members) {
  return parse(R"("materials": {"m": {)" + members + "}}").materials.at(0);
}

constexpr const char* kTriangleObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

}  // namespace

TEST_CASE("json scene: an empty scene has the documented defaults") {
  const Scene scene = parse("");
  CHECK(scene.title == "test");
  CHECK(scene.background == Vec3(0.0F));
  CHECK(scene.ambient == Vec3(0.0F));
  CHECK(scene.shading == Shading::physical);
  CHECK(scene.depth == 8);
  CHECK(scene.emitter_samples == 16);
  CHECK_FALSE(scene.has_camera);
  CHECK_FALSE(scene.has_lights);
  CHECK(scene.camera.width == 512);
  CHECK(scene.camera.fov_y_deg == 45.0);
}

TEST_CASE("json scene: top level settings") {
  const Scene scene = parse(R"("title": "T", "background": [0.1, 0.2, 0.3], "ambient": 0.5, "shading": "phong",
                               "depth": 3, "emitter_samples": 7.0, "lights": [])");
  CHECK(scene.title == "T");
  CHECK(scene.background == Vec3(0.1F, 0.2F, 0.3F));
  CHECK(scene.ambient == Vec3(0.5F));
  CHECK(scene.shading == Shading::phong);
  CHECK(scene.depth == 3);
  CHECK(scene.emitter_samples == 7);
  CHECK(scene.has_lights);  // present, though empty
}

TEST_CASE("json scene: the camera looks along its -z from position to look_at") {
  const Scene scene =
      parse(R"("camera": {"position": [1, 2, 3], "look_at": [4, 2, 3], "fov": 30, "size": [320, 200]})");
  REQUIRE(scene.has_camera);
  const DMat4& m = scene.camera.to_world;
  CHECK(m * glm::dvec4(0, 0, 0, 1) == glm::dvec4(1, 2, 3, 1));
  CHECK(glm::length(DVec3(m * glm::dvec4(0, 0, -1, 0)) - DVec3(1, 0, 0)) < 1e-15);
  CHECK(glm::length(DVec3(m * glm::dvec4(1, 0, 0, 0)) - DVec3(0, 0, 1)) < 1e-15);  // +z is on the right
  CHECK(glm::length(DVec3(m * glm::dvec4(0, 1, 0, 0)) - DVec3(0, 1, 0)) < 1e-15);
  CHECK(scene.camera.kind == CameraKind::perspective);
  CHECK(scene.camera.fov_y_deg == 30.0);
  CHECK(scene.camera.width == 320);
  CHECK(scene.camera.height == 200);

  const Scene flat =
      parse(R"("camera": {"position": [0, 5, 0], "look_at": [0, 0, 0], "up": [0, 0, -3], "orthographic_height": 4})");
  CHECK(flat.camera.kind == CameraKind::orthographic);
  CHECK(flat.camera.height_m == 4.0);
  CHECK(glm::length(DVec3(flat.camera.to_world[0]) - DVec3(1, 0, 0)) < 1e-15);

  const Scene unplaced = parse(R"("camera": {"size": [64, 32], "fov": 60})");
  CHECK_FALSE(unplaced.has_camera);
  CHECK(unplaced.camera.width == 64);
}

TEST_CASE("json scene: Phong materials and their defaults") {
  const Material all = parse_material(R"("kd": 0.3, "ka": [0.1, 0.2, 0.3], "ks": 0.2, "shininess": 12.5, "kr": 0.1,
                                         "kt": 0.2, "ior": 1.33, "fresnel": false, "emission": [5, 6, 7])");
  CHECK(all.name == "m");
  CHECK(all.kd == Vec3(0.3F));
  CHECK(all.ka.value() == Vec3(0.1F, 0.2F, 0.3F));
  CHECK(all.ks == Vec3(0.2F));
  CHECK(all.shininess == 12.5F);
  CHECK(all.kr == Vec3(0.1F));
  CHECK(all.kt == Vec3(0.2F));
  CHECK(all.ior == 1.33F);
  CHECK_FALSE(all.fresnel);
  CHECK(all.emission == Vec3(5, 6, 7));

  CHECK(parse_material("").kd == Vec3(0.5F));
  CHECK_FALSE(parse_material("").ka.has_value());
  CHECK(parse_material(R"("ks": 0.4)").kd == Vec3(0.5F));
  CHECK(parse_material(R"("kr": 0.9)").kd == Vec3(0.0F));
  CHECK(parse_material(R"("emission": 3)").kd == Vec3(0.0F));
  // Fresnel splits between kr and kt, so that glass needs only kt.
  CHECK(parse_material(R"("kt": 1)").kr == Vec3(1.0F));
  CHECK(parse_material(R"("kt": 1, "fresnel": false)").kr == Vec3(0.0F));
  CHECK(parse_material(R"("kt": 1, "kr": 0.2)").kr == Vec3(0.2F));
}

TEST_CASE("json scene: metallic-roughness materials") {
  const Material gold = parse_material(R"("base_color": [1, 0.8, 0.3], "metallic": 1, "roughness": 0.25)");
  CHECK(gold.metallic_roughness);
  CHECK(gold.kd == Vec3(1.0F, 0.8F, 0.3F));
  CHECK(gold.metallic == 1.0F);
  CHECK(gold.roughness == 0.25F);
  CHECK_FALSE(parse_material(R"("kd": 0.1)").metallic_roughness);
}

TEST_CASE("json scene: more light than arrives is noted in physical shading only") {
  const std::string bright = R"("materials": {"b": {"kd": 0.8, "ks": 0.3}})";
  REQUIRE(parse(bright).notes.size() == 1);
  CHECK(parse(bright).notes[0].find("\"b\"") != std::string::npos);
  CHECK(parse("\"shading\": \"phong\", " + bright).notes.empty());
  CHECK(parse(R"("materials": {"glass": {"kt": 1}})").notes.empty());
}

TEST_CASE("json scene: a quad faces cross(edge_u, edge_v) and is a rectangle") {
  const Scene scene = parse(R"("materials": {"a": {}, "b": {"kd": 0.1}}, "objects": [{"type": "quad", "name": "q",
      "corner": [1, 0, 0], "edge_u": [2, 0, 0], "edge_v": [0, 0, -3], "uv_scale": [4, 2], "material": "b"}])");
  const Mesh& mesh = scene.meshes.at(0);
  CHECK(scene.objects.at(0).name == "q");
  CHECK(mesh.rectangle);
  CHECK(mesh.positions == std::vector<Vec3>{{1, 0, 0}, {3, 0, 0}, {3, 0, -3}, {1, 0, -3}});
  CHECK(mesh.triangles == std::vector<UVec3>{{0, 1, 2}, {0, 2, 3}});
  const Vec3 normal = glm::cross(mesh.positions[1] - mesh.positions[0], mesh.positions[2] - mesh.positions[0]);
  CHECK(normal.y > 0.0F);
  CHECK(mesh.uvs == std::vector<Vec2>{{0, 2}, {4, 2}, {4, 0}, {0, 0}});  // an image stands upright
  CHECK(mesh.triangle_materials == std::vector<std::uint32_t>{1, 1});
}

TEST_CASE("json scene: four points are a rectangle only where they form a parallelogram") {
  const auto quad = [](const std::string& points) {
    return parse(R"("objects": [{"type": "quad", "vertices": )" + points + "}]").meshes.at(0);
  };
  CHECK(quad("[[0.343, 1, 0.227], [0.343, 1, 0.332], [0.213, 1, 0.332], [0.213, 1, 0.227]]").rectangle);
  CHECK_FALSE(quad("[[0.5528, 0, 0], [0, 0, 0], [0, 0, 0.5592], [0.5496, 0, 0.5592]]").rectangle);
  // Corner 1 is reflex: the diagonal from it to corner 3 is the one that stays inside.
  const Mesh dart = quad("[[0, 0, 0], [1, 0.5, 0], [2, 0, 0], [1, 3, 0]]");
  double area = 0.0;
  for (const UVec3& t : dart.triangles) {
    const Vec3 n = glm::cross(dart.positions[t.y] - dart.positions[t.x], dart.positions[t.z] - dart.positions[t.x]);
    CHECK(n.z > 0.0F);
    area += 0.5 * glm::length(n);
  }
  CHECK(area == Approx(2.5));  // shoelace formula
}

TEST_CASE("json scene: a box has twelve triangles that face outwards and close it") {
  const Scene scene = parse(R"("objects": [{"type": "box", "min": [-1, 0, 2], "max": [1, 3, 7]}])");
  const Mesh& mesh = scene.meshes.at(0);
  REQUIRE(mesh.triangles.size() == 12);
  const DVec3 center(0, 1.5, 4.5);
  double volume = 0.0;
  for (const UVec3& t : mesh.triangles) {
    const DVec3 a(mesh.positions[t.x]);
    const DVec3 b(mesh.positions[t.y]);
    const DVec3 c(mesh.positions[t.z]);
    CHECK(glm::dot(glm::cross(b - a, c - a), a - center) > 0.0);
    volume += glm::dot(a, glm::cross(b, c)) / 6.0;
  }
  CHECK(volume == Approx(2.0 * 3.0 * 5.0));
}

TEST_CASE("json scene: inline meshes, with triangles, polygons and dropped faces") {
  const Scene scene = parse(R"("objects": [{"type": "mesh",
      "vertices": [[0, 0, 0], [2, 0, 0], [2, 2, 0], [1, 0.5, 0], [0, 2, 0]],
      "normals": [[0, 0, 2], [0, 0, 1], [0, 0, 0], [0, 0, 1], [0, 0, 1]],
      "triangles": [[0, 1, 2], [0, 0, 1]], "polygons": [[0, 1, 2, 3, 4]]}])");
  const Mesh& mesh = scene.meshes.at(0);
  CHECK(scene.dropped_triangles == 1);
  REQUIRE(mesh.triangles.size() == 4);
  CHECK(mesh.normals[0] == Vec3(0, 0, 1));
  CHECK(mesh.normals[2] == Vec3(0, 0, 0));
  double area = 0.0;
  for (std::size_t i = 1; i < 4; ++i) {  // the concave polygon
    const UVec3& t = mesh.triangles[i];
    const Vec3 n = glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
    CHECK(n.z > 0.0F);
    area += 0.5 * glm::length(n);
  }
  CHECK(area == Approx(2.5));  // 4 minus the notch of 1.5
  CHECK(scene.materials.at(0).name == "default");
}

TEST_CASE("json scene: mesh files are merged, shared and overridden") {
  const test::TempFolder folder;
  folder.write("t.obj", kTriangleObj);
  folder.write("s.json", R"({"hemiray": 1, "materials": {"z": {"kd": 0.25}}, "objects": [
    {"type": "mesh", "name": "first", "file": "t.obj", "transform": {"translate": [5, 0, 0]}},
    {"type": "mesh", "file": "t.obj", "material": "z"},
    {"type": "quad", "corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0], "material": "z"}]})");
  const Scene scene = load_json_scene(folder / "s.json");
  validate_scene(scene);
  REQUIRE(scene.objects.size() == 3);
  CHECK(scene.meshes.size() == 2);  // the file was read once
  CHECK(scene.objects[0].mesh == scene.objects[1].mesh);
  CHECK(scene.objects[0].material == kNone);
  CHECK(scene.objects[0].name.starts_with("first"));
  CHECK(scene.objects[0].to_world[3] == glm::dvec4(5, 0, 0, 1));
  CHECK(scene.objects[1].material == 0);
  const std::uint32_t own = scene.meshes[scene.objects[0].mesh].triangle_materials.at(0);
  CHECK(own == 1);  // behind the scene file's own material
  CHECK(scene.materials.at(own).kd == Vec3(0.5F));
}

TEST_CASE("json scene: lights of all kinds") {
  const Scene scene = parse(R"("lights": [
      {"type": "point", "name": "p", "position": [1, 2, 3], "intensity": 4},
      {"type": "directional", "direction": [0, -2, 0], "irradiance": [1, 2, 3]},
      {"type": "spot", "position": [0, 1, 0], "direction": [3, 0, 4], "intensity": 5, "inner_angle": 10,
       "outer_angle": 20},
      {"type": "area", "corner": [0, 3, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0, 2], "radiance": 6,
       "samples": [4, 3], "jitter": false, "visible": false},
      {"type": "area", "corner": [0, 3, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0, 2], "radiance": 6, "samples": 2}])");
  REQUIRE(scene.lights.size() == 5);
  CHECK(scene.has_lights);
  CHECK(scene.lights[0].kind == LightKind::point);
  CHECK(scene.lights[0].name == "p");
  CHECK(scene.lights[0].position == DVec3(1, 2, 3));
  CHECK(scene.lights[0].intensity == Vec3(4.0F));
  CHECK(scene.lights[1].kind == LightKind::directional);
  CHECK(scene.lights[1].direction == DVec3(0, -1, 0));
  CHECK(scene.lights[1].intensity == Vec3(1, 2, 3));
  CHECK(scene.lights[2].kind == LightKind::spot);
  CHECK(glm::length(scene.lights[2].direction - DVec3(0.6, 0, 0.8)) < 1e-15);
  CHECK(scene.lights[2].inner_angle_deg == 10.0);
  CHECK(scene.lights[2].outer_angle_deg == 20.0);
  CHECK(scene.lights[3].kind == LightKind::area);
  CHECK(scene.lights[3].edge_v == DVec3(0, 0, 2));
  CHECK(scene.lights[3].samples_u == 4);
  CHECK(scene.lights[3].samples_v == 3);
  CHECK_FALSE(scene.lights[3].jitter);
  CHECK_FALSE(scene.lights[3].visible);
  CHECK(scene.lights[4].samples_u == 2);
  CHECK(scene.lights[4].samples_v == 2);
  CHECK(scene.lights[4].jitter);
  CHECK(scene.lights[4].visible);
}

TEST_CASE("json scene: implicit surfaces have their expression, constants, clip and place") {
  const Scene scene = parse(R"("objects": [
      {"type": "implicit", "name": "ball", "expression": "x^2 + y^2 + z^2 - r^2", "constants": {"r": 0.5},
       "clip": {"box": {"min": [-1, -1, -2], "max": [1, 1, 0]}}, "center": [1, 2, 3], "transform": {"scale": 2}},
      {"type": "implicit", "expression": "x*y*z - 1/8", "clip": {"sphere": {"radius": 2}}}])");
  REQUIRE(scene.shapes.size() == 2);
  const Shape& ball = scene.shapes[0];
  CHECK(ball.kind == ShapeKind::implicit);
  CHECK(ball.expression.degree == 2);
  CHECK(evaluate(ball.expression, {0.3, 0.4, 0}) == Approx(0).margin(1e-14));
  CHECK(ball.clip == Clip::box);
  CHECK(ball.clip_center == DVec3(0, 0, -1));
  CHECK(DVec3(ball.to_world * glm::dvec4(0.5, 0, 0, 1)) == DVec3(3, 4, 6));
  CHECK(scene.shapes[1].expression.degree == 3);
  CHECK(scene.shapes[1].clip == Clip::sphere);
  const FlatScene flat = flatten_scene(scene);
  REQUIRE(flat.shapes.size() == 2);
  CHECK(flat.tapes.size() == ball.expression.tape.size() + scene.shapes[1].expression.tape.size());
  CHECK(std::bit_cast<std::uint32_t>(flat.shapes[1].form.x) == ball.expression.tape.size());
  CHECK((features_of(scene, flat, 1) & HR_FEATURE_IMPLICITS) != 0);
  // The half of the ball that is in the clip, in the world: from 5 to 6.
  CHECK(flat.shapes[0].lo.z <= 5.0F);
  CHECK(flat.shapes[0].lo.z >= 4.95F);
  CHECK(flat.shapes[0].hi.z == Approx(6).epsilon(1e-4));
  const SceneSummary summary = summarize(scene);
  REQUIRE(summary.implicits.size() == 2);
  CHECK(summary.implicits[1].degree == 3);
  CHECK(summary_text(summary).find("ball: degree 2, ") != std::string::npos);
}

TEST_CASE("json scene: disks, cylinders and cones stand where their keys say") {
  const Scene scene = parse(R"("objects": [
      {"type": "disk", "center": [1, 2, 3], "normal": [0, 4, 0], "radius": 0.5},
      {"type": "cylinder", "from": [0, 0, 1], "to": [0, 6, 1], "radius": 2, "caps": false},
      {"type": "cone", "from": [0, 0, 0], "to": [3, 0, 4], "radius_from": 2, "transform": {"translate": [1, 0, 0]}}])");
  REQUIRE(scene.shapes.size() == 3);
  const auto at = [&](std::size_t i, const DVec3& p) { return DVec3(scene.shapes[i].to_world * glm::dvec4(p, 1.0)); };
  CHECK(scene.shapes[0].kind == ShapeKind::disk);
  CHECK(scene.shapes[0].radius == 0.5);
  CHECK(at(0, {0, 0, 1}) == DVec3(1, 3, 3));
  CHECK(scene.shapes[1].kind == ShapeKind::cylinder);
  CHECK_FALSE(scene.shapes[1].capped);
  CHECK(scene.shapes[1].upper_radius == 2.0);
  CHECK(at(1, {0, 0, -scene.shapes[1].half_height}) == DVec3(0, 0, 1));
  CHECK(at(1, {0, 0, scene.shapes[1].half_height}) == DVec3(0, 6, 1));
  CHECK(scene.shapes[2].kind == ShapeKind::cone);
  CHECK(scene.shapes[2].capped);
  CHECK(scene.shapes[2].radius == 2.0);
  CHECK(scene.shapes[2].upper_radius == 0.0);
  CHECK(glm::length(at(2, {0, 0, 2.5}) - DVec3(4, 0, 4)) < 1e-15);
}

TEST_CASE("json scene: a quadric's coefficients by name and in order, and its clip") {
  const Scene scene = parse(R"("objects": [
      {"type": "quadric", "coefficients": {"x2": 1, "y2": 2, "z2": 3, "xy": 0.1, "yz": 0.2, "zx": 0.3, "x": 4, "y": 5,
       "z": 6, "1": -7}, "center": [1, 0, 0], "clip": {"box": {"min": [-1, 0, 0], "max": [3, 2, 4]}}},
      {"type": "quadric", "coefficients": [1, 2, 3, 0.1, 0.2, 0.3, 4, 5, 6, -7]},
      {"type": "quadric", "coefficients": {"z": 1}, "clip": {"sphere": {"center": [0, 0, 0.5], "radius": 2}}}])");
  REQUIRE(scene.shapes.size() == 3);
  const Shape& boxed = scene.shapes[0];
  CHECK(boxed.coefficients == std::array<double, 10>{1, 2, 3, 0.1, 0.2, 0.3, 4, 5, 6, -7});
  CHECK(boxed.coefficients == scene.shapes[1].coefficients);
  CHECK(DVec3(boxed.to_world[3]) == DVec3(1, 0, 0));
  CHECK(boxed.clip == Clip::box);
  CHECK(boxed.clip_center == DVec3(1, 1, 2));
  CHECK(boxed.clip_half == DVec3(2, 1, 2));
  CHECK(scene.shapes[1].clip == Clip::none);
  CHECK(scene.shapes[2].clip == Clip::sphere);
  CHECK(scene.shapes[2].clip_center == DVec3(0, 0, 0.5));
  CHECK(scene.shapes[2].clip_radius == 2.0);
}

TEST_CASE("json scene: the schema knows exactly the loader's keys") {
  std::ifstream file(std::string(HR_SOURCE_DIR) + "/scenes/scene.schema.json");
  REQUIRE(file);
  const nlohmann::json definitions = nlohmann::json::parse(file).at("$defs");
  std::set<std::string> closed;
  for (const auto& [name, definition] : definitions.items()) {
    if (definition.contains("properties")) closed.insert(name);
  }
  for (const JsonKeyTable& table : json_key_tables()) {
    CAPTURE(table.type);
    const nlohmann::json& definition = definitions.at(std::string(table.type));
    CHECK(definition.at("additionalProperties") == false);
    std::set<std::string> schema_keys;
    for (const auto& [key, value] : definition.at("properties").items()) schema_keys.insert(key);
    std::set<std::string> loader_keys;
    std::set<std::string> required;
    for (const JsonKey& key : table.keys) {
      loader_keys.emplace(key.name);
      if (key.required) required.emplace(key.name);
    }
    CHECK(schema_keys == loader_keys);
    CHECK(definition.value("required", std::set<std::string>{}) == required);
    closed.erase(std::string(table.type));
  }
  CHECK(closed.empty());  // and no kind of object the loader does not know
}

TEST_CASE("json scene: the nearest spelling") {
  const std::vector<std::string_view> names{"position", "look_at", "up", "fov", "size"};
  CHECK(nearest_spelling("positon", names) == "position");
  CHECK(nearest_spelling("lookat", names) == "look_at");
  CHECK(nearest_spelling("ofv", names) == "fov");    // swapped neighbours
  CHECK(nearest_spelling("SIZE", names) == "size");  // another case
  CHECK(nearest_spelling("kd", names).empty());
  CHECK(nearest_spelling("", names).empty());
}

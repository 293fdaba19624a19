// Broken JSON scenes: each must end in one InputError that names the place and what to do.
#include <catch2/catch.hpp>

#include "host/base/error.hpp"
#include "host/scene/json_scene.hpp"
#include "host/scene/load.hpp"
#include "tests/support/temp_folder.hpp"

using namespace hemiray;

namespace {

struct BadScene {
  const char* text;      // the whole file, or members after "hemiray": 1 where it starts with a quote
  const char* place;     // what the message starts with, after "bad.json"
  const char* fragment;  // what it says
};

std::string error_of(const std::string& text) {
  try {
    static_cast<void>(parse_json_scene(text, "bad.json", {}));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

void check_all(std::initializer_list<BadScene> scenes) {
  for (const BadScene& scene : scenes) {
    const bool members = scene.text[0] == '"';
    const std::string text = members ? "{\"hemiray\": 1, " + std::string(scene.text) + "}" : scene.text;
    CAPTURE(text);
    const std::string message = error_of(text);
    CHECK_THAT(message, Catch::StartsWith(std::string("bad.json") + scene.place + ": "));
    CHECK_THAT(message, Catch::Contains(scene.fragment));
    CHECK(message.find('\n') == std::string::npos);
  }
}

}  // namespace

TEST_CASE("bad scenes: broken JSON is placed by line and column") {
  check_all({
      {"", ":1:1", "unexpected end of input"},
      {"{\"hemiray\": 1,\n \"depth\": }", ":2:11", "unexpected '}'"},
      {"{\"hemiray\": 1,\n \"depth\": NaN}", ":2:11", "invalid literal"},
      {"{\"hemiray\": 1,\n \"depth\": Infinity}", ":2:11", "invalid literal"},
      {"{\"hemiray\": 1,\n\n  \"ambient\": -1e999}", ":3:14", "number overflow"},
      {"{\"hemiray\": 1} x", ":1:16", "invalid literal"},
      {"{\"hemiray\": 1} {}", ":1:16", "unexpected '{'"},
      {"{\"hemiray\": 1, // comment\n}", ":1:16", "invalid literal"},
      {"{\"hemiray\": 1,}", ":1:15", "expected string literal"},
      {"{\"hemiray\": 01}", ":1:14", "unexpected number literal"},
      {"{\"title\": \"\xff\"}", ":1:12", "ill-formed UTF-8"},
      {"{\"title\": \"a\nb\"}", ":1:13", "control character"},
      {"{\"hemiray\": 1", ":1:14", "unexpected end of input"},
  });
  CHECK_THAT(error_of(std::string("{\"hemiray\": 1}\0[", 16)), Catch::StartsWith("bad.json:1:15: a NUL byte"));
  CHECK_THAT(error_of("{\"hemiray\": 1, \"objects\": " + std::string(64, '[') + std::string(64, ']') + "}"),
             Catch::StartsWith("bad.json:1:90: nested deeper than 64"));
  CHECK_THAT(error_of(std::string(1000000, '[')), Catch::Contains("nested deeper than 64"));
  // Brackets inside strings are text.
  CHECK(error_of("{\"hemiray\": 1, \"title\": \"\\\"" + std::string(100, '[') + "\"}") == "accepted");
}

TEST_CASE("bad scenes: the file as a whole") {
  check_all({
      {"[]", "", "expected a JSON object, found an array of 0"},
      {"{}", "", "\"hemiray\": 1"},
      {"{\"asset\": {\"version\": \"2.0\"}}", "", "not a hemiray scene"},
      {"{\"hemiray\": 2}", ": /hemiray", "version 1"},
      {"{\"hemiray\": \"1\"}", ": /hemiray", "version 1"},
      {"\"hemiray\": 1", "", "the key \"hemiray\" occurs twice"},
      {"\"materials\": {\"a\": {\"kd\": 1, \"kd\": 0}}", ": /materials/a", "the key \"kd\" occurs twice"},
      {"\"objects\": [{}, {\"type\": \"box\", \"type\": \"box\"}]", ": /objects/1", "occurs twice"},
      {"\"backgroud\": 0", "", "unknown key \"backgroud\"; did you mean \"background\"?"},
      {"\"zzz\": 0", "", "unknown key \"zzz\"; known: hemiray"},
      {"\"a\\nb\": 0", "", "unknown key"},
      {"\"depth\": 1.5", ": /depth", "expected a whole number, found 1.5"},
      {"\"depth\": -1", ": /depth", "from 0 to 64"},
      {"\"depth\": 99999999999999999999", ": /depth", "from 0 to 64"},
      {"\"depth\": \"8\"", ": /depth", "expected a number, found the string \"8\""},
      {"\"ambient\": -0.1", ": /ambient", "from 0"},
      {"\"ambient\": [1, 2]", ": /ambient", "expected an array of 3, found an array of 2"},
      {"\"background\": \"blue\"", ": /background", "expected a number or [r, g, b]"},
      {"\"background\": [0, null, 0]", ": /background/1", "expected a number, found null"},
      {"\"background\": 1e31", ": /background", "from 0 to 1e+30"},
      {"\"shading\": \"fong\"", ": /shading", "did you mean \"phong\"?"},
      {"\"title\": 7", ": /title", "expected a string, found 7"},
      {"\"objects\": {}", ": /objects", "expected an array, found an object"},
      {"\"materials\": []", ": /materials", "expected an object"},
  });
}

TEST_CASE("bad scenes: cameras") {
  check_all({
      {"\"camera\": []", ": /camera", "expected an object"},
      {"\"camera\": {\"positon\": [0, 0, 0]}", ": /camera", "did you mean \"position\"?"},
      {"\"camera\": {\"position\": [0, 0, 0]}", ": /camera", "missing key \"look_at\""},
      {"\"camera\": {\"position\": [0, 0], \"look_at\": [0, 0, 1]}", ": /camera/position", "array of 3"},
      {"\"camera\": {\"position\": [1, 2, 3], \"look_at\": [1, 2, 3]}", ": /camera/look_at", "own position"},
      {"\"camera\": {\"position\": [0, 5, 0], \"look_at\": [0, 0, 0]}", ": /camera", "give up"},
      {"\"camera\": {\"position\": [0, 0, 5], \"look_at\": [0, 0, 0], \"up\": [0, 0, 2]}", ": /camera/up", "parallel"},
      {"\"camera\": {\"position\": [0, 0, 5], \"look_at\": [0, 0, 0], \"up\": [0, 0, 0]}", ": /camera/up", "zero"},
      {"\"camera\": {\"up\": [0, 1, 0]}", ": /camera/up", "needs position"},
      {"\"camera\": {\"fov\": 0}", ": /camera/fov", "from 0.01 to 179"},
      {"\"camera\": {\"fov\": 30, \"orthographic_height\": 2}", ": /camera/orthographic_height", "either"},
      {"\"camera\": {\"orthographic_height\": 0}", ": /camera/orthographic_height", "greater than 0"},
      {"\"camera\": {\"size\": [0, 100]}", ": /camera/size/0", "from 1 to 65536"},
      {"\"camera\": {\"size\": [100, 1e9]}", ": /camera/size/1", "from 1 to 65536"},
      {"\"camera\": {\"size\": [65536, 65536]}", ": /camera/size", "pixels in all"},
      {"\"camera\": {\"size\": [10.5, 10]}", ": /camera/size/0", "whole number"},
  });
}

TEST_CASE("bad scenes: materials") {
  check_all({
      {"\"materials\": {\"a\": 1}", ": /materials/a", "expected an object"},
      {"\"materials\": {\"a/b\": {\"kd\": 2}}", ": /materials/a~1b/kd", "from 0 to 1"},
      {"\"materials\": {\"a\": {\"shinines\": 2}}", ": /materials/a", "did you mean \"shininess\"?"},
      {"\"materials\": {\"a\": {\"ior\": 0}}", ": /materials/a/ior", "greater than 0"},
      {"\"materials\": {\"a\": {\"ior\": 1e-60}}", ": /materials/a/ior", "at least 1.18e-38, found 1e-60"},
      {"\"materials\": {\"a\": {\"fresnel\": 1}}", ": /materials/a/fresnel", "true or false"},
      {"\"materials\": {\"a\": {\"emission\": -1}}", ": /materials/a/emission", "from 0"},
      {"\"materials\": {\"a\": {\"kd\": 1, \"metallic\": 1}}", ": /materials/a/kd", "does not go with"},
      {"\"materials\": {\"a\": {\"roughness\": 1.1}}", ": /materials/a/roughness", "from 0 to 1"},
      {"\"materials\": {\"a\": {\"normal_scale\": 1}}", ": /materials/a/normal_scale", "no normal_texture"},
      {"\"materials\": {\"a\": {\"kd_texture\": 1}}", ": /materials/a/kd_texture", "file name or an object"},
      {"\"materials\": {\"a\": {\"kd_texture\": {}}}", ": /materials/a/kd_texture", "missing key \"file\""},
      {"\"materials\": {\"a\": {\"kd_texture\": {\"file\": \"x\", \"wrap\": \"mirrored\"}}}",
       ": /materials/a/kd_texture/wrap", "did you mean \"mirror\"?"},
      {"\"materials\": {\"a\": {\"kd_texture\": \"x.png\"}}", ": /materials/a/kd_texture", "must not name other files"},
  });
}

TEST_CASE("bad scenes: disks, cylinders, cones and quadrics") {
  check_all({
      {R"("objects": [{"type": "disc"}])", ": /objects/0/type", "did you mean \"disk\"?"},
      {R"("objects": [{"type": "disk", "center": [0, 0, 0], "normal": [0, 0, 0], "radius": 1}])", ": /objects/0/normal",
       "must not be zero"},
      {R"("objects": [{"type": "disk", "center": [0, 0, 0], "normal": [0, 0, 1], "radius": 0}])", ": /objects/0/radius",
       "greater than 0"},
      {R"("objects": [{"type": "disk", "center": [0, 0, 0], "normal": [0, 0, 1], "radius": 1,
          "transform": {"scale": [1000, 1, 1]}}])",
       ": /objects/0/transform", "about 300 times"},
      {R"("objects": [{"type": "cylinder", "from": [0, 0, 0], "to": [0, 0, 0], "radius": 1}])", ": /objects/0/to",
       "another point"},
      {R"("objects": [{"type": "cylinder", "from": [0, 0, 0], "to": [0, 0, 1], "radius": 1, "cap": true}])",
       ": /objects/0", "did you mean \"caps\"?"},
      {R"("objects": [{"type": "cone", "from": [0, 0, 0], "to": [0, 0, 1], "radius_from": 0}])",
       ": /objects/0/radius_from", "above 0"},
      {R"("objects": [{"type": "cone", "from": [0, 0, 0], "to": [0, 0, 1], "radius_from": 1, "radius_to": -1}])",
       ": /objects/0/radius_to", "from 0"},
      {R"("objects": [{"type": "quadric", "coefficients": {"x2": 1, "y2": 1, "1": -1}}])", ": /objects/0",
       "must have a clip: the quadric is unbounded"},
      {R"("objects": [{"type": "quadric", "coefficients": {"x2": 1, "y2": 1, "z2": 1, "1": 1}}])", ": /objects/0",
       "no points"},
      {R"("objects": [{"type": "quadric", "coefficients": {"1": 1}, "clip": {"sphere": {"radius": 1}}}])",
       ": /objects/0", "no surface"},
      {R"("objects": [{"type": "quadric", "coefficients": {"x2": 1, "1": -9}, "clip": {"sphere": {"radius": 1}}}])",
       ": /objects/0", "no points there"},
      {R"("objects": [{"type": "implicit", "expression": "x^2 + ", "clip": {"sphere": {"radius": 1}}}])",
       ": /objects/0/expression", "column 7: expected a number, a name or an opening parenthesis, found the end"},
      {R"("objects": [{"type": "implicit", "expression": "x - q", "clip": {"sphere": {"radius": 1}}}])",
       ": /objects/0/expression", "column 5: \"q\" is neither x, y, z nor one of the constants"},
      {R"("objects": [{"type": "implicit", "expression": "x", "constants": {"y": 1}, "clip": {"sphere": {"radius": 1}}}])",
       ": /objects/0/constants", "\"y\" cannot name a constant"},
      {R"("objects": [{"type": "implicit", "expression": "x", "constants": {"a": "b"}, "clip": {"sphere": {"radius": 1}}}])",
       ": /objects/0/constants/a", "expected a number"},
      {R"("objects": [{"type": "implicit", "expression": "x^2 + y^2 - 1"}])", ": /objects/0", "missing key \"clip\""},
      {R"("objects": [{"type": "quadric", "coefficients": {"zz": 1}}])", ": /objects/0/coefficients",
       "unknown key \"zz\""},
      {R"("objects": [{"type": "quadric", "coefficients": [1, 2, 3]}])", ": /objects/0/coefficients", "array of 10"},
      {R"("objects": [{"type": "quadric", "coefficients": {"x": 1}, "clip": {}}])", ": /objects/0/clip",
       "either a box or a sphere"},
      {R"("objects": [{"type": "quadric", "coefficients": {"x": 1}, "clip": {"sphere": {"radius": 0}}}])",
       ": /objects/0/clip/sphere/radius", "greater than 0"},
      {R"("objects": [{"type": "quadric", "coefficients": {"x": 1},
          "clip": {"box": {"min": [0, 0, 0], "max": [1, 0, 1]}}}])",
       ": /objects/0/clip/box/max/1", "greater than min"},
      {R"("materials": {"lamp": {"emission": 1}}, "objects": [{"type": "cylinder", "from": [0, 0, 0], "to": [0, 0, 1],
          "radius": 1, "material": "lamp"}])",
       ": /objects/0/material", "a cylinder cannot emit"},
  });
}

TEST_CASE("bad scenes: objects") {
  check_all({
      {"\"objects\": [7]", ": /objects/0", "expected an object"},
      {"\"objects\": [{}]", ": /objects/0", "missing key \"type\""},
      {"\"objects\": [{\"typ\": \"box\"}]", ": /objects/0", "missing key \"type\" (found \"typ\")"},
      {"\"objects\": [{\"type\": \"spere\"}]", ": /objects/0/type", "did you mean \"sphere\"?"},
      {"\"objects\": [{\"type\": \"sphere\", \"center\": [0, 0, 0]}]", ": /objects/0", "missing key \"radius\""},
      {"\"objects\": [{\"type\": \"sphere\", \"centre\": [0, 0, 0], \"radius\": 1}]", ": /objects/0",
       "did you mean \"center\"?"},
      {"\"objects\": [{\"type\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 0}]", ": /objects/0/radius",
       "greater than 0"},
      {"\"objects\": [{\"type\": \"sphere\", \"center\": [0, 2e18, 0], \"radius\": 1}]", ": /objects/0/center/1",
       "from -1e+18 to 1e+18"},
      {"\"materials\": {\"chrome\": {}, \"glass\": {}}, \"objects\": [{\"type\": \"sphere\", \"center\": [0, 0, 0], "
       "\"radius\": 1, \"material\": \"glas\"}]",
       ": /objects/0/material", "unknown material \"glas\"; did you mean \"glass\"?"},
      {"\"objects\": [{\"type\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 1, \"material\": \"red\"}]",
       ": /objects/0/material", "unknown material \"red\""},
      {"\"materials\": {\"lamp\": {\"emission\": 1}}, \"objects\": [{\"type\": \"plane\", \"point\": [0, 0, 0], "
       "\"normal\": [0, 1, 0], \"material\": \"lamp\"}]",
       ": /objects/0/material", "cannot emit"},
      {"\"objects\": [{\"type\": \"plane\", \"point\": [0, 0, 0], \"normal\": [0, 0, 0]}]", ": /objects/0/normal",
       "must not be zero"},
      {"\"objects\": [{\"type\": \"box\", \"min\": [0, 0, 0], \"max\": [1, 0, 1]}]", ": /objects/0/max/1",
       "greater than min"},
      {"\"objects\": [{\"type\": \"quad\", \"corner\": [0, 0, 0], \"edge_u\": [1, 0, 0]}]", ": /objects/0",
       "missing key \"edge_v\""},
      {"\"objects\": [{\"type\": \"quad\", \"corner\": [0, 0, 0], \"edge_u\": [1, 0, 0], \"edge_v\": [-2, 0, 0]}]",
       ": /objects/0/edge_v", "span no area"},
      {"\"objects\": [{\"type\": \"quad\", \"vertices\": [[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]]}]",
       ": /objects/0/vertices", "sides cross"},
      {"\"objects\": [{\"type\": \"quad\", \"vertices\": [], \"corner\": [0, 0, 0]}]", ": /objects/0/corner", "either"},
      {"\"objects\": [{\"type\": \"mesh\"}]", ": /objects/0", "missing key \"file\""},
      {"\"objects\": [{\"type\": \"mesh\", \"vertices\": []}]", ": /objects/0", "missing key \"triangles\""},
      {"\"objects\": [{\"type\": \"mesh\", \"vertices\": [[0, 0, 0], [0, 0]], \"triangles\": []}]",
       ": /objects/0/vertices/1", "array of 3"},
      {"\"objects\": [{\"type\": \"mesh\", \"vertices\": [[0, 0, \"0\"]], \"triangles\": []}]",
       ": /objects/0/vertices/0/2", "expected a number"},
      {"\"objects\": [{\"type\": \"mesh\", \"vertices\": [[0, 0, 0]], \"triangles\": [[0, 0, 1]]}]",
       ": /objects/0/triangles/0/2", "vertex index 1 is out of range: there are 1"},
      {"\"objects\": [{\"type\": \"mesh\", \"vertices\": [[0, 0, 0]], \"triangles\": [[0, -1, 0]]}]",
       ": /objects/0/triangles/0/1", "out of range"},
      {"\"objects\": [{\"type\": \"mesh\", \"vertices\": [[0, 0, 0]], \"triangles\": [[0, 0.5, 0]]}]",
       ": /objects/0/triangles/0/1", "whole number"},
      {"\"objects\": [{\"type\": \"mesh\", \"vertices\": [[0, 0, 0]], \"polygons\": [[0, 0]]}]",
       ": /objects/0/polygons/0", "array of 3 to 4096"},
      {"\"objects\": [{\"type\": \"mesh\", \"vertices\": [[0, 0, 0]], \"triangles\": [], \"uvs\": []}]",
       ": /objects/0/uvs", "has 0 elements, but there are 1 vertices"},
      {"\"objects\": [{\"type\": \"mesh\", \"file\": \"a.obj\"}]", ": /objects/0/file", "must not name other files"},
  });
}

TEST_CASE("bad scenes: transforms") {
  const auto check = [](const char* transform, const char* place, const char* fragment) {
    const std::string text =
        R"({"hemiray": 1, "objects": [{"type": "box", "min": [0,0,0], "max": [1,1,1], "transform": )" +
        std::string(transform) + "}]}";
    CAPTURE(transform);
    CHECK_THAT(error_of(text), Catch::StartsWith(std::string("bad.json: /objects/0/transform") + place + ": "));
    CHECK_THAT(error_of(text), Catch::Contains(fragment));
  };
  check("1", "", "expected a transform");
  check("{}", "", "empty transform");
  check(R"({"rotation": 1})", "", "unknown key \"rotation\"; did you mean \"rotate\"?");
  check(R"({"rotate": 90})", "/rotate", "expected an object");
  check(R"({"rotate": {"axis": "w", "degrees": 1}})", "/rotate/axis", "known: x, y, z");
  check(R"({"rotate": {"axis": [0, 0, 0], "degrees": 1}})", "/rotate/axis", "must not be zero");
  check(R"({"rotate": {"axis": "x"}})", "/rotate", "missing key \"degrees\"");
  check(R"([{"scale": 1}, {"scale": [1, 0, 1]}])", "/1/scale", "flattens");
  check(R"({"matrix": [1]})", "/matrix", "array of 16");
  check(R"({"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,1,1]})", "/matrix/14", "last row");
  check(R"({"matrix": [1,0,0,0, 0,1,0,0, 0,0,0,0, 0,0,0,1]})", "", "singular");
  check(R"({"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "scale": 2})", "/matrix", "stands alone");
  check(R"([{"scale": 1e15}, {"translate": [1e10, 0, 0]}, {"scale": 1e15}])", "/2", "out of range");
}

TEST_CASE("bad scenes: lights") {
  check_all({
      {"\"lights\": [{\"type\": \"sun\"}]", ": /lights/0/type", "unknown value \"sun\""},
      {"\"lights\": [{\"type\": \"point\", \"position\": [0, 0, 0], \"intesity\": 1}]", ": /lights/0",
       "did you mean \"intensity\"?"},
      {"\"lights\": [{\"type\": \"directional\", \"direction\": [0, 0, 0], \"irradiance\": 1}]",
       ": /lights/0/direction", "must not be zero"},
      {"\"lights\": [{\"type\": \"spot\", \"position\": [0, 0, 0], \"direction\": [0, 1, 0], \"intensity\": 1, "
       "\"inner_angle\": 50}]",
       ": /lights/0/inner_angle", "must not exceed outer_angle"},
      {"\"lights\": [{\"type\": \"spot\", \"position\": [0, 0, 0], \"direction\": [0, 1, 0], \"intensity\": 1, "
       "\"outer_angle\": 91}]",
       ": /lights/0/outer_angle", "at most 90"},
      {"\"lights\": [{\"type\": \"area\", \"corner\": [0, 0, 0], \"edge_u\": [1, 0, 0], \"edge_v\": [2, 0, 0], "
       "\"radiance\": 1}]",
       ": /lights/0/edge_v", "no area"},
      {"\"lights\": [{\"type\": \"area\", \"corner\": [0, 0, 0], \"edge_u\": [1, 0, 0], \"edge_v\": [0, 1, 0], "
       "\"radiance\": 1, \"samples\": [4, 0]}]",
       ": /lights/0/samples/1", "from 1 to 1024"},
  });
}

TEST_CASE("bad scenes: files that are not there or not what they seem") {
  const test::TempFolder folder;
  const auto error = [&](const std::string& name, const std::string& text) -> std::string {
    const std::filesystem::path path = folder.write(name, text);
    try {
      static_cast<void>(load_scene(path));
    } catch (const InputError& input_error) {
      return input_error.what();
    }
    return "accepted";
  };
  const std::string json = (folder / "s.json").string();
  CHECK_THAT(error("s.json", R"({"hemiray": 1, "objects": [{"type": "mesh", "file": "none.obj"}]})"),
             Catch::StartsWith(json + ": /objects/0/file: no such file"));
  CHECK_THAT(error("s.json", R"({"hemiray": 1, "objects": [{"type": "mesh", "file": "s.json"}]})"),
             Catch::StartsWith(json + ": /objects/0/file: unknown kind of mesh file \".json\"; known: .obj"));
  folder.write("bad.obj", "v 0 0 0\nv 1 0 nan\n");
  CHECK_THAT(error("s.json", R"({"hemiray": 1, "objects": [{"type": "mesh", "file": "bad.obj"}]})"),
             Catch::StartsWith((folder / "bad.obj").string() + ":2:"));
  folder.write("bad.png", "not a picture");
  CHECK_THAT(error("s.json", R"({"hemiray": 1, "materials": {"a": {"kd_texture": "bad.png"}}})"),
             Catch::StartsWith((folder / "bad.png").string() + ": "));
  CHECK_THAT(error("s.json", R"({"hemiray": 1, "materials": {"a": {"kd_texture": "none.png"}}})"),
             Catch::StartsWith(json + ": /materials/a/kd_texture: no such file"));
  folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  CHECK_THAT(error("s.xml", "<scene/>"), Catch::Contains("known: .json, .gltf, .glb, .obj, .ply"));
  CHECK_THAT(error("noextension", "{}"), Catch::Contains("known: .json, .gltf, .glb, .obj, .ply"));
  CHECK_THROWS_AS(load_scene(folder / "missing.json"), InputError);
  CHECK_THROWS_AS(load_scene(folder.path()), InputError);
}

TEST_CASE("bad scenes: textures need texture coordinates") {
  // The first eight bytes decide the format; this is the smallest thing decode_image() takes: use a shipped texture.
  const std::string texture = std::string(HR_SOURCE_DIR) + "/scenes/textures/checker_grey.png";
  const test::TempFolder folder;
  folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto error = [&](const std::string& object) -> std::string {
    const std::string text =
        R"({"hemiray": 1, "materials": {"t": {"kd_texture": ")" + texture + R"("}}, "objects": [)" + object + "]}";
    try {
      static_cast<void>(parse_json_scene(text, "bad.json", folder.path()));
    } catch (const InputError& input_error) {
      return input_error.what();
    }
    return "accepted";
  };
  CHECK_THAT(error(R"({"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "t"})"),
             Catch::StartsWith("bad.json: /objects/0/material: a sphere has no texture coordinates"));
  CHECK_THAT(error(R"({"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "t"})"),
             Catch::StartsWith("bad.json: /objects/0/material: a plane has no texture coordinates"));
  CHECK_THAT(error(R"({"type": "mesh", "vertices": [[0, 0, 0]], "triangles": [], "material": "t"})"),
             Catch::StartsWith("bad.json: /objects/0: missing key \"uvs\""));
  CHECK_THAT(error(R"({"type": "mesh", "file": "t.obj", "material": "t"})"),
             Catch::StartsWith("bad.json: /objects/0/material: material \"t\" has a texture, but the file has no"));
  CHECK(error(R"({"type": "box", "min": [0, 0, 0], "max": [1, 1, 1], "material": "t"})") == "accepted");
}

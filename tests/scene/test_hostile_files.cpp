// Broken and hostile mesh files: each gives one InputError with the place at fault, never a crash, never a long wait.
#include <catch2/catch.hpp>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/base/error.hpp"
#include "host/base/read_file.hpp"
#include "host/scene/gltf_reader.hpp"
#include "host/scene/mtl_reader.hpp"
#include "host/scene/obj_reader.hpp"
#include "host/scene/ply_reader.hpp"
#include "host/scene/triangulate.hpp"
#include "tests/scene/binary_files.hpp"
#include "tests/support/temp_folder.hpp"

using namespace hemiray;
using hemiray::test::GltfBuilder;
using hemiray::test::triangle_gltf;
using nlohmann::json;

namespace {

struct BadText {
  std::string text;
  std::string start;  // of the message
  std::string part;   // in the message
};

std::optional<std::vector<std::uint8_t>> no_files(const std::string&) { return std::nullopt; }

std::vector<std::uint8_t> bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

void check_fails(const std::function<void()>& read, const std::string& start, const std::string& part) {
  try {
    read();
    FAIL_CHECK("accepted, expected: " << start << part);
  } catch (const InputError& error) {
    const std::string message = error.what();
    CHECK_THAT(message, Catch::StartsWith(start));
    CHECK_THAT(message, Catch::Contains(part));
    CHECK(message.find('\n') == std::string::npos);
    CHECK(message.size() < 400);
    CHECK(error.code() == ExitCode::input);
  }
}

void check_gltf(const GltfBuilder& builder, const std::string& start, const std::string& part) {
  check_fails([&] { read_gltf(builder.gltf(), "m.gltf", no_files); }, "m.gltf: " + start, part);
}

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

}  // namespace

TEST_CASE("bad OBJ files name line and column") {
  const std::vector<BadText> cases = {
      {"v 0 nan 0\n", "m.obj:1:5: ", "not finite"},
      {"v 0 0 inf\n", "m.obj:1:7: ", "not finite"},
      {"v abc 0 0\n", "m.obj:1:3: ", "'abc' is not a number"},
      {"v 0 0 1e999\n", "m.obj:1:7: ", "out of range"},
      {"v 0 0 1e39\n", "m.obj:1:7: ", "out of range"},  // a double, but no float
      {"v 0 0 0x10\n", "m.obj:1:7: ", "not a number"},
      {"v 0 0 1,5\n", "m.obj:1:7: ", "not a number"},
      {"v 0 0\n", "m.obj:1:6: ", "not 2 numbers"},
      {"v 1 2 3 4 5\n", "m.obj:1:", "not 5 numbers"},
      {"v 1 2 3 4 5 6 7 8\n", "m.obj:1:17: ", "unexpected '8'"},
      {"vt\n", "m.obj:1:3: ", "missing"},
      {"vn 0 1\n", "m.obj:1:7: ", "missing"},
      {kTriangle + "f 1 2 0\n", "m.obj:4:7: ", "index 0"},
      {kTriangle + "f 1 2 4\n", "m.obj:4:7: ", "vertex 4 does not exist; there are 3"},
      {kTriangle + "f 1 -4 2\n", "m.obj:4:5: ", "does not exist"},
      {kTriangle + "f 1 2 99999999999999999999\n", "m.obj:4:7: ", "does not exist"},
      {kTriangle + "f 1 2 3.0\n", "m.obj:4:7: ", "not an index"},
      {kTriangle + "f 1/1 2 3\n", "m.obj:4:5: ", "texture coordinate 1 does not exist"},
      {kTriangle + "f 1//1 2 3\n", "m.obj:4:6: ", "normal 1 does not exist"},
      {kTriangle + "f 1/ 2 3\n", "m.obj:4:5: ", "not an index"},
      {kTriangle + "f 1/1/1/1 2 3\n", "m.obj:4:", "f: "},
      {kTriangle + "f 1 2\n", "m.obj:4:", "at least 3 corners"},
      {kTriangle + "f 1 2 \\\n 7\n", "m.obj:5:2: ", "vertex 7"},
      {kTriangle + "usemtl\n", "m.obj:4:7: ", "name is missing"},
      {"mtllib # none\n", "m.obj:1:8: ", "name is missing"},
      {"v 0 0 \x01\x02\n", "m.obj:1:7: ", "\\x01\\x02"},
  };
  for (const BadText& bad : cases) {
    CAPTURE(bad.text);
    check_fails([&] { read_obj(bad.text, "m.obj", no_files); }, bad.start, bad.part);
  }
  std::string many = kTriangle + "f";
  for (std::size_t i = 0; i <= kMaxFaceCorners; ++i) many += " 1";
  check_fails([&] { read_obj(many, "m.obj", no_files); }, "m.obj:4:", "corners; split the face");
}

TEST_CASE("bad MTL files name line and column") {
  const std::vector<BadText> cases = {
      {"Kd 1 1 1\n", "m.mtl:1:1: ", "before the first newmtl"},
      {"newmtl\n", "m.mtl:1:7: ", "name is missing"},
      {"newmtl a\nKd 1 nan 1\n", "m.mtl:2:6: ", "not finite"},
      {"newmtl a\nKd 1 1\n", "m.mtl:2:7: ", "missing"},
      {"newmtl a\nKd 1 1 1 1\n", "m.mtl:2:10: ", "unexpected"},
      {"newmtl a\nKd spectral x.rfl\n", "m.mtl:2:4: ", "not a number"},
      {"newmtl a\nKd -1 0 0\n", "m.mtl:2:4: ", "negative"},
      {"newmtl a\nNs -1\n", "m.mtl:2:4: ", "between"},
      {"newmtl a\nNi 0\n", "m.mtl:2:4: ", "between"},
      {"newmtl a\nd 1.5\n", "m.mtl:2:3: ", "between 0 and 1"},
      {"newmtl a\nTr -0.5\n", "m.mtl:2:4: ", "between"},
      {"newmtl a\nillum 11\n", "m.mtl:2:7: ", "between 0 and 10"},
      {"newmtl a\nillum 2.5\n", "m.mtl:2:7: ", "not an integer"},
      {"newmtl a\nmap_Kd\n", "m.mtl:2:7: ", "file name is missing"},
      {"newmtl a\nmap_Kd -clamp on\n", "m.mtl:2:8: ", "file name is missing"},
      {"newmtl a\nmap_Kd -wat 1 a.png\n", "m.mtl:2:8: ", "unknown texture option '-wat'"},
  };
  for (const BadText& bad : cases) {
    CAPTURE(bad.text);
    Notes notes;
    check_fails([&] { read_mtl(bad.text, "m.mtl", notes); }, bad.start, bad.part);
  }
}

TEST_CASE("OBJ textures that are missing, absolute or broken are errors at their map line") {
  const auto with_map = [](const std::string& map) {
    return [map] {
      read_obj("mtllib a.mtl\nusemtl m\n" + kTriangle + "f 1 2 3\n", "m.obj", [&](const std::string& name) {
        using Answer = std::optional<std::vector<std::uint8_t>>;
        if (name == "a.mtl") return Answer(bytes_of("newmtl m\nmap_Kd " + map + "\n"));
        return name == "broken.png" ? Answer(bytes_of("\x89PNG\r\n\x1a\nrubbish")) : Answer();
      });
    };
  };
  check_fails(with_map("gone.png"), "a.mtl:2:8: ", "'gone.png' not found");
  check_fails(with_map("/etc/gone.png"), "a.mtl:2:8: ", "absolute path");
  check_fails(with_map("C:\\gone.png"), "a.mtl:2:8: ", "absolute path");
  check_fails(with_map("broken.png"), "a.mtl:2:8: ", "broken.png");
}

TEST_CASE("bad PLY files name line and column, or element and index") {
  const std::string ascii = "ply\nformat ascii 1.0\n";
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string three = "element vertex 3\n" + xyz;
  const std::string face = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string good = ascii + three + face + "0 0 0\n1 0 0\n0 1 0\n";
  const std::string binary = "ply\nformat binary_little_endian 1.0\n";
  using namespace std::string_literals;
  const std::vector<BadText> cases = {
      {"", "m.ply:1:1: ", "not a PLY file"},
      {"plyx\n", "m.ply:1:1: ", "not a PLY file"},
      {"ply\nend_header\n", "m.ply:2:1: ", "no format"},
      {"ply\nformat ascii 2.0\n", "m.ply:2:14: ", "version"},
      {"ply\nformat text 1.0\n", "m.ply:2:8: ", "unknown format"},
      {ascii + "element vertex -1\n", "m.ply:3:16: ", "not between"},
      {ascii + "element vertex 99999999999999999999\n", "m.ply:3:16: ", "not between"},
      {ascii + "element vertex 1 1\n", "m.ply:3:18: ", "unexpected"},
      {ascii + "property float x\n", "m.ply:3:1: ", "before the first element"},
      {ascii + "element vertex 1\nproperty quad x\n", "m.ply:4:10: ", "unknown type 'quad'"},
      {ascii + "element vertex 1\nproperty list float int x\n", "m.ply:4:15: ", "integer type"},
      {ascii + "element vertex 1\nproperty float x\nproperty float x\n", "m.ply:5:16: ", "twice"},
      {ascii + "element vertex 1\nelement vertex 1\n", "m.ply:4:9: ", "twice"},
      {ascii + "wat\n", "m.ply:3:1: ", "unknown header line"},
      {ascii + three, "m.ply:7:1: ", "ends within the header"},
      {ascii + "end_header\n", "m.ply:3:", "no element 'vertex'"},
      {ascii + "element vertex 0\nproperty float x\nend_header\n", "m.ply:3:9: ", "needs x, y and z"},
      {ascii + "element face 0\nproperty list uchar int vertex_indices\n" + three + "end_header\n",
       "m.ply:3:9: ", "behind element 'vertex'"},
      {ascii + three + "element face 1\nproperty uchar a\nend_header\n0 0 0\n1 0 0\n0 1 0\n", "m.ply:7:9: ", "needs"},
      {ascii + three + "element face 1\nproperty list uchar float vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n",
       "m.ply:7:9: ", "integer type"},
      {ascii + "element vertex 4000000000\n" + xyz + "end_header\n0 0 0\n", "m.ply:3:9: ", "truncated"},
      {ascii + three + face + "0 0 0\n1 0 0\n", "m.ply:", "vertex 2: the file ends here"},
      {ascii + three + face + "0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "m.ply:11:4: ", "vertex 1: the line ends early"},
      {ascii + three + face + "0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", "m.ply:11:5: ", "not finite"},
      {ascii + three + face + "0 0 0\n1 0 1e300\n0 1 0\n3 0 1 2\n", "m.ply:11:5: ", "vertex 1: a coordinate"},
      {ascii + three + face + "0 0 0\n1 0 abc\n0 1 0\n3 0 1 2\n", "m.ply:11:5: ", "'abc' is not a number"},
      {ascii + three + face + "0 0 0\n1 0 0 5\n0 1 0\n3 0 1 2\n", "m.ply:11:7: ", "vertex 1: unexpected '5'"},
      {good + "3 0 1 3\n", "m.ply:13:7: ", "face 0: vertex 3 does not exist"},
      {good + "3 0 1 -1\n", "m.ply:13:7: ", "face 0: vertex -1 does not exist"},
      {good + "3 0 1 1.5\n", "m.ply:13:7: ", "face 0: expected an integer"},
      {good + "300 0 1 2\n", "m.ply:13:1: ", "does not fit"},
      {good + "2 0 1\n", "m.ply:13:", "at least 3 corners"},
      {good + "255 0 1 2\n", "m.ply:13:1: ", "longer than the file"},
      {binary + three + face, "m.ply:3:9: ", "truncated"},
      {binary + three + face + std::string(36, '\0'), "m.ply:7:9: ", "truncated"},
      {binary + three + face + std::string(36, '\0') + "\3\0\0\0\0"s,
       "m.ply: ", "face 0: list 'vertex_indices' is longer"},
      {binary + three + face + std::string(36, '\0') + "\3\0\0\0\0\1\0\0\0\3\0\0\0"s, "m.ply: ", "face 0: vertex 3"},
      {binary + three + face + std::string(36, '\0') + "\3\0\0\0\0\1\0\0\0\xff\xff\xff\xff"s,
       "m.ply: ", "face 0: vertex -1"},
      {binary + "element vertex 1000000000000000000\n" + xyz + "end_header\n", "m.ply:3:9: ", "truncated"},
      {binary + "element x 1\nproperty list int double a\nend_header\n\xff\xff\xff\x7f"s,
       "m.ply: ", "x 0: list 'a' is longer"},
      {binary + "element x 1\nproperty list int double a\nend_header\n\xff\xff\xff\xff"s, "m.ply: ", "negative length"},
  };
  for (const BadText& bad : cases) {
    CAPTURE(bad.text);
    check_fails([&] { read_ply(bytes_of(bad.text), "m.ply"); }, bad.start, bad.part);
  }
}

TEST_CASE("bad glTF JSON is refused before it can do harm") {
  const auto text = [](const std::string& content, const std::string& start, const std::string& part) {
    check_fails([&] { read_gltf(bytes_of(content), "m.gltf", no_files); }, start, part);
  };
  text("", "m.gltf:", "");
  text("{", "m.gltf:1:", "");
  text("{\n\"asset\": nan}", "m.gltf:2:", "");
  text("[]", "m.gltf: ", "expected an object");
  text(std::string(100000, '['), "m.gltf:1:513: ", "deeper than 512");
  text("{\"a\":" + std::string(100000, '[') + std::string(100000, ']') + "}", "m.gltf:1:", "deeper than 512");
  text("{\"asset\":{\"version\":\"2.0\"},\"x\":1e999}", "m.gltf:1:", "");
  text("{}", "m.gltf: ", "asset");
  text("{\"asset\":{\"version\":2.0}}", "m.gltf: /asset/version: ", "expected a string");
  text("{\"asset\":{\"version\":\"1.0\"}}", "m.gltf: /asset/version: ", "2.0 is supported");
  text("{\"asset\":{\"version\":\"2.0\",\"minVersion\":\"2.1\"}}", "m.gltf: /asset/minVersion: ", "2.1");
  text("{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]}",
       "m.gltf: /extensionsRequired/0: ", "KHR_draco_mesh_compression");
  text("{\"asset\":{\"version\":\"2.0\"},\"nodes\":{}}", "m.gltf: /nodes: ", "expected an array");
  text("{\"asset\":{\"version\":\"2.0\"},\"nodes\":[3]}", "m.gltf: /nodes/0: ", "expected an object");
  text("{\"asset\":{\"version\":\"2.0\"},\"scene\":0}", "m.gltf: /scene: ", "does not exist");
}

TEST_CASE("bad glTF documents name the JSON path") {
  struct Bad {
    const char* pointer;  // what is changed in a good document
    json value;
    std::string start;
    std::string part;
  };
  const std::int64_t huge = std::int64_t{1} << 62;
  const std::string primitive = "/meshes/0/primitives/0";
  const std::vector<Bad> cases = {
      {"/bufferViews/0/byteOffset", huge, "/bufferViews/0/byteOffset: ", "must be from 0"},
      {"/bufferViews/0/byteOffset", std::int64_t{1} << 53, "/bufferViews/0: ", "outside the buffer"},
      {"/bufferViews/0/byteOffset", -1, "/bufferViews/0/byteOffset: ", "must be from 0"},
      {"/bufferViews/0/byteOffset", 1e300, "/bufferViews/0/byteOffset: ", "must be from 0"},
      {"/bufferViews/0/byteLength", 1000, "/bufferViews/0: ", "outside the buffer"},
      {"/bufferViews/0/byteLength", 0, "/bufferViews/0/byteLength: ", "must be from 1"},
      {"/bufferViews/0/byteLength", "9", "/bufferViews/0/byteLength: ", "expected a number"},
      {"/bufferViews/0/byteLength", 35, "/accessors/0: ", "outside the bufferView"},
      {"/bufferViews/0/byteStride", 8, "/accessors/0: ", "do not fit the byteStride"},
      {"/bufferViews/0/byteStride", 252, "/accessors/0: ", "outside the bufferView"},
      {"/bufferViews/0/byteStride", 256, "/bufferViews/0/byteStride: ", "must be from 4"},
      {"/bufferViews/0/buffer", 1, "/bufferViews/0/buffer: ", "buffers[1] does not exist"},
      {"/accessors/0/count", 4, "/accessors/0: ", "outside the bufferView"},
      {"/accessors/0/count", std::int64_t{1} << 53, "/accessors/0: ", "outside the bufferView"},
      {"/accessors/0/count", 0, "/accessors/0/count: ", "must be from 1"},
      {"/accessors/0/count", 2.5, "/accessors/0/count: ", "whole number"},
      {"/accessors/0/byteOffset", 4, "/accessors/0: ", "outside the bufferView"},
      {"/accessors/0/byteOffset", std::int64_t{1} << 53, "/accessors/0: ", "outside the bufferView"},
      {"/accessors/0/bufferView", 7, "/accessors/0/bufferView: ", "does not exist"},
      {"/accessors/0/componentType", 5124, "/accessors/0/componentType: ", "unknown component type"},
      {"/accessors/0/type", "MAT4", "/accessors/0/type: ", "unsupported type"},
      {"/accessors/0/type", "VEC2", primitive + "/attributes/POSITION: ", "VEC3"},
      {"/accessors/0/normalized", 1, "/accessors/0/normalized: ", "expected true or false"},
      {"/accessors/1/componentType", 5122, primitive + "/indices: ", "SCALAR accessor"},
      {"/accessors/1/count", 2, primitive + ": ", "whole triangles"},
      {"/meshes/0/primitives/0/indices", 9, primitive + "/indices: ", "does not exist"},
      {"/meshes/0/primitives/0/mode", 7, primitive + "/mode: ", "must be from 0"},
      {"/meshes/0/primitives/0/material", 0, primitive + "/material: ", "materials[0] does not exist"},
      {"/meshes/0/primitives/0/attributes/NORMAL", 1, primitive + "/attributes/NORMAL: ", "needs 3"},
      {"/meshes/0/primitives/0/attributes", json::array(), primitive + "/attributes: ", "expected an object"},
      {"/meshes/0/primitives", 3, "/meshes/0/primitives: ", "expected an array"},
      {"/nodes/0/mesh", 1, "/nodes/0/mesh: ", "does not exist"},
      {"/nodes/0/mesh", "0", "/nodes/0/mesh: ", "expected a number"},
      {"/nodes/0/children", {0}, "/nodes/0: ", "cycle"},
      {"/nodes/0/children", {4}, "/nodes/0/children/0: ", "does not exist"},
      {"/nodes/0/rotation", {0, 0, 0, 0}, "/nodes/0/rotation: ", "unit length"},
      {"/nodes/0/rotation", {0, 0, 1}, "/nodes/0/rotation: ", "an array of 4"},
      {"/nodes/0/matrix", {1, 2}, "/nodes/0/matrix: ", "an array of 16"},
      {"/nodes/0/matrix", {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "/nodes/0/matrix: ", "last row"},
      {"/nodes/0/scale", {1e300, 1e300, 1e300}, "/nodes/0: ", "out of range"},
      {"/nodes/0/camera", 0, "/nodes/0/camera: ", "does not exist"},
      {"/nodes/0/extensions",
       {{"KHR_lights_punctual", {{"light", 0}}}},
       "/nodes/0/extensions/KHR_lights_punctual/light: ",
       ""},
      {"/scenes/0/nodes", {0, 0}, "/scenes/0/nodes/1: ", "twice"},
      {"/scene", 3, "/scene: ", "does not exist"},
      {"/buffers", {{{"byteLength", 44}}}, "/buffers/0: ", "neither a uri"},
      {"/buffers", {{{"byteLength", 44}, {"uri", "gone.bin"}}}, "/buffers/0/uri: ", "'gone.bin' not found"},
      {"/buffers",
       {{{"byteLength", 44}, {"uri", "http://example.org/a.bin"}}},
       "/buffers/0/uri: ",
       "data: URIs and relative"},
      {"/buffers", {{{"byteLength", 44}, {"uri", "/etc/passwd"}}}, "/buffers/0/uri: ", "absolute path"},
      {"/buffers", {{{"byteLength", 44}, {"uri", "%2Fetc/passwd"}}}, "/buffers/0/uri: ", "absolute path"},
      {"/buffers", {{{"byteLength", 44}, {"uri", "C:\\a.bin"}}}, "/buffers/0/uri: ", "relative file names"},
      {"/buffers", {{{"byteLength", 44}, {"uri", "a%0.bin"}}}, "/buffers/0/uri: ", "%XX"},
      {"/buffers", {{{"byteLength", 44}, {"uri", "a%00"}}}, "/buffers/0/uri: ", "NUL"},
      {"/buffers", {{{"byteLength", 44}, {"uri", "data:;base64,AAAA"}}}, "/buffers/0/byteLength: ", "truncated"},
      {"/buffers", {{{"byteLength", 44}, {"uri", "data:;base64,A AA"}}}, "/buffers/0/uri: ", "not a base64 digit"},
      {"/buffers", {{{"byteLength", 44}, {"uri", "data:nothing"}}}, "/buffers/0/uri: ", "no comma"},
  };
  for (const Bad& bad : cases) {
    CAPTURE(bad.pointer, bad.value.dump());
    GltfBuilder builder = triangle_gltf();
    builder.json[json::json_pointer(bad.pointer)] = bad.value;
    check_gltf(builder, bad.start, bad.part);
  }
}

TEST_CASE("glTF indices, sparse accessors and accessors without data are bounded") {
  GltfBuilder index = triangle_gltf();
  index.binary[36 + 4] = 3;
  check_gltf(index, "/accessors/1: ", "element 2: vertex 3 does not exist; there are 3");

  GltfBuilder zero = triangle_gltf();
  zero.json["accessors"][0].erase("bufferView");
  zero.json["accessors"][0]["count"] = std::int64_t{1} << 40;
  check_gltf(zero, "/accessors/0: ", "without a bufferView");

  const auto sparse = [](std::vector<std::uint8_t> indices, const json& count) {
    GltfBuilder builder = triangle_gltf();
    builder.json["accessors"][0]["sparse"] = {
        {"count", count},
        {"indices", {{"bufferView", builder.view(indices)}, {"componentType", 5121}}},
        {"values", {{"bufferView", builder.view(std::vector<std::uint8_t>(24))}}}};
    return builder;
  };
  check_gltf(sparse({0, 3}, 2), "/accessors/0/sparse/indices: ", "element 3 does not exist");
  check_gltf(sparse({1, 1}, 2), "/accessors/0/sparse/indices: ", "strictly increase");
  check_gltf(sparse({0, 1}, 3), "/accessors/0/sparse/indices: ", "outside the bufferView");
  check_gltf(sparse({0, 1, 2}, 3), "/accessors/0/sparse/values: ", "outside the bufferView");
  check_gltf(sparse({0, 1}, std::int64_t{1} << 53), "/accessors/0/sparse/indices: ", "outside the bufferView");
}

TEST_CASE("glTF node cycles, shared children and deep hierarchies are refused") {
  GltfBuilder cycle = triangle_gltf();
  cycle.json["nodes"] = {{{"mesh", 0}}, {{"children", {2}}}, {{"children", {1}}}};
  check_gltf(cycle, "/nodes/", "cycle");
  GltfBuilder shared = triangle_gltf();
  shared.json["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
  check_gltf(shared, "/nodes/1/children/0: ", "already a child of node 0");
  GltfBuilder child = triangle_gltf();
  child.json["nodes"] = {{{"mesh", 0}}, {{"children", {0}}}};
  check_gltf(child, "/scenes/0/nodes/0: ", "not a root");
  GltfBuilder deep = triangle_gltf();
  deep.json["nodes"] = json::array();
  for (int i = 0; i < 256; ++i) deep.json["nodes"].push_back({{"children", {i + 1}}});
  deep.json["nodes"].push_back({{"mesh", 0}});
  check_gltf(deep, "/nodes/256: ", "deeper than 256");
}

TEST_CASE("broken glTF materials, cameras and lights name the JSON path") {
  const auto with_material = [](const json& material, const std::string& start, const std::string& part) {
    GltfBuilder builder = triangle_gltf();
    builder.json["materials"] = {material};
    builder.json["images"] = {{{"uri", "data:,rubbish"}}, json::object(), {{"uri", "gone.png"}}};
    builder.json["textures"] = {{{"source", 0}}, {{"source", 1}}, {{"source", 2}}, {{"source", 0}, {"sampler", 0}}};
    builder.json["samplers"] = {{{"wrapS", 1}}};
    builder.json["meshes"][0]["primitives"][0]["material"] = 0;
    check_gltf(builder, start, part);
  };
  const auto base_texture = [](const json& index) {
    return json{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", index}}}}}};
  };
  with_material(base_texture(0), "/images/0: ", "");
  with_material(base_texture(1), "/images/1: ", "neither a uri");
  with_material(base_texture(2), "/images/2/uri: ", "'gone.png' not found");
  with_material(base_texture(3), "/samplers/0/wrapS: ", "unknown wrap mode");
  with_material(base_texture(9), "/materials/0/pbrMetallicRoughness/baseColorTexture/index: ", "does not exist");
  with_material({{"pbrMetallicRoughness", {{"baseColorFactor", {2, 0, 0, 1}}}}},
                "/materials/0/pbrMetallicRoughness/baseColorFactor/0: ", "from 0 to 1");
  with_material({{"pbrMetallicRoughness", {{"roughnessFactor", -1}}}},
                "/materials/0/pbrMetallicRoughness/roughnessFactor: ", "");
  with_material({{"alphaMode", "WAT"}}, "/materials/0/alphaMode: ", "OPAQUE");
  with_material({{"extensions", {{"KHR_materials_ior", {{"ior", 0.5}}}}}},
                "/materials/0/extensions/KHR_materials_ior/ior: ", "");

  const auto with_camera = [](const json& camera, const std::string& start) {
    GltfBuilder builder = triangle_gltf();
    builder.json["cameras"] = {camera};
    builder.json["nodes"][0]["camera"] = 0;
    check_gltf(builder, start, "");
  };
  with_camera({{"type", "perspective"}, {"perspective", {{"yfov", 4}}}}, "/cameras/0/perspective/yfov: ");
  with_camera({{"type", "perspective"}, {"perspective", {{"yfov", 0}}}}, "/cameras/0/perspective/yfov: ");
  with_camera({{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", -1}}}},
              "/cameras/0/orthographic/ymag: ");
  with_camera({{"type", "fisheye"}}, "/cameras/0/type: ");

  const auto with_light = [](const json& light, const std::string& start) {
    GltfBuilder builder = triangle_gltf();
    builder.json["extensions"]["KHR_lights_punctual"]["lights"] = {light};
    builder.json["nodes"][0]["extensions"] = {{"KHR_lights_punctual", {{"light", 0}}}};
    check_gltf(builder, "/extensions/KHR_lights_punctual/lights/0" + start, "");
  };
  with_light({{"type", "laser"}}, "/type: ");
  with_light({{"type", "point"}, {"intensity", -1}}, "/intensity: ");
  with_light({{"type", "spot"}, {"spot", {{"innerConeAngle", 1}, {"outerConeAngle", 0.5}}}}, "/spot: ");
}

TEST_CASE("broken .glb containers name the byte") {
  const std::vector<std::uint8_t> good = triangle_gltf().glb();
  const auto check = [](const std::vector<std::uint8_t>& bytes, const std::string& part) {
    check_fails([&] { read_gltf(bytes, "m.glb", no_files); }, "m.glb: byte ", part);
  };
  const auto changed = [&](std::size_t offset, std::uint8_t value) {
    std::vector<std::uint8_t> bytes = good;
    bytes[offset] = value;
    return bytes;
  };
  for (const std::size_t length : {4UL, 12UL, 19UL})
    check({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length)}, "header");
  check({good.begin(), good.end() - 1}, "truncated");
  std::vector<std::uint8_t> longer = good;
  longer.push_back(0);
  check(longer, "the header says");
  check(changed(4, 1), "version 1");
  check(changed(15, 0xFF), "are left");
  check(changed(16, 'X'), "type JSON");
  const std::size_t binary_chunk = 20 + (good[12] | static_cast<std::size_t>(good[13]) << 8);
  check(changed(binary_chunk + 3, 0x7F), "are left");
  check(changed(binary_chunk, static_cast<std::uint8_t>(good[binary_chunk] - 4)), "chunk's header");
  // Every truncation, with the length in the header made to fit, is refused too.
  for (std::size_t length = 20; length < good.size(); ++length) {
    std::vector<std::uint8_t> cut(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length));
    cut[8] = static_cast<std::uint8_t>(length & 0xFF);
    cut[9] = static_cast<std::uint8_t>(length >> 8);
    CHECK_THROWS_AS(read_gltf(cut, "m.glb", no_files), InputError);
  }
}

TEST_CASE("missing files, folders and too long files are told apart") {
  const test::TempFolder folder;
  const std::string missing = (folder / "gone.obj").string();
  check_fails([&] { load_obj(missing); }, missing + ": ", "no such file");
  check_fails([&] { load_ply(missing); }, missing + ": ", "no such file");
  check_fails([&] { load_gltf(missing); }, missing + ": ", "no such file");
  check_fails([&] { load_obj(folder.path()); }, folder.path().string() + ": ", "directory");
  const auto file = folder.write("a.bin", "12345");
  CHECK(read_file(file, 5).size() == 5);
  check_fails([&] { read_file(file, 4); }, file.string() + ": ", "longer than the limit of 4 bytes");
}

// Broken and hostile glTF files: each gives one InputError with the place at fault, never a crash, never a long wait.
#include <catch2/catch.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "host/base/error.hpp"
#include "host/scene/gltf_reader.hpp"
#include "tests/scene/binary_files.hpp"
#include "tests/scene/check_fails.hpp"

using namespace hemiray;
using hemiray::test::bytes_of;
using hemiray::test::check_fails;
using hemiray::test::GltfBuilder;
using hemiray::test::no_files;
using hemiray::test::triangle_gltf;
using nlohmann::json;

namespace {

void check_gltf(const GltfBuilder& builder, const std::string& start, const std::string& part) {
  check_fails([&] { read_gltf(builder.gltf(), "m.gltf", no_files); }, "m.gltf: " + start, part);
}

}  // namespace

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

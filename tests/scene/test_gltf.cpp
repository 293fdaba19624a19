// glTF reading: containers, accessors, primitives, hierarchy, materials, cameras and lights.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/base/error.hpp"
#include "host/scene/data_uri.hpp"
#include "host/scene/flat_scene.hpp"
#include "host/scene/gltf_reader.hpp"
#include "tests/scene/binary_files.hpp"
#include "tests/support/image_files.hpp"
#include "tests/support/temp_folder.hpp"

using namespace hemiray;
using hemiray::test::GltfBuilder;
using hemiray::test::triangle_gltf;
using nlohmann::json;

namespace {

constexpr double kRounding = 1e-6;  // positions are stored in single precision

Scene read(const std::vector<std::uint8_t>& bytes) {
  return read_gltf(bytes, "m.gltf", [](const std::string&) { return std::nullopt; });
}

Scene read(const GltfBuilder& builder) { return read(builder.gltf()); }

bool has_note(const Scene& scene, const std::string& part) {
  return std::any_of(scene.notes.begin(), scene.notes.end(),
                     [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

Material material_of(const json& material) {
  GltfBuilder builder = triangle_gltf();
  builder.json["materials"] = {material};
  builder.json["meshes"][0]["primitives"][0]["material"] = 0;
  const Scene scene = read(builder);
  REQUIRE(scene.materials.size() == 1);
  return scene.materials[0];
}

std::vector<std::uint8_t> small_png() {
  test::PngSpec png;
  png.width = 2;
  png.height = 1;
  png.color_type = 2;  // RGB
  png.rows = test::gradient_rgb(2, 1);
  return test::make_png(png);
}

}  // namespace

TEST_CASE("a glTF triangle comes from text and container alike") {
  const GltfBuilder builder = triangle_gltf();
  for (const Scene& scene : {read(builder.gltf()), read(builder.glb())}) {
    REQUIRE(scene.objects.size() == 1);
    const Mesh& mesh = scene.meshes.at(0);
    CHECK(mesh.positions == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    CHECK(mesh.triangles == std::vector<UVec3>{{0, 1, 2}});
    CHECK(mesh.normals.empty());
    CHECK(mesh.uvs.empty());
    CHECK(mesh.colors.empty());
    const Material& material = scene.materials.at(0);  // glTF's default one
    CHECK(material.kd == Vec3(1.0F));
    CHECK(material.metallic == 1.0F);
    CHECK(material.roughness == 1.0F);
    CHECK_FALSE(scene.has_camera);
    CHECK_FALSE(scene.has_lights);
    CHECK(scene.notes.empty());
  }
}

TEST_CASE("glTF buffers are read from files beside the scene, with percent encoding") {
  const test::TempFolder folder;
  GltfBuilder builder = triangle_gltf();
  folder.write("my data.bin", std::string(builder.binary.begin(), builder.binary.end()));
  builder.json["buffers"] = {{{"byteLength", builder.binary.size()}, {"uri", "my%20data.bin"}}};
  const auto file = folder.write("scene.gltf", builder.json.dump());
  const Scene scene = load_gltf(file);
  CHECK(scene.meshes.at(0).triangles.size() == 1);
  CHECK(scene.title == "scene");
}

TEST_CASE("base64 of every length decodes") {
  const auto text = [](const std::string& encoded) {
    const std::vector<std::uint8_t> bytes = decode_base64(encoded, "here");
    return std::string(bytes.begin(), bytes.end());
  };
  CHECK(text("").empty());  // the vectors of RFC 4648
  CHECK(text("Zg==") == "f");
  CHECK(text("Zm8=") == "fo");
  CHECK(text("Zm9v") == "foo");
  CHECK(text("Zm9vYg") == "foob");
  CHECK(text("Zm9vYmFy") == "foobar");
  CHECK(decode_base64("+/8=", "here") == std::vector<std::uint8_t>{0xFB, 0xFF});
  CHECK_THROWS_WITH(decode_base64("Zm9-", "here"), Catch::StartsWith("here: "));
  CHECK_THROWS_WITH(decode_base64("Zm9vY", "here"), Catch::Contains("truncated"));
}

TEST_CASE("glTF strips and fans keep the winding") {
  GltfBuilder builder;
  const int positions = builder.floats3({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0});
  const int fan = builder.indices({0, 1, 3, 2});
  builder.add_primitive({{"attributes", {{"POSITION", positions}}}, {"mode", 5}});
  builder.add_primitive({{"attributes", {{"POSITION", positions}}}, {"mode", 6}, {"indices", fan}});
  const Scene scene = read(builder);
  const Mesh& mesh = scene.meshes.at(0);
  REQUIRE(mesh.triangles.size() == 5);
  CHECK(mesh.positions.size() == 5 + 4);  // each primitive brings the vertices it uses
  for (const UVec3& t : mesh.triangles) {
    CHECK(glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]).z > 0.0F);
  }
}

TEST_CASE("glTF primitives that share a large accessor take only their vertices from it") {
  GltfBuilder builder;
  std::vector<float> many;
  for (int i = 0; i < 300; ++i) many.insert(many.end(), {static_cast<float>(i), static_cast<float>(i % 7), 0.0F});
  const int positions = builder.floats3(many);
  for (std::uint16_t i = 0; i < 10; ++i) {
    const int indices = builder.indices({i, static_cast<std::uint16_t>(i + 1), static_cast<std::uint16_t>(i + 8)});
    builder.add_primitive({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  }
  const Scene scene = read(builder);
  CHECK(scene.meshes.at(0).triangles.size() + scene.dropped_triangles == 10);
  CHECK(scene.meshes.at(0).positions.size() <= 30);
}

TEST_CASE("glTF accessors: stride, offset, normalised integers, sparse values") {
  GltfBuilder builder;
  std::vector<std::uint8_t> interleaved(4, 0xEE);  // byteOffset skips these
  const std::vector<std::array<float, 3>> points = {{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}};
  for (const std::array<float, 3>& p : points) {
    for (const float v : p) test::append(interleaved, v);
    test::append(interleaved, std::int16_t{0});  // a normal as normalised shorts
    test::append(interleaved, std::int16_t{0});
    test::append(interleaved, std::int16_t{-32768});
    test::append(interleaved, std::uint16_t{0});
    for (const int c : {255, 51, 0, 9}) interleaved.push_back(static_cast<std::uint8_t>(c));
  }
  const int view = builder.view(interleaved);
  builder.json["bufferViews"][static_cast<std::size_t>(view)]["byteStride"] = 24;
  const auto add = [&](int offset, int component, const char* type, bool normalized) {
    builder.json["accessors"].push_back({{"bufferView", view},
                                         {"byteOffset", offset},
                                         {"componentType", component},
                                         {"count", 3},
                                         {"type", type},
                                         {"normalized", normalized}});
    return static_cast<int>(builder.json["accessors"].size()) - 1;
  };
  const int positions = add(4, 5126, "VEC3", false);
  const int normals = add(16, 5122, "VEC3", true);
  const int colors = add(24, 5121, "VEC4", true);
  const int uvs = builder.accessor(std::vector<std::uint16_t>{0, 65535, 13107, 0, 0, 0}, 5123, "VEC2", 2);
  builder.json["accessors"][static_cast<std::size_t>(uvs)]["normalized"] = true;
  std::vector<std::uint8_t> values;
  for (const float v : {3.0F, 0.0F, 0.0F}) test::append(values, v);
  builder.json["accessors"][static_cast<std::size_t>(positions)]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", builder.view({1})}, {"componentType", 5121}}},
      {"values", {{"bufferView", builder.view(values)}}}};
  builder.add_primitive(
      {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}, {"COLOR_0", colors}, {"TEXCOORD_0", uvs}}}});
  const Scene scene = read(builder);
  const Mesh& mesh = scene.meshes.at(0);
  CHECK(mesh.positions == std::vector<Vec3>{{0, 0, 0}, {3, 0, 0}, {0, 1, 0}});
  CHECK(mesh.normals == std::vector<Vec3>(3, Vec3(0.0F, 0.0F, -1.0F)));
  CHECK(mesh.colors[1] == Vec3(1.0F, 0.2F, 0.0F));
  CHECK(mesh.uvs == std::vector<Vec2>{{0.0F, 1.0F}, {0.2F, 0.0F}, {0.0F, 0.0F}});
}

TEST_CASE("glTF triangles that are degenerate or not finite are dropped and counted") {
  GltfBuilder builder;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const int positions = builder.floats3({0, 0, 0, 1, 0, 0, 0, 1, 0, nan, 0, 0});
  const int indices = builder.indices({0, 1, 2, 0, 1, 3, 1, 1, 2});
  builder.add_primitive({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  const Scene scene = read(builder);
  CHECK(scene.dropped_triangles == 2);
  CHECK(scene.meshes.at(0).positions.size() == 3);
}

TEST_CASE("glTF node transforms multiply from the root, and nodes share meshes") {
  GltfBuilder builder = triangle_gltf();
  const double half = std::sqrt(0.5);
  builder.json["nodes"] = {{{"translation", {10, 0, 0}}, {"scale", {2, 2, 2}}, {"children", {1, 2}}},
                           {{"mesh", 0}, {"rotation", {0, 0, half, half}}, {"name", "turned"}},
                           {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1}}}};
  const Scene scene = read(builder);
  REQUIRE(scene.objects.size() == 2);
  CHECK(scene.meshes.size() == 1);
  CHECK(scene.objects[0].name == "turned");
  const glm::dvec4 turned = scene.objects[0].to_world * glm::dvec4(1, 0, 0, 1);  // x becomes y, doubled, moved
  CHECK(turned.x == Approx(10.0).margin(kRounding));
  CHECK(turned.y == Approx(2.0).margin(kRounding));
  const glm::dvec4 moved = scene.objects[1].to_world * glm::dvec4(0, 0, 0, 1);
  CHECK(moved.z == Approx(10.0).margin(kRounding));
  const FlatScene flat = flatten_scene(scene, Instancing::always);
  CHECK(flat.instances.size() == 2);
  CHECK(flat.shared_meshes.size() == 1);
}

TEST_CASE("only the default glTF scene is shown, and without scenes all roots are") {
  GltfBuilder builder = triangle_gltf();
  builder.json["nodes"] = {{{"mesh", 0}, {"name", "a"}}, {{"mesh", 0}, {"name", "b"}}};
  builder.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}, {"name", "second"}}};
  builder.json["scene"] = 1;
  const Scene second = read(builder);
  REQUIRE(second.objects.size() == 1);
  CHECK(second.objects[0].name == "b");
  CHECK(second.title == "second");
  builder.json.erase("scenes");
  builder.json.erase("scene");
  const Scene all = read(builder);
  CHECK(all.objects.size() == 2);
  CHECK(has_note(all, "no scene"));
}

TEST_CASE("glTF cameras become rigid ones, the first wins") {
  GltfBuilder builder = triangle_gltf();
  builder.json["cameras"] = {
      {{"type", "perspective"},
       {"perspective", {{"yfov", std::numbers::pi / 3.0}, {"aspectRatio", 2.0}, {"znear", 0.1}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 1.0}, {"ymag", 2.0}, {"zfar", 9.0}, {"znear", 0.0}}}}};
  builder.json["nodes"].push_back(
      {{"camera", 0}, {"translation", {1, 2, 3}}, {"scale", {3, 4, 5}}, {"rotation", {0, 1, 0, 0}}});
  builder.json["nodes"].push_back({{"camera", 1}});
  builder.json["scenes"][0]["nodes"] = {0, 1, 2};
  Scene scene = read(builder);
  REQUIRE(scene.has_camera);
  CHECK(scene.camera.kind == CameraKind::perspective);
  CHECK(scene.camera.fov_y_deg == Approx(60.0));
  CHECK(scene.camera.width == 1024);
  CHECK(scene.camera.height == 512);
  CHECK(DVec3(scene.camera.to_world[3]) == DVec3(1, 2, 3));
  CHECK(glm::length(DVec3(scene.camera.to_world[2]) - DVec3(0, 0, -1)) < kRounding);  // half a turn around y
  CHECK(glm::length(DVec3(scene.camera.to_world[0]) - DVec3(-1, 0, 0)) < kRounding);
  CHECK(has_note(scene, "several cameras"));
  builder.json["scenes"][0]["nodes"] = {0, 2};
  scene = read(builder);
  CHECK(scene.camera.kind == CameraKind::orthographic);
  CHECK(scene.camera.height_m == 4.0);
  CHECK(scene.camera.width == 256);
}

TEST_CASE("glTF punctual lights") {
  GltfBuilder builder = triangle_gltf();
  builder.json["extensionsUsed"] = {"KHR_lights_punctual"};
  builder.json["extensionsRequired"] = {"KHR_lights_punctual"};
  builder.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 20}, {"range", 5}},
      {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", std::numbers::pi / 2}}}},
      {{"type", "directional"}, {"intensity", 3}}};
  const double half = std::sqrt(0.5);
  for (int i = 0; i < 3; ++i) {
    builder.json["nodes"].push_back({{"translation", {0, 7, 0}},
                                     {"rotation", {-half, 0, 0, half}},  // -z turns to -y
                                     {"scale", {2, 2, 2}},
                                     {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
  }
  builder.json["scenes"][0]["nodes"] = {0, 1, 2, 3};
  const Scene scene = read(builder);
  REQUIRE(scene.lights.size() == 3);
  CHECK(scene.has_lights);
  CHECK(scene.lights[0].kind == LightKind::point);
  CHECK(scene.lights[0].position == DVec3(0, 7, 0));
  CHECK(scene.lights[0].intensity == Vec3(20.0F, 10.0F, 0.0F));
  CHECK(scene.lights[1].kind == LightKind::spot);
  CHECK(scene.lights[1].outer_angle_deg == Approx(90.0));
  CHECK(scene.lights[1].inner_angle_deg == Approx(0.1 * 180.0 / std::numbers::pi));
  CHECK(scene.lights[2].kind == LightKind::directional);
  CHECK(scene.lights[2].intensity == Vec3(3.0F));
  CHECK(glm::length(scene.lights[2].direction - DVec3(0, -1, 0)) < kRounding);
  CHECK(has_note(scene, "range"));
}

TEST_CASE("glTF materials map to surfaces as documented") {
  const Material rough = material_of(
      {{"name", "rough"},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {0.5, 0.25, 1, 0.5}}, {"metallicFactor", 0.25}, {"roughnessFactor", 0.5}}},
       {"emissiveFactor", {1, 0.5, 0}},
       {"extensions",
        {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}, {"KHR_materials_ior", {{"ior", 1.25}}}}}});
  CHECK(rough.metallic_roughness);
  CHECK(rough.kd == Vec3(0.5F, 0.25F, 1.0F));
  CHECK(rough.metallic == 0.25F);
  CHECK(rough.roughness == 0.5F);
  CHECK(rough.emission == Vec3(8.0F, 4.0F, 0.0F));
  CHECK(rough.ior == 1.25F);
  CHECK(rough.kr == Vec3(0.0F));

  const Material mirror =
      material_of({{"pbrMetallicRoughness",
                    {{"baseColorFactor", {1, 0.5, 0, 1}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0}}}});
  CHECK_FALSE(mirror.metallic_roughness);  // the lobe is not counted beside the mirror
  CHECK(mirror.kr.x == Approx(0.52F));
  CHECK(mirror.kr.z == Approx(0.02F));
  CHECK(mirror.kd == Vec3(0.5F, 0.25F, 0.0F));
  CHECK(mirror.ks == Vec3(0.0F));

  const json transmission = {{"KHR_materials_transmission", {{"transmissionFactor", 0.75}}}};
  const Material glass = material_of(
      {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0.5, 0, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 0}}},
       {"extensions", transmission}});
  CHECK_FALSE(glass.metallic_roughness);
  CHECK(glass.kt == Vec3(0.75F, 0.375F, 0.0F));
  CHECK(glass.kd == Vec3(0.25F, 0.125F, 0.0F));
  CHECK(glass.kr == Vec3(1.0F));
  CHECK(glass.fresnel);
  const Material black =
      material_of({{"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 1}}, {"metallicFactor", 0}}},
                   {"extensions", transmission}});
  CHECK(black.kr.x == Approx(0.04F));
  const Material metal = material_of({{"extensions", transmission}});  // metallic is 1 by default
  CHECK(metal.metallic_roughness);
  CHECK(metal.kt == Vec3(0.0F));
}

TEST_CASE("glTF textures: colour space, sampler, sharing, texture coordinate set") {
  GltfBuilder builder;
  const int positions = builder.floats3({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int uv0 = builder.floats2({0, 0, 0, 0, 0, 0});
  const int uv1 = builder.floats2({0, 0, 1, 0, 0, 1});
  const int png = builder.view(small_png());
  builder.json["images"] = {{{"bufferView", png}, {"mimeType", "image/png"}, {"name", "pic"}},
                            {{"uri", "data:image/png;base64," + test::base64(small_png())}}};
  builder.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
  builder.json["textures"] = {{{"source", 0}, {"sampler", 0}}, {{"source", 1}}};
  builder.json["materials"] = {{{"pbrMetallicRoughness",
                                 {{"baseColorTexture", {{"index", 0}, {"texCoord", 1}}},
                                  {"metallicRoughnessTexture", {{"index", 1}, {"texCoord", 1}}}}},
                                {"normalTexture", {{"index", 1}, {"texCoord", 1}, {"scale", 0.5}}},
                                {"emissiveTexture", {{"index", 0}, {"texCoord", 1}}},
                                {"emissiveFactor", {1, 1, 1}},
                                {"occlusionTexture", {{"index", 1}}}}};
  builder.add_primitive(
      {{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uv0}, {"TEXCOORD_1", uv1}}}, {"material", 0}});
  for (const Scene& scene : {read(builder.gltf()), read(builder.glb())}) {
    REQUIRE(scene.textures.size() == 2);  // normals and roughness share one, colour and emission the other
    const Material& material = scene.materials.at(0);
    CHECK(material.kd_texture == 0);
    CHECK(material.emission_texture == 0);
    CHECK(material.metallic_roughness_texture == 1);
    CHECK(material.normal_texture == 1);
    CHECK(material.normal_scale == 0.5F);
    CHECK(scene.textures[0].name == "pic");
    CHECK(scene.textures[0].color_space == ColorSpace::srgb);
    CHECK(scene.textures[0].wrap_u == Wrap::clamp);
    CHECK(scene.textures[0].wrap_v == Wrap::mirror);
    CHECK(scene.textures[0].filter == Filter::nearest);
    CHECK(scene.textures[0].width == 2);
    CHECK(scene.textures[1].color_space == ColorSpace::linear);
    CHECK(scene.textures[1].filter == Filter::linear);
    CHECK(scene.meshes.at(0).uvs[1] == Vec2(1.0F, 0.0F));
    CHECK(has_note(scene, "occlusion"));
  }
}

TEST_CASE("unsupported glTF features are named, each once") {
  GltfBuilder builder = triangle_gltf();
  builder.json["extensionsUsed"] = {"KHR_texture_transform", "KHR_materials_ior"};
  builder.json["animations"] = {json::object()};
  builder.json["skins"] = {json::object()};
  builder.json["nodes"][0]["skin"] = 0;
  builder.json["materials"] = {{{"name", "leaf"}, {"alphaMode", "MASK"}}};
  builder.json["meshes"][0]["primitives"][0]["material"] = 0;
  builder.json["meshes"][0]["primitives"][0]["targets"] = json::array();
  builder.add_primitive({{"attributes", {{"POSITION", 0}}}, {"mode", 1}});
  builder.add_primitive({{"attributes", {{"POSITION", 0}}}, {"mode", 0}});
  const Scene scene = read(builder);
  CHECK(scene.notes.size() == 6);
  for (const char* part :
       {"KHR_texture_transform", "animations", "skins", "morph targets", "'leaf': alphaMode MASK", "points or lines"}) {
    CHECK(has_note(scene, part));
  }
}

TEST_CASE("glTF hierarchies of 256 levels load") {
  GltfBuilder builder = triangle_gltf();
  builder.json["nodes"] = json::array();
  for (int i = 0; i < 255; ++i) builder.json["nodes"].push_back({{"children", {i + 1}}, {"translation", {1, 0, 0}}});
  builder.json["nodes"].push_back({{"mesh", 0}});
  CHECK(read(builder).objects.at(0).to_world[3].x == 255.0);
}

// PLY reading: the three formats agree, properties in any order, polygons, colours, non-finite binary vertices.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "host/scene/ply_reader.hpp"
#include "tests/scene/binary_files.hpp"

using namespace hemiray;
using hemiray::test::append;

namespace {

Scene read(const std::vector<std::uint8_t>& bytes) { return read_ply(bytes, "m.ply"); }
Scene read(const std::string& text) { return read(std::vector<std::uint8_t>(text.begin(), text.end())); }

// A square with everything a PLY file can carry: properties out of order, foreign ones, lists among scalars, an element
// of no interest between vertices and faces.
const std::string kRichHeader =
    "comment made for a test\n"
    "obj_info nothing\n"
    "element vertex 4\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
    "property double x\nproperty float y\nproperty short z\n"
    "property list uchar ushort extra\n"
    "property float nx\nproperty float ny\nproperty float nz\n"
    "property float s\nproperty float t\n"
    "element material 2\nproperty list int double weights\nproperty char id\n"
    "element empty 7\n"
    "element face 1\n"
    "property uint flags\nproperty list ushort uint vertex_index\nproperty list uchar float texcoord\n"
    "end_header\n";

std::vector<std::uint8_t> rich_binary(bool big_endian) {
  const std::string header =
      std::string("ply\nformat binary_") + (big_endian ? "big" : "little") + "_endian 1.0\n" + kRichHeader;
  std::vector<std::uint8_t> b(header.begin(), header.end());
  for (int i = 0; i < 4; ++i) {
    for (const int c : {255, 128, 0, 7}) b.push_back(static_cast<std::uint8_t>(c));
    append(b, i == 1 || i == 2 ? 2.0 : 0.0, big_endian);
    append(b, i >= 2 ? 1.0F : 0.0F, big_endian);
    append(b, std::int16_t{-3}, big_endian);
    b.push_back(static_cast<std::uint8_t>(i));
    for (int k = 0; k < i; ++k) append(b, std::uint16_t{65535}, big_endian);
    for (const float n : {0.0F, 0.0F, 2.0F, 0.25F, 0.75F}) append(b, n, big_endian);
  }
  for (int i = 0; i < 2; ++i) {
    append(b, std::int32_t{1}, big_endian);
    append(b, 0.5, big_endian);
    b.push_back(0xFF);
  }
  append(b, std::uint32_t{9}, big_endian);
  append(b, std::uint16_t{4}, big_endian);
  for (std::uint32_t i = 0; i < 4; ++i) append(b, i, big_endian);
  b.push_back(1);
  append(b, 0.5F, big_endian);
  return b;
}

std::string rich_ascii() {
  return "ply\nformat ascii 1.0\n" + kRichHeader +
         "255 128 0 7 0 0 -3 0 0 0 2 0.25 0.75\n255 128 0 7 2 0 -3 1 65535 0 0 2 0.25 0.75\n\n"
         "255 128 0 7 2 1 -3 2 65535 65535 0 0 2 0.25 0.75\n255 128 0 7 0 1 -3 3 65535 65535 65535 0 0 2 0.25 0.75\n"
         "1 0.5 -1\n1 0.5 -1\n9 4 0 1 2 3 1 0.5\n";
}

std::vector<std::uint8_t> binary_triangles(const std::vector<float>& xyz, const std::vector<std::vector<int>>& faces) {
  const std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(xyz.size() / 3) +
                             "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                             std::to_string(faces.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  std::vector<std::uint8_t> b(header.begin(), header.end());
  for (const float v : xyz) append(b, v);
  for (const std::vector<int>& face : faces) {
    b.push_back(static_cast<std::uint8_t>(face.size()));
    for (const int index : face) append(b, static_cast<std::int32_t>(index));
  }
  return b;
}

}  // namespace

TEST_CASE("ascii, little and big endian PLY files give the same mesh") {
  for (const Scene& scene : {read(rich_ascii()), read(rich_binary(false)), read(rich_binary(true))}) {
    REQUIRE(scene.meshes.size() == 1);
    const Mesh& mesh = scene.meshes[0];
    CHECK(mesh.positions == std::vector<Vec3>{{0, 0, -3}, {2, 0, -3}, {2, 1, -3}, {0, 1, -3}});
    CHECK(mesh.normals == std::vector<Vec3>(4, Vec3(0.0F, 0.0F, 1.0F)));
    CHECK(mesh.uvs == std::vector<Vec2>(4, Vec2(0.25F, 0.25F)));
    CHECK(mesh.triangles == std::vector<UVec3>{{0, 1, 2}, {0, 2, 3}});
    CHECK(mesh.rectangle);
    REQUIRE(mesh.colors.size() == 4);
    CHECK(mesh.colors[3].x == 1.0F);
    CHECK(mesh.colors[3].y == Approx(0.2158605F));  // sRGB 128 by IEC 61966-2-1
    CHECK(mesh.colors[3].z == 0.0F);
    CHECK(scene.materials.at(0).kd == Vec3(1.0F));
    CHECK(scene.notes.size() == 6);  // alpha, extra, two elements, flags, texcoord
  }
}

TEST_CASE("float colours of a PLY file are linear") {
  const Scene scene =
      read(std::string("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                       "property float red\nproperty float green\nproperty float blue\n"
                       "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                       "0 0 0 .5 .5 .5\n1 0 0 .5 .5 .5\n0 1 0 .5 .5 2\n3 0 1 2\n"));
  CHECK(scene.meshes[0].colors[0] == Vec3(0.5F));
  CHECK(scene.meshes[0].colors[2] == Vec3(0.5F, 0.5F, 1.0F));
}

TEST_CASE("triangles of a binary PLY file with non-finite vertices are dropped and counted") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const Scene scene = read(binary_triangles({nan, 0, 0, 0, 0, 0, 1, 0, 0, 0, inf, 0, 0, 1, 0, 1, 2, 0},
                                            {{0, 1, 2}, {1, 2, 4}, {1, 2, 5, 3}, {2, 5, 4}, {1, 1, 2}}));
  CHECK(scene.dropped_triangles == 1 + 2 + 1);
  REQUIRE(scene.meshes.size() == 1);
  CHECK(scene.meshes[0].positions == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 2, 0}});
  CHECK(scene.meshes[0].triangles == std::vector<UVec3>{{0, 1, 2}, {1, 3, 2}});
}

TEST_CASE("concave PLY polygons are cut right") {
  const Scene scene = read(binary_triangles({0, 0, 0, 2, 0, 0, 2, 2, 0, 1, 0.5F, 0, 0, 2, 0}, {{2, 3, 4, 0, 1}}));
  double area = 0.0;
  const Mesh& mesh = scene.meshes[0];
  for (const UVec3& t : mesh.triangles) {
    area +=
        0.5 * static_cast<double>(
                  glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]).z);
  }
  CHECK(area == Approx(2.5));
}

TEST_CASE("a PLY file without faces or with empty elements is an empty scene") {
  CHECK(read(binary_triangles({0, 0, 0}, {})).objects.empty());
  CHECK(read(binary_triangles({}, {})).notes.size() == 1);
}

TEST_CASE("PLY headers with CR LF line ends keep the place of the binary data") {
  std::string text;
  for (const std::uint8_t byte : binary_triangles({0, 0, 0, 1, 0, 0, 0, 1, 0}, {{0, 1, 2}})) {
    text += static_cast<char>(byte);
  }
  const std::size_t end = text.find("end_header\n") + 11;
  std::string header;
  for (const char c : text.substr(0, end)) header += c == '\n' ? std::string("\r\n") : std::string(1, c);
  CHECK(read(header + text.substr(end)).meshes.at(0).triangles.size() == 1);
}

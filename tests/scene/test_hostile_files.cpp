// Broken and hostile mesh files: each gives one InputError with the place at fault, never a crash, never a long wait.
#include <catch2/catch.hpp>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "host/base/error.hpp"
#include "host/base/read_file.hpp"
#include "host/scene/gltf_reader.hpp"
#include "host/scene/mtl_reader.hpp"
#include "host/scene/obj_reader.hpp"
#include "host/scene/ply_reader.hpp"
#include "host/scene/triangulate.hpp"
#include "tests/scene/check_fails.hpp"
#include "tests/support/temp_folder.hpp"

using namespace hemiray;
using hemiray::test::bytes_of;
using hemiray::test::check_fails;
using hemiray::test::no_files;

namespace {

struct BadText {
  std::string text;
  std::string start;  // of the message
  std::string part;   // in the message
};

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
      {"v 0 0\n", "m.obj:1:5: ", "not 2 numbers"},
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
      {"mtllib # none\n", "m.obj:1:14: ", "name is missing"},
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
      {ascii + three + face + "0.00000000 0 0\n1 0 0\n", "m.ply:12:1: ", "vertex 2: the file ends here"},
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
  if (std::filesystem::exists("/dev/zero")) {  // tells no size and never ends
    check_fails([&] { read_file("/dev/zero", 1000); }, "/dev/zero: ", "longer than the limit");
  }
}

// Bad input as a user meets it: exit code 2, one line on stderr that names the place, stdout empty, nothing written.
// The loaders' own tests (scene/) hold every broken file; this table holds one of each kind, through the program.
#include <catch2/catch.hpp>

#include "tests/app/small_scenes.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/temp_folder.hpp"

using namespace hemiray::test;
using Words = std::vector<std::string>;

namespace {

struct BadFile {
  std::string name;
  std::string content;
  std::string place;  ///< what stands right after the file's name
  std::string says;
};

std::string scene_with(const std::string& members) { return "{\"hemiray\": 1,\n" + members + "}"; }

/// The first `bytes` of the smallest valid .glb, whose header promises all of them.
std::string truncated_glb(std::size_t bytes) {
  std::string json = R"({"asset":{"version":"2.0"},"scenes":[{}]})";
  while (json.size() % 4 != 0) json += ' ';
  const auto word = [](std::size_t value) {
    std::string text;
    for (unsigned shift = 0; shift < 32; shift += 8) text += static_cast<char>(value >> shift & 0xFFU);
    return text;
  };
  const std::string all = "glTF" + word(2) + word(20 + json.size()) + word(json.size()) + "JSON" + json;
  return all.substr(0, bytes);
}

/// Runs the program in `folder`'s presence and checks everything that holds for every error.
void check_refused(const TempFolder& folder, const Words& arguments, int exit_code, const Words& parts,
                   const std::map<std::string, std::string>& environment = {}) {
  const std::set<std::string> before = listing(folder.path());
  const ProgramResult result = run_program(arguments, environment);
  std::string line;
  for (const std::string& word : arguments) line += " " + word;
  INFO("hemiray" << line << "\nstdout: " << result.out << "\nstderr: " << result.err);
  CHECK(result.exit_code == exit_code);
  CHECK(result.out.empty());
  CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
  CHECK_THAT(result.err, Catch::StartsWith("hemiray: ") && Catch::EndsWith("\n"));
  CHECK(result.err.size() < 600);
  CHECK(result.err.find("internal error") == std::string::npos);
  for (const std::string& part : parts) CHECK_THAT(result.err, Catch::Contains(part));
  CHECK(listing(folder.path()) == before);
}

}  // namespace

TEST_CASE("bad input: scene files") {
  const std::string obj_with_uv = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n";
  const std::vector<BadFile> files{
      {"missing.json", "", ": ", "no such file"},
      {"empty.json", "", ":1:1: ", "unexpected end of input"},
      {"broken.json", scene_with("\"depth\": }"), ":2:10: ", "unexpected '}'"},
      {"name.json", scene_with("\"depht\": 3"), ": unknown key \"depht\"", "did you mean \"depth\"?"},
      {"inner_name.json", scene_with("\"camera\": {\"fow\": 3}"), ": /camera: unknown key \"fow\"",
       "did you mean \"fov\"?"},
      {"type.json", scene_with("\"depth\": \"three\""), ": /depth: ", "\"three\""},
      {"kind.json", scene_with("\"objects\": [{\"type\": \"spere\"}]"), ": /objects/0/type: ", "\"sphere\""},
      {"material.json",
       scene_with("\"materials\": {\"glass\": {}}, \"objects\": [{\"type\": \"sphere\", \"center\": [0, 0, 0], "
                  "\"radius\": 1, \"material\": \"glas\"}]"),
       ": /objects/0/material: ", "\"glass\""},
      {"nan.json", scene_with("\"ambient\": NaN"), ":2:12: ", "invalid literal"},
      {"infinite.json", scene_with("\"ambient\": 1e999"), ":2:", "overflow"},
      {"index.json",
       scene_with("\"objects\": [{\"type\": \"mesh\", \"vertices\": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "
                  "\"triangles\": [[0, 1, 3]]}]"),
       ": /objects/0/triangles/0", "3"},
      {"index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", ":4:7: ", "4"},
      {"nan.obj", "v 0 0 nan\n", ":1:7: ", "nan"},
      {"unknown.xyz", "v 0 0 0\n", ": ", ".xyz"},
      {"cut.ply", "ply\nformat ascii 1.0\nelement vertex 3\n", ":", "end"},
      {"header.glb", truncated_glb(10), ": ", "byte"},
      {"cut.glb", truncated_glb(40), ": ", "byte"},
      {"index.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[7]}],"nodes":[{}]})",
       ": /scenes/0/nodes/0: ", "7"},
      {"extension.gltf", R"({"asset":{"version":"2.0"},"extensionsRequired":["XX_unknown"],"scenes":[{}]})",
       ": /extensionsRequired/0: ", "XX_unknown"},
      {"texture.obj", "mtllib texture.mtl\n" + obj_with_uv, "", "not_a_picture.png"},
  };
  for (const BadFile& file : files) {
    const TempFolder folder;
    const std::string path = (folder / file.name).string();
    if (file.name != "missing.json") folder.write(file.name, file.content);
    folder.write("texture.mtl", "newmtl m\nmap_Kd not_a_picture.png\n");
    folder.write("not_a_picture.png", "\x89PNG\r\n\x1a\nand then nothing of the kind");
    // A texture's place is the line that names it.
    const std::string place = file.place.empty() ? "texture.mtl:2:" : path + file.place;
    check_refused(folder, {"render", path, "-o", (folder / "a.exr").string()}, 2, {place, file.says});
    check_refused(folder, {"check", path}, 2, {place, file.says});
  }
}

TEST_CASE("bad input: the command line") {
  const TempFolder folder;
  const std::string scene = folder.write("scene.json", kMatteScene).string();
  const std::string output = (folder / "a.exr").string();
  const auto refuse = [&](const Words& options, const Words& parts) {
    Words arguments{"render", scene, "-o", output};
    arguments.insert(arguments.end(), options.begin(), options.end());
    check_refused(folder, arguments, 2, parts);
  };
  refuse({"--size", "0x0"}, {"--size", "no pixels"});
  refuse({"--size", "16x0"}, {"--size", "no pixels"});
  refuse({"--size", "999999x999999"}, {"--size", "999999", "1 to 65536"});
  refuse({"--size", "99999999999999999999x1"}, {"--size", "too many"});
  refuse({"--size", "abc"}, {"--size", "'abc'", "640x480"});
  refuse({"--size", "640"}, {"--size", "'640'", "640x480"});
  refuse({"--size=-4x4"}, {"--size", "'-4x4'"});
  refuse({"--size", "4x4x4"}, {"--size", "'4x4x4'"});
  refuse({"--spp", "0"}, {"--spp", "1 to 1048576"});
  refuse({"--spp", "-1"}, {"--spp", "1 to 1048576"});
  refuse({"--spp", "many"}, {"--spp", "many"});
  refuse({"--spp", "99999999999999"}, {"--spp"});
  refuse({"--depth", "65"}, {"--depth", "0 to 64"});
  refuse({"--depth", "-1"}, {"--depth", "0 to 64"});
  refuse({"--seed", "-1"}, {"--seed"});
  refuse({"--seed", "4294967296"}, {"--seed"});
  refuse({"--exposure", "nan", "--png", (folder / "a.png").string()}, {"--exposure", "not a number"});
  refuse({"--exposure", "65"}, {"--exposure"});
  refuse({"--exposure", "1"}, {"--exposure", "--png"});
  refuse({"--engine", "wavefrnt"}, {"--engine", "wavefrnt", "wavefront", "megakernel"});
  refuse({"--rays", "packet"}, {"--rays", "packet", "single", "packets", "sorted"});
  refuse({"--rays", "packets", "--strict"}, {"--rays packets", "--strict"});
  refuse({"--rays", "packets", "--precision", "double"}, {"--rays packets", "--precision double"});
  refuse({"--precision", "half"}, {"--precision", "single", "double"});
  refuse({"--terminator", "soft"}, {"--terminator", "smooth", "hard"});
  for (const char* rays : {"packets", "sorted"}) {
    refuse({"--rays", rays, "--engine", "megakernel"}, {"--rays " + std::string(rays), "--engine megakernel"});
  }
  for (const char* accel : {"octree", "kdtree", "kdtree-median"}) {
    refuse({"--tree", "fast", "--accel", accel}, {"--tree fast", "--accel " + std::string(accel)});
  }
  refuse({"--nonsense"}, {"--nonsense", "--help"});
  refuse({"--size"}, {"--size"});
  refuse({"another.json"}, {"another.json"});
  check_refused(folder, {}, 2, {"command", "--help"});
  check_refused(folder, {"rendr", scene, "-o", output}, 2, {"\"rendr\"", "did you mean \"render\"?"});
  check_refused(folder, {"frobnicate"}, 2, {"\"frobnicate\"", "render, check, compare, devices"});
  check_refused(folder, {"--nonsense"}, 2, {"--help"});
  check_refused(folder, {"render", "-o", output}, 2, {"SCENE", "required"});
  check_refused(folder, {"render", scene}, 2, {"--output", "required"});
  check_refused(folder, {"check"}, 2, {"SCENE", "required"});
  check_refused(folder, {"render", "two\nlines.json", "-o", output}, 2, {"two lines.json", "no such file"});
}

TEST_CASE("bad input: outputs that cannot be written are refused before the render") {
  const TempFolder folder;
  const std::string scene = folder.write("scene.json", kMatteScene).string();
  const std::string output = (folder / "a.exr").string();
  folder.write("sub/file", "");
  const std::string sub = (folder / "sub").string();
  std::filesystem::create_directory(folder / "folder.exr");
  const auto refuse = [&](const Words& outputs, const Words& parts) {
    // A million samples: whoever renders first runs into the time limit.
    Words arguments{"render", scene, "--spp", "1000000"};
    arguments.insert(arguments.end(), outputs.begin(), outputs.end());
    check_refused(folder, arguments, 2, parts);
  };
  refuse({"-o", (folder / "no" / "a.exr").string()}, {"no/a.exr", "does not exist"});
  refuse({"-o", (folder / "folder.exr").string()}, {"folder.exr", "is a folder"});
  refuse({"-o", sub + "/file/a.exr"}, {"file/a.exr"});
  refuse({"-o", (folder / "a.png").string()}, {"--output", "a.png", ".exr"});
  refuse({"-o", (folder / "a").string()}, {"--output", ".exr"});
  refuse({"-o", ""}, {"--output", ".exr"});
  refuse({"-o", output, "--png", (folder / "no" / "a.png").string()}, {"no/a.png", "does not exist"});
  refuse({"-o", output, "--png", output}, {"--png", ".png"});
  refuse({"-o", output, "--trace", sub}, {sub, "is a folder"});
  refuse({"-o", output, "--trace", scene}, {"--trace", "overwrite"});
  refuse({"-o", output, "--trace", (folder / "sub" / ".." / "a.exr").string()}, {"--trace", "overwrite"});
  refuse({"-o", output, "--dump-kernels", sub + "/file"}, {"--dump-kernels", "sub/file"});
  CHECK(read_whole_file(scene) == kMatteScene);
}

// The top level of a JSON scene.
#include "host/scene/json_scene.hpp"

#include <fmt/format.h>

#include <array>

#include "host/base/json_text.hpp"
#include "host/base/read_file.hpp"
#include "host/scene/json_build.hpp"

namespace hemiray {
namespace {

constexpr std::uint64_t kSceneFileLimit = std::uint64_t{1} << 30U;  // bytes; larger meshes belong into PLY or glTF
constexpr std::int64_t kFormatVersion = 1;
constexpr std::int64_t kMaxDepth = 64;
constexpr std::int64_t kMaxEmitterSamples = 65536;

void read_settings(const JsonNode& root, Scene& scene) {
  if (const auto title = root.find("title")) scene.title = read_string(*title);
  for (const char* key : {"description", "$schema"}) {
    if (const auto text = root.find(key)) static_cast<void>(read_string(*text));
  }
  if (const auto color = root.find("background")) scene.background = read_color(*color, kMaxRadiance);
  if (const auto color = root.find("ambient")) scene.ambient = read_color(*color, kMaxRadiance);
  if (const auto shading = root.find("shading")) {
    constexpr auto kShadings = std::to_array<std::string_view>({"physical", "phong"});
    scene.shading = static_cast<Shading>(read_choice(*shading, kShadings));
  }
  if (const auto depth = root.find("depth")) scene.depth = static_cast<int>(read_integer(*depth, 0, kMaxDepth));
  if (const auto samples = root.find("emitter_samples")) {
    scene.emitter_samples = static_cast<int>(read_integer(*samples, 1, kMaxEmitterSamples));
  }
}

}  // namespace

Scene parse_json_scene(std::string_view text, const std::string& name, const std::filesystem::path& folder) {
  const nlohmann::json json = parse_json_text(text, name, kMaxSceneNesting);
  const JsonNode root(json, name);
  if (!root.is_object()) root.fail("expected a JSON object, found " + describe(json));
  // Before the keys: a file of another kind or version should hear that, not about one of its keys.
  const auto version = root.find("hemiray");
  if (!version) root.fail("not a hemiray scene: it needs \"hemiray\": 1 at its top level");
  if (!version->is_number() || version->value() != kFormatVersion) {
    version->fail(fmt::format("this program reads version {} of the format, found {}", kFormatVersion,
                              describe(version->value())));
  }
  check_keys(root, "scene");

  JsonBuild build;
  build.folder = folder;
  Scene& scene = build.scene;
  scene.source = name;
  scene.title = std::filesystem::path(name).stem().string();
  read_settings(root, scene);
  if (const auto camera = root.find("camera")) read_camera(*camera, scene);
  if (const auto materials = root.find("materials")) read_materials(*materials, build);
  if (const auto objects = root.find("objects")) {
    expect_array(*objects);
    for (std::size_t i = 0; i < objects->size(); ++i) read_object((*objects)[i], build);
  }
  if (const auto lights = root.find("lights")) {
    expect_array(*lights);
    for (std::size_t i = 0; i < lights->size(); ++i) scene.lights.push_back(read_light((*lights)[i]));
    scene.has_lights = true;
  }
  return std::move(build.scene);
}

Scene load_json_scene(const std::filesystem::path& file) {
  const std::vector<std::uint8_t> bytes = read_file(file, kSceneFileLimit);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::filesystem::path folder = file.parent_path();
  return parse_json_scene(text, file.string(), folder.empty() ? std::filesystem::path(".") : folder);
}

}  // namespace hemiray

// `hemiray check SCENE`: validates a scene without rendering it and says what is in it.
#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>

#include "host/app/commands.hpp"
#include "host/base/error.hpp"
#include "host/path/memory_prediction.hpp"
#include "host/scene/features.hpp"
#include "host/scene/flat_scene.hpp"
#include "host/scene/load.hpp"
#include "host/scene/summary.hpp"

namespace hemiray::app {
namespace {

struct CheckOptions {
  std::string scene;
  bool json = false;
};

constexpr const char* kExamples = R"(Examples:
  hemiray check scenes/cornell_box.json          validate and print a summary
  hemiray check model.glb --json | jq .triangles the same for scripts

Exit code: 0 the scene is valid, 2 it is not (one line on stderr says where and why).)";

// Without a device: for the profile of a CPU, whose waves are the smaller ones.
std::uint64_t predict(const Scene& scene) {
  const FlatScene flat = flatten_scene(scene, Instancing::automatic);
  return predict_render_bytes(flat, features_of(scene, flat, scene.depth), EngineKind::wavefront, scene.camera.width,
                              scene.camera.height, scene.depth, AccelOptions{}, DeviceProfile{});
}

}  // namespace

void add_check_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("check", "Validate a scene without rendering it and print a summary");
  const auto options = std::make_shared<CheckOptions>();
  command->add_option("SCENE", options->scene, "Scene file: .json, .gltf, .glb, .obj or .ply")->required();
  command->add_flag("--json", options->json, "Print the summary as JSON");
  command->footer(kExamples);
  command->callback([options, &exit_code] {
    const Scene scene = load_scene(options->scene);
    SceneSummary summary = summarize(scene);
    summary.device_bytes = predict(scene);
    const std::string text = options->json ? summary_json(summary) : summary_text(summary);
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
      throw DeviceError("stdout: cannot write the summary");
    }
    exit_code = static_cast<int>(ExitCode::ok);
  });
}

}  // namespace hemiray::app

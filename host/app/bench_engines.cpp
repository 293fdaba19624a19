#include "host/app/bench_engines.hpp"

#include <array>

#include "host/app/data_files.hpp"
#include "host/base/compare.hpp"
#include "host/path/render.hpp"
#include "host/scene/load.hpp"

namespace hemiray::app {
namespace {

constexpr int kSide = 128;  // [pixels]
// Without --strict the engines may round differently; a wrong branch somewhere is orders of magnitude above this.
constexpr double kMaxRelMse = 1e-6;

std::vector<bench::EngineTimes> run_scene(Context& context, const std::string& name, int rounds,
                                          const bench::Tick& tick) {
  const Scene scene = load_scene(data_file("scenes/" + name + ".json"));
  constexpr std::array kEngines{EngineKind::wavefront, EngineKind::megakernel};
  std::vector<bench::EngineTimes> times{{name, "wavefront", 0, {}, false}, {name, "megakernel", 0, {}, false}};
  std::array<std::vector<double>, 2> ms;
  std::array<Image, 2> images;
  for (int round = 0; round <= rounds; round++) {
    for (std::size_t i = 0; i < kEngines.size(); i++) {
      RenderOptions options;
      options.engine = kEngines[i];
      options.width = options.height = kSide;
      options.spp = 1;
      RenderResult result = render_scene(context, scene, options);
      if (round > 0) ms[i].push_back(result.statistics.trace_ms);
      times[i].rays = result.statistics.rays.closest + result.statistics.rays.shadow;
      images[i] = std::move(result.image);
      if (tick) tick();
    }
  }
  const ImageComparison comparison = compare_images(images[0], images[1], "wavefront", "megakernel");
  const bool agree = comparison.layers[comparison.headline].rel_mse <= kMaxRelMse;
  for (std::size_t i = 0; i < kEngines.size(); i++) {
    times[i].ms = bench::spread_of(ms[i]);
    times[i].valid = agree;
  }
  return times;
}

}  // namespace

void run_engines(Context& context, int rounds, std::vector<bench::EngineTimes>& results, const bench::Tick& tick) {
  for (const char* name : {"cornell_box", "glass_and_mirror"}) {
    for (bench::EngineTimes& times : run_scene(context, name, rounds, tick)) results.push_back(std::move(times));
  }
}

}  // namespace hemiray::app

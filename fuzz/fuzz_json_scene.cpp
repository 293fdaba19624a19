// libFuzzer target: any bytes as a JSON scene, without files beside it. Only InputError may come out, and what is
// accepted must be a valid scene that can be completed and counted.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "host/base/error.hpp"
#include "host/scene/json_scene.hpp"
#include "host/scene/load.hpp"
#include "host/scene/summary.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  hemiray::Scene scene;
  try {
    scene = hemiray::parse_json_scene(text, "fuzz.json", {});
    hemiray::validate_scene(scene);
  } catch (const hemiray::InputError& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
    return 0;
  }
  // Outside the try block: a valid scene must stay valid.
  hemiray::finish_scene(scene);
  hemiray::validate_scene(scene);
  if (hemiray::summary_json(hemiray::summarize(scene)).empty()) std::abort();
  return 0;
}

// libFuzzer target: any bytes as a glTF scene, .glb where they start with its magic, else .gltf text.
#include <cstddef>
#include <cstdint>
#include <span>

#include "fuzz/scene_checks.hpp"
#include "host/base/error.hpp"
#include "host/scene/gltf_reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    hemiray::fuzz::check_scene(hemiray::read_gltf(std::span(data, size), "fuzz.gltf", hemiray::fuzz::no_files));
  } catch (const hemiray::InputError&) {
  }
  return 0;
}

// libFuzzer target: any bytes as a PLY file.
#include <cstddef>
#include <cstdint>
#include <span>

#include "fuzz/scene_checks.hpp"
#include "host/base/error.hpp"
#include "host/scene/ply_reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    hemiray::fuzz::check_scene(hemiray::read_ply(std::span(data, size), "fuzz.ply"));
  } catch (const hemiray::InputError&) {
  }
  return 0;
}

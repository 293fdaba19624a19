// libFuzzer target: any bytes as an OBJ file; what follows the first NUL byte is its material library.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "fuzz/scene_checks.hpp"
#include "host/base/error.hpp"
#include "host/scene/obj_reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::size_t end = text.find('\0');
  const auto library = [&](const std::string& name) -> std::optional<std::vector<std::uint8_t>> {
    if (end == std::string_view::npos || !name.ends_with(".mtl")) return std::nullopt;
    return std::vector<std::uint8_t>(data + end + 1, data + size);
  };
  try {
    hemiray::fuzz::check_scene(hemiray::read_obj(text.substr(0, end), "fuzz.obj", library));
  } catch (const hemiray::InputError&) {
  }
  return 0;
}

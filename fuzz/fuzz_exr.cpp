// libFuzzer target: any bytes as an OpenEXR file. Only InputError may come out.
#include <cstddef>
#include <cstdint>
#include <span>

#include "host/base/error.hpp"
#include "host/base/exr.hpp"

namespace {
constexpr std::uint64_t kMaxValues = std::uint64_t{1} << 20U;  // large images find nothing more, and slowly
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    static_cast<void>(hemiray::decode_exr(std::span(data, size), "fuzz", kMaxValues));
  } catch (const hemiray::InputError&) {
  }
  return 0;
}

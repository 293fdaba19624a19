// libFuzzer target: any bytes as a PNG or JPEG texture. Only InputError may come out.
#include <cstddef>
#include <cstdint>
#include <span>

#include "host/base/error.hpp"
#include "host/base/image_decode.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    static_cast<void>(hemiray::decode_image(std::span(data, size), "fuzz"));
  } catch (const hemiray::InputError&) {
  }
  return 0;
}

// libFuzzer target: any bytes as an MTL material library.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "fuzz/scene_checks.hpp"
#include "host/base/error.hpp"
#include "host/scene/mtl_reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    hemiray::Notes notes;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    for (const hemiray::MtlMaterial& mtl : hemiray::read_mtl(text, "fuzz.mtl", notes)) {
      const hemiray::Material m = hemiray::to_material(mtl, notes);
      for (const hemiray::Vec3& v : {m.kd, m.ks, m.kr, m.kt, m.ka.value_or(hemiray::Vec3(0.0F))}) {
        for (int i = 0; i < 3; ++i) hemiray::fuzz::require(v[i] >= 0.0F && v[i] <= 1.0F);
      }
      for (int i = 0; i < 3; ++i) hemiray::fuzz::require(m.emission[i] >= 0.0F && std::isfinite(m.emission[i]));
      hemiray::fuzz::require(m.ior > 0.0F && std::isfinite(m.ior) && m.shininess >= 0.0F);
    }
    for (const std::string& note : notes.lines()) hemiray::fuzz::require(note.find('\n') == std::string::npos);
  } catch (const hemiray::InputError&) {
  }
  return 0;
}

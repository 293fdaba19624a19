// What sides of a mesh send before any light is exchanged between them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/bvh/accel.hpp"
#include "host/radiosity/patch_mesh.hpp"

namespace hemiray {

using SideColors = std::vector<std::array<double, 3>>;  ///< rgb by side [W/m^2]

struct SideLight {
  std::vector<shared::float4> emission, direct;  ///< own, and what lights that are no surfaces bring [W/m^2]
  std::vector<std::uint32_t> sources;            ///< sides that send light

  /// `irradiance` with what lights bring.
  [[nodiscard]] SideColors with_direct(SideColors irradiance) const;
};

/// The mesh's emission becomes what sides send: their own, and of what lights bring rho times that and
/// tau times what comes to the other side.
SideLight light_sides(Context& context, AccelBuilder& builder, const FlatScene& flat, PatchMesh& mesh);

}  // namespace hemiray

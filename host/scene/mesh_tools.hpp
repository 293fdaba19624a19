// Small steps that all mesh readers share.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "host/base/vec.hpp"
#include "host/scene/scene.hpp"

namespace hemiray {

/// `v` scaled to unit length in double; zero if it is zero or not finite ("flat here").
Vec3 normalized_or_zero(const DVec3& v);

/// True if all components are finite.
bool is_finite(const Vec3& v);

/// The sRGB transfer function's inverse; `encoded` in [0,1], the result is linear in [0,1].
float srgb_to_linear(float encoded);

/// Fresnel reflectance at normal incidence of an interface from air (or vacuum) to `ior`.
float normal_reflectance(float ior);

/// What a mesh without a material gets: grey 0.5, or white where vertex colours say the reflectance.
Material default_material(bool has_vertex_colors);

/// Largest sum of a scene's textures [bytes]: many names may stand for one strongly compressed image.
inline constexpr std::uint64_t kMaxSceneTextureBytes = std::uint64_t{1} << 32;

/// Decodes a PNG or JPEG file into `texture` (whose sampling is set already), appends it to scene.textures and returns
/// its index. Throws InputError(place, ...) for undecodable images and beyond kMaxSceneTextureBytes.
int add_texture(Scene& scene, Texture texture, std::span<const std::uint8_t> file_bytes, const std::string& place);

/// If the mesh is one quad that is a parallelogram of one material, however its two triangles are written, puts its
/// vertices in order (triangles 0 1 2 and 0 2 3) and sets mesh.rectangle, so that an emissive one is sampled as an
/// array.
void mark_rectangle(Mesh& mesh);

}  // namespace hemiray

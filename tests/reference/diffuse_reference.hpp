// An independent, naive path tracer of diffuse light: what radiosity approximates, without a mesh, in double precision.
#pragma once

#include "host/base/image.hpp"
#include "host/scene/scene.hpp"
#include "tests/reference/whitted_reference.hpp"

namespace hemiray {

/// Renders a valid scene whose surfaces are taken as Lambert's: they reflect kd on both sides, ks, kr, kt, ka and
/// smooth normals are left out, and so is the scene's ambient light. Paths end by roulette (`depth` is not read); at
/// each hit one random point of every light is asked. Layers: "" {R,G,B}, the mean radiance [W/m^2/sr], and "error"
/// {R,G,B}, its standard error by the spread of the pixel's samples. Throws InputError for a size out of range or fewer
/// than 2 samples.
Image render_diffuse_reference(const Scene& scene, const ReferenceOptions& options);

}  // namespace hemiray

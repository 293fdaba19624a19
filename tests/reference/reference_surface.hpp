// What the reference tracer knows about a hit: position, normals, and the material after textures.
#pragma once

#include "tests/reference/reference_intersect.hpp"

namespace hemiray::reference {

/// Reflectances and weights at one point; colours are linear RGB.
struct Surface {
  DVec3 position_m{0.0};
  double position_error_m = 0.0;
  bool front = true;            ///< the ray arrives at the front
  DVec3 geometric_normal{0.0};  ///< unit length, towards the viewer
  DVec3 shading_normal{0.0};    ///< unit length, on the side of geometric_normal
  DVec3 lift_m{0.0};            ///< from position_m to where shadow rays start
  DVec3 kd{0.0}, ka{0.0}, ks{0.0}, kr{0.0}, kt{0.0};
  double exponent = 1.0;  ///< Blinn-Phong
  double ior = 1.0;
  bool fresnel = false;
  DVec3 emission{0.0};  ///< radiance leaving the front [W/m^2/sr]
};

/// Evaluates the surface hit by `ray`.
Surface surface_at(const World& world, const Ray& ray, const Hit& hit);

/// Radiance leaving the front of a triangle at `barycentrics`, its texture applied [W/m^2/sr].
DVec3 triangle_emission(const World& world, const WorldTriangle& triangle, const DVec3& barycentrics);

/// The Blinn-Phong exponent of a perceptual roughness in [0,1].
double exponent_from_roughness(double roughness);

}  // namespace hemiray::reference

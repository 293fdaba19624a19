// Analytic answers that images are checked against.
#pragma once

#include <vector>

#include "host/base/vec.hpp"

namespace hemiray::reference {

/// Whether a ray of unit `direction` from the origin meets the sphere around `center_m` (camera outside): the
/// silhouette is a cone of half angle asin(radius / distance).
bool inside_sphere_silhouette(const DVec3& direction, const DVec3& center_m, double radius_m);

/// Radius in pixels of the silhouette of a sphere on the optical axis of a perspective camera.
double silhouette_radius_pixels(double distance_m, double radius_m, double fov_y_deg, int image_height);

/// Irradiance [W/m^2] of a point light of `intensity` [W/sr] at `distance_m`, arriving at `cos_incidence`.
double point_irradiance(double intensity, double distance_m, double cos_incidence);

/// Angle behind the surface [rad] by Snell's law; NaN under total internal reflection.
double snell_angle(double angle_in, double index_in, double index_out);

/// Fresnel's reflectance for unpolarised light in the angles' form; 1 under total internal reflection.
double fresnel_from_angles(double angle_in, double index_in, double index_out);

/// The mirror image of `point` in the plane through `plane_point` with unit normal `normal`.
DVec3 mirrored_point(const DVec3& point, const DVec3& plane_point, const DVec3& normal);

/// Irradiance [W/m^2] of a uniform a x b rectangle of `radiance` at a parallel patch at distance c under one corner.
double corner_irradiance_parallel(double radiance, double a_m, double b_m, double c_m);

/// The same for a rectangle in a plane perpendicular to the patch, at distance c: the patch lies under one corner's
/// foot, the rectangle rises a [m] along the patch's normal and extends b [m] sideways.
double corner_irradiance_perpendicular(double radiance, double a_m, double b_m, double c_m);

/// Lambert's formula: irradiance of a uniform polygon wholly above the patch's horizon. The corners run
/// counter-clockwise as seen from the patch.
double polygon_irradiance(double radiance, const std::vector<DVec3>& corners_m, const DVec3& point_m,
                          const DVec3& normal);

/// Irradiance of a uniform sphere wholly above the horizon, whose centre is seen at `cos_incidence`.
double sphere_irradiance(double radiance, double radius_m, double distance_m, double cos_incidence);

/// A rectangle [x0, x1] x [y0, y1] in a plane z = const [m].
struct Rectangle {
  double x0, x1, y0, y1;
};

/// Form factor from one rectangle to another in a parallel plane at distance z > 0, sides parallel (Ehlert and Smith
/// 1993).
double parallel_rectangles_factor(const Rectangle& from, const Rectangle& to, double z_m);

/// Form factor from a disk to a coaxial one at distance h (Howell's catalogue, C-41).
double coaxial_disks_factor(double from_radius_m, double to_radius_m, double h_m);

/// Of two concentric cylinders of one height, open at their ends (Howell's catalogue, C-91 and C-92): form factors from
/// the outer one's inside to the inner one, and to itself past the inner one.
struct CylinderFactors {
  double outer_to_inner, outer_to_outer;
};
CylinderFactors concentric_cylinders_factors(double inner_radius_m, double outer_radius_m, double height_m);

}  // namespace hemiray::reference

// The formulas.
#include "tests/reference/closed_forms.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace hemiray::reference {

namespace {
constexpr double kPi = std::numbers::pi;
}

bool inside_sphere_silhouette(const DVec3& direction, const DVec3& center_m, double radius_m) {
  const double sine = radius_m / glm::length(center_m);
  return glm::dot(direction, glm::normalize(center_m)) >= std::sqrt(1.0 - sine * sine);
}

double silhouette_radius_pixels(double distance_m, double radius_m, double fov_y_deg, int image_height) {
  const double tangent = radius_m / std::sqrt(distance_m * distance_m - radius_m * radius_m);
  return tangent / std::tan(fov_y_deg * kPi / 360.0) * image_height / 2.0;
}

double point_irradiance(double intensity, double distance_m, double cos_incidence) {
  return intensity * cos_incidence / (distance_m * distance_m);
}

double snell_angle(double angle_in, double index_in, double index_out) {
  const double sine = std::sin(angle_in) * index_in / index_out;
  return std::abs(sine) > 1.0 ? std::numeric_limits<double>::quiet_NaN() : std::asin(sine);
}

double fresnel_from_angles(double angle_in, double index_in, double index_out) {
  const double angle_out = snell_angle(angle_in, index_in, index_out);
  if (std::isnan(angle_out)) return 1.0;
  if (angle_in == 0.0) {
    const double ratio = (index_in - index_out) / (index_in + index_out);
    return ratio * ratio;
  }
  const double s = std::sin(angle_in - angle_out) / std::sin(angle_in + angle_out);
  const double p = std::tan(angle_in - angle_out) / std::tan(angle_in + angle_out);
  return (s * s + p * p) / 2.0;
}

DVec3 mirrored_point(const DVec3& point, const DVec3& plane_point, const DVec3& normal) {
  return point - 2.0 * glm::dot(point - plane_point, normal) * normal;
}

double corner_irradiance_parallel(double radiance, double a_m, double b_m, double c_m) {
  const double x = a_m / c_m;
  const double y = b_m / c_m;
  const double sx = std::sqrt(1.0 + x * x);
  const double sy = std::sqrt(1.0 + y * y);
  return radiance / 2.0 * (x / sx * std::atan(y / sx) + y / sy * std::atan(x / sy));
}

double corner_irradiance_perpendicular(double radiance, double a_m, double b_m, double c_m) {
  const double diagonal = std::hypot(a_m, c_m);
  return radiance / 2.0 * (std::atan(b_m / c_m) - c_m / diagonal * std::atan(b_m / diagonal));
}

double polygon_irradiance(double radiance, const std::vector<DVec3>& corners_m, const DVec3& point_m,
                          const DVec3& normal) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners_m.size(); ++i) {
    const DVec3 from = glm::normalize(corners_m[i] - point_m);
    const DVec3 to = glm::normalize(corners_m[(i + 1) % corners_m.size()] - point_m);
    const DVec3 axis = glm::cross(from, to);
    const double sine = glm::length(axis);
    if (sine > 0.0) sum += std::atan2(sine, glm::dot(from, to)) * glm::dot(axis / sine, normal);
  }
  return -radiance * sum / 2.0;
}

double sphere_irradiance(double radiance, double radius_m, double distance_m, double cos_incidence) {
  return radiance * kPi * radius_m * radius_m / (distance_m * distance_m) * cos_incidence;
}

double parallel_rectangles_factor(const Rectangle& from, const Rectangle& to, double z_m) {
  const auto term = [z_m](double dx, double dy) {
    const double p = std::hypot(dx, z_m), q = std::hypot(dy, z_m);
    return (dy * p * std::atan(dy / p) + dx * q * std::atan(dx / q) -
            0.5 * z_m * z_m * std::log(dx * dx + dy * dy + z_m * z_m)) /
           (2.0 * kPi);
  };
  double sum = 0.0;
  for (int corners = 0; corners < 16; corners++) {
    const double x = (corners & 1) != 0 ? from.x1 : from.x0, y = (corners & 2) != 0 ? from.y1 : from.y0,
                 u = (corners & 4) != 0 ? to.x1 : to.x0, v = (corners & 8) != 0 ? to.y1 : to.y0;
    const bool odd = ((corners ^ corners >> 1 ^ corners >> 2 ^ corners >> 3) & 1) != 0;
    sum += (odd ? -1.0 : 1.0) * term(x - u, y - v);
  }
  return sum / ((from.x1 - from.x0) * (from.y1 - from.y0));
}

double coaxial_disks_factor(double from_radius_m, double to_radius_m, double h_m) {
  const double a = from_radius_m / h_m, b = to_radius_m / h_m, x = 1.0 + (1.0 + b * b) / (a * a);
  return 0.5 * (x - std::sqrt(x * x - 4.0 * (b / a) * (b / a)));
}

CylinderFactors concentric_cylinders_factors(double inner_radius_m, double outer_radius_m, double height_m) {
  const double r = outer_radius_m / inner_radius_m, h = height_m / inner_radius_m, r2 = r * r, h2 = h * h;
  const double a = h2 + r2 - 1.0, b = h2 - r2 + 1.0, s = std::sqrt(4.0 * r2 + h2) / h;
  const double strips =
      std::sqrt((a + 2.0) * (a + 2.0) - 4.0 * r2) * std::acos(b / (r * a)) + b * std::asin(1.0 / r) - 0.5 * kPi * a;
  const double sines = s * std::asin((4.0 * (r2 - 1.0) + h2 / r2 * (r2 - 2.0)) / (h2 + 4.0 * (r2 - 1.0))) -
                       std::asin((r2 - 2.0) / r2) + 0.5 * kPi * (s - 1.0);
  return {(1.0 - (std::acos(b / a) - strips / (2.0 * h)) / kPi) / r,
          1.0 - 1.0 / r + 2.0 / (kPi * r) * std::atan(2.0 * std::sqrt(r2 - 1.0) / h) - h / (2.0 * kPi * r) * sines};
}

}  // namespace hemiray::reference

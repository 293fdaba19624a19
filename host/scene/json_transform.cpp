// Reading of transforms. Column vectors: the transform applied first stands rightmost.
#include "host/scene/json_transform.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <numbers>

#include "host/base/spelling.hpp"
#include "host/scene/json_keys.hpp"

namespace hemiray {
namespace {

// Below this share of its columns' lengths' product a determinant is rounding: the matrix flattens space.
constexpr double kSingular = 1e-12;
// A matrix written with six digits that is meant to be a similarity still counts as one.
constexpr double kSimilar = 1e-5;

// Sine and cosine of an angle in degrees, exact at multiples of 90.
std::pair<double, double> sin_cos_deg(double degrees) {
  const double turn = std::fmod(degrees, 360.0);
  if (std::fmod(turn, 90.0) == 0.0) {
    constexpr std::array<double, 4> kSine{0.0, 1.0, 0.0, -1.0};
    const auto quarter = static_cast<std::size_t>(static_cast<int>(turn / 90.0) + 4) % 4;
    return {kSine[quarter], kSine[(quarter + 1) % 4]};
  }
  const double radians = turn * std::numbers::pi / 180.0;
  return {std::sin(radians), std::cos(radians)};
}

DVec3 read_axis(const JsonNode& node) {
  if (!node.is_string()) return read_direction(node);
  constexpr auto kAxes = std::to_array<std::string_view>({"x", "y", "z"});
  DVec3 axis(0.0);
  axis[static_cast<int>(read_choice(node, kAxes))] = 1.0;
  return axis;
}

// Rodrigues' formula: counter-clockwise when looked at against the axis.
DMat4 read_rotation(const JsonNode& node) {
  check_keys(node, "rotate");
  const DVec3 a = read_axis(node.at("axis"));
  const auto [s, c] = sin_cos_deg(read_number(node.at("degrees"), -1e6, 1e6));
  DMat4 rotation(1.0);
  for (int column = 0; column < 3; ++column) {
    DVec3 unit(0.0);
    unit[column] = 1.0;
    rotation[column] = glm::dvec4(c * unit + s * glm::cross(a, unit) + (1.0 - c) * a[column] * a, 0.0);
  }
  return rotation;
}

DVec3 read_scale(const JsonNode& node) {
  const DVec3 scale = node.is_number() ? DVec3(read_number(node, -kMaxCoordinate, kMaxCoordinate)) : read_vector(node);
  if (scale.x == 0.0 || scale.y == 0.0 || scale.z == 0.0) node.fail("a scale of 0 flattens the object");
  return scale;
}

// Sixteen numbers row by row, as one reads a matrix on paper; GLM keeps columns.
DMat4 read_matrix(const JsonNode& node) {
  expect_array(node, 16);
  DMat4 matrix;
  for (std::size_t i = 0; i < 16; ++i) {
    const double value = read_number(node[i], -kMaxCoordinate, kMaxCoordinate);
    const double affine = i == 15 ? 1.0 : 0.0;
    if (i >= 12 && value != affine) node[i].fail("the last row must be 0 0 0 1: perspective is not supported");
    matrix[static_cast<int>(i % 4)][static_cast<int>(i / 4)] = value;
  }
  return matrix;
}

void check_regular(const JsonNode& node, const DMat4& matrix) {
  double lengths = 1.0;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      // Not "greater than": that would let NaN through.
      if (!(std::abs(matrix[column][row]) <= kMaxCoordinate)) node.fail("the transform's numbers grow out of range");
    }
    if (column < 3) lengths *= glm::length(DVec3(matrix[column]));
  }
  const double determinant = glm::determinant(glm::dmat3(matrix));
  if (!(std::abs(determinant) > kSingular * lengths)) node.fail("the transform is singular: it flattens the object");
}

DMat4 read_one(const JsonNode& node) {
  check_keys(node, "transform");
  if (node.size() == 0) node.fail("an empty transform; give translate, rotate, scale or matrix");
  if (const auto matrix = node.find("matrix")) {
    if (node.size() > 1) matrix->fail("a matrix stands alone; put the other transforms before or after it in an array");
    return read_matrix(*matrix);
  }
  DMat4 result(1.0);
  if (const auto translate = node.find("translate")) result = glm::translate(result, read_vector(*translate));
  if (const auto rotate = node.find("rotate")) result = result * read_rotation(*rotate);
  if (const auto scale = node.find("scale")) result = glm::scale(result, read_scale(*scale));
  return result;
}

}  // namespace

DMat4 read_transform(const JsonNode& node) {
  DMat4 result(1.0);
  if (node.is_array()) {
    for (std::size_t i = 0; i < node.size(); ++i) {
      result = read_one(node[i]) * result;
      check_regular(node[i], result);
    }
  } else {
    if (!node.is_object()) node.fail("expected a transform or an array of them, found " + describe(node.value()));
    result = read_one(node);
    check_regular(node, result);
  }
  return result;
}

std::optional<double> similarity_scale(const DMat4& matrix) {
  const DVec3 x(matrix[0]);
  const DVec3 y(matrix[1]);
  const DVec3 z(matrix[2]);
  const double scale = std::cbrt(std::abs(glm::determinant(glm::dmat3(matrix))));
  const auto near_zero = [&](double value) { return std::abs(value) <= kSimilar * scale * scale; };
  const bool same = near_zero(glm::dot(x, x) - scale * scale) && near_zero(glm::dot(y, y) - scale * scale) &&
                    near_zero(glm::dot(z, z) - scale * scale);
  const bool orthogonal = near_zero(glm::dot(x, y)) && near_zero(glm::dot(y, z)) && near_zero(glm::dot(z, x));
  if (!(scale > 0.0) || !same || !orthogonal) return {};
  return scale;
}

}  // namespace hemiray

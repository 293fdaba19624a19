// Disks, cylinders, cones, quadrics and implicit surfaces among the "objects" of a JSON scene.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>

#include "host/base/spelling.hpp"
#include "host/scene/json_build.hpp"
#include "host/scene/json_keys.hpp"
#include "host/scene/json_transform.hpp"
#include "host/scene/shape_geometry.hpp"

namespace hemiray {
namespace {

// Largest length and coefficient: kernels multiply several.
constexpr double kMost = 1e15;

// A rigid frame at `origin` whose z axis is the unit vector `axis`; its axes are the world's, to the bit, where that
// is.
DMat4 frame_along(const DVec3& origin, const DVec3& axis) {
  const DVec3 size = glm::abs(axis);
  const DVec3 other = size.x <= size.y && size.x <= size.z ? DVec3(1.0, 0.0, 0.0)
                      : size.y <= size.z                   ? DVec3(0.0, 1.0, 0.0)
                                                           : DVec3(0.0, 0.0, 1.0);
  const DVec3 x = glm::normalize(glm::cross(other, axis));
  return {glm::dvec4(x, 0.0), glm::dvec4(glm::cross(axis, x), 0.0), glm::dvec4(axis, 0.0), glm::dvec4(origin, 1.0)};
}

double read_radius(const JsonNode& node) { return read_number(node, 0.0, kMost); }

void read_axis(const JsonNode& node, Shape& shape) {
  const DVec3 from = read_vector(node.at("from"));
  const DVec3 to = read_vector(node.at("to"));
  const double height = glm::length(to - from);
  if (!(height > 0.0)) node.at("to").fail("must be another point than from");
  shape.half_height = 0.5 * height;
  shape.to_world = frame_along(0.5 * from + 0.5 * to, (to - from) / height);
  if (const auto caps = node.find("caps")) shape.capped = read_bool(*caps);
}

void read_coefficients(const JsonNode& node, Shape& shape) {
  const auto keys = json_keys("coefficients").keys;
  if (node.is_array()) {
    expect_array(node, shape.coefficients.size());
  } else {
    check_keys(node, "coefficients");
  }
  for (std::size_t i = 0; i < shape.coefficients.size(); ++i) {
    const auto coefficient = node.is_array() ? node[i] : node.find(keys[i].name);
    if (coefficient) shape.coefficients[i] = read_number(*coefficient, -kMost, kMost);
  }
}

ExpressionConstants read_constants(const JsonNode& node) {
  if (!node.is_object()) node.fail("expected an object of named numbers, found " + describe(node.value()));
  ExpressionConstants constants;
  for (const auto& member : node.value().items()) {
    if (!is_constant_name(member.key())) {
      node.fail(fmt::format("{} cannot name a constant: use a letter, then letters, digits and _, but not x, y or z",
                            in_quotes(member.key())));
    }
    constants[member.key()] = read_number(node.at(member.key()), -kMaxExpressionConstant, kMaxExpressionConstant);
  }
  return constants;
}

void read_expression(const JsonNode& node, Shape& shape) {
  const auto constants = node.find("constants");
  const JsonNode text = node.at("expression");
  try {
    shape.expression =
        parse_expression(read_string(text), constants ? read_constants(*constants) : ExpressionConstants());
  } catch (const ExpressionError& error) {
    text.fail(error.what());
  }
}

void read_clip(const JsonNode& node, Shape& shape) {
  check_keys(node, "clip");
  const auto box = node.find("box");
  const auto sphere = node.find("sphere");
  if (box.has_value() == sphere.has_value()) node.fail("a clip is either a box or a sphere");
  if (sphere) {
    check_keys(*sphere, "clip_sphere");
    shape.clip = Clip::sphere;
    if (const auto center = sphere->find("center")) shape.clip_center = read_vector(*center);
    shape.clip_radius = read_positive(sphere->at("radius"), kMost);
    return;
  }
  check_keys(*box, "clip_box");
  const DVec3 low = read_vector(box->at("min"));
  const DVec3 high = read_vector(box->at("max"));
  for (int c = 0; c < 3; ++c) {
    const auto axis = static_cast<std::size_t>(c);
    if (!(low[c] < high[c])) box->at("max")[axis].fail(fmt::format("must be greater than min ({})", low[c]));
  }
  shape.clip = Clip::box;
  shape.clip_center = 0.5 * low + 0.5 * high;
  shape.clip_half = 0.5 * high - 0.5 * low;
}

Shape read_geometry(const JsonNode& node, std::string_view type) {
  Shape shape;
  if (type == "disk") {
    shape.kind = ShapeKind::disk;
    shape.to_world = frame_along(read_vector(node.at("center")), read_direction(node.at("normal")));
    shape.radius = read_positive(node.at("radius"), kMost);
  } else if (type == "cylinder") {
    shape.kind = ShapeKind::cylinder;
    read_axis(node, shape);
    shape.radius = shape.upper_radius = read_positive(node.at("radius"), kMost);
  } else if (type == "cone") {
    shape.kind = ShapeKind::cone;
    read_axis(node, shape);
    shape.radius = read_radius(node.at("radius_from"));
    const auto upper = node.find("radius_to");
    shape.upper_radius = upper ? read_radius(*upper) : 0.0;
    if (shape.radius + shape.upper_radius == 0.0) node.at("radius_from").fail("one end must have a radius above 0");
  } else {
    const bool implicit = type == "implicit";
    shape.kind = implicit ? ShapeKind::implicit : ShapeKind::quadric;
    if (implicit) {
      read_expression(node, shape);
    } else {
      read_coefficients(node.at("coefficients"), shape);
    }
    if (const auto center = node.find("center")) shape.to_world = glm::translate(shape.to_world, read_vector(*center));
    if (const auto clip = node.find("clip")) read_clip(*clip, shape);
  }
  return shape;
}

}  // namespace

void read_shape_object(const JsonNode& node, std::string_view type, JsonBuild& build) {
  Shape shape = read_geometry(node, type);
  shape.name = read_name(node);
  const std::string fault = shape_fault(shape);
  if (!fault.empty()) node.fail(fmt::format("{}: {}", type, fault));
  shape.material = read_material_of(node, build);
  const Material& material = build.scene.materials[shape.material];
  refuse_textures(node, material, type);
  if (material.emission != Vec3(0.0F)) {
    node.at("material")
        .fail(fmt::format("a{} cannot emit, but material {} does; use a sphere, a quad or a mesh",
                          type == "implicit" ? "n implicit surface" : " " + std::string(type),
                          in_quotes(material.name)));
  }
  if (const auto transform = node.find("transform")) {
    shape.to_world = read_transform(*transform) * shape.to_world;
    const std::string placed_fault = shape_fault(shape);
    if (!placed_fault.empty()) transform->fail(fmt::format("{}: {}", type, placed_fault));
  }
  build.scene.shapes.push_back(std::move(shape));
}

}  // namespace hemiray

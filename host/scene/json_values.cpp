// Typed reading of JSON values with their JSON path.
#include "host/scene/json_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/base/error.hpp"
#include "host/base/json_text.hpp"
#include "host/base/spelling.hpp"
#include "host/scene/json_keys.hpp"

namespace hemiray {

std::string JsonNode::place() const { return path_.empty() ? *file_ : *file_ + ": " + path_; }

void JsonNode::fail(std::string_view message) const { throw InputError(place(), message); }

std::optional<JsonNode> JsonNode::find(std::string_view key) const {
  const auto member = value_->find(std::string(key));
  if (member == value_->end()) return {};
  JsonNode child(*member, *file_);
  child.path_ = path_ + json_pointer_step(key);
  return child;
}

JsonNode JsonNode::at(std::string_view key) const {
  if (const auto member = find(key)) return *member;
  // A misspelt key is worth more than the news that the right one is missing.
  std::vector<std::string_view> present;
  for (const auto& [name, value] : value_->items()) present.push_back(name);
  const std::string_view near = nearest_spelling(key, present);
  fail(
      fmt::format("missing key {}{}", in_quotes(key), near.empty() ? "" : fmt::format(" (found {})", in_quotes(near))));
}

JsonNode JsonNode::operator[](std::size_t index) const {
  JsonNode child((*value_)[index], *file_);
  child.path_ = fmt::format("{}/{}", path_, index);
  return child;
}

std::string describe(const nlohmann::json& value) {
  if (value.is_null()) return "null";
  if (value.is_boolean()) return value.get<bool>() ? "true" : "false";
  if (value.is_number()) return value.dump();
  if (value.is_string()) return "the string " + in_quotes(value.get_ref<const std::string&>());
  if (value.is_array()) return fmt::format("an array of {}", value.size());
  return "an object";
}

void check_keys(const JsonNode& node, std::string_view type) {
  if (!node.is_object()) node.fail(fmt::format("expected an object, found {}", describe(node.value())));
  const JsonKeyTable& table = json_keys(type);
  std::vector<std::string_view> names;
  for (const JsonKey& key : table.keys) names.push_back(key.name);
  for (const auto& [name, value] : node.value().items()) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      node.fail(fmt::format("unknown key {}{}", in_quotes(name), spelling_hint(name, names)));
    }
  }
  for (const JsonKey& key : table.keys) {
    if (key.required) static_cast<void>(node.at(key.name));
  }
}

void expect_array(const JsonNode& node, std::optional<std::size_t> size) {
  if (node.is_array() && (!size || node.size() == *size)) return;
  const std::string wanted = size ? fmt::format("an array of {}", *size) : "an array";
  node.fail(fmt::format("expected {}, found {}", wanted, describe(node.value())));
}

double read_number(const JsonNode& node, double low, double high) {
  if (!node.is_number()) node.fail(fmt::format("expected a number, found {}", describe(node.value())));
  const double value = node.value().get<double>();
  if (!(value >= low && value <= high)) {
    node.fail(fmt::format("must be from {} to {}, found {}", low, high, value));
  }
  return value;
}

double read_positive(const JsonNode& node, double high) {
  constexpr double kAny = std::numeric_limits<double>::max();
  // Below the smallest normal float a length or an index would become 0 on the device.
  constexpr double kLeast = std::numeric_limits<float>::min();
  const double value = read_number(node, -kAny, kAny);
  if (!(value > 0.0)) node.fail(fmt::format("must be greater than 0, found {}", value));
  if (value < kLeast) node.fail(fmt::format("must be at least {:.3g}, found {}", kLeast, value));
  if (value > high) node.fail(fmt::format("must be at most {:g}, found {}", high, value));
  return value;
}

std::int64_t read_integer(const JsonNode& node, std::int64_t low, std::int64_t high) {
  const double value = read_number(node, static_cast<double>(low), static_cast<double>(high));
  if (value != std::floor(value)) node.fail(fmt::format("expected a whole number, found {}", value));
  return static_cast<std::int64_t>(value);
}

bool read_bool(const JsonNode& node) {
  if (!node.value().is_boolean()) node.fail(fmt::format("expected true or false, found {}", describe(node.value())));
  return node.value().get<bool>();
}

std::string read_string(const JsonNode& node) {
  if (!node.is_string()) node.fail(fmt::format("expected a string, found {}", describe(node.value())));
  return node.value().get<std::string>();
}

std::size_t read_choice(const JsonNode& node, std::span<const std::string_view> choices) {
  const std::string text = read_string(node);
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (choices[i] == text) return i;
  }
  node.fail(fmt::format("unknown value {}{}", in_quotes(text), spelling_hint(text, choices)));
}

DVec3 read_vector(const JsonNode& node) {
  expect_array(node, 3);
  DVec3 vector;
  for (int c = 0; c < 3; ++c) {
    vector[c] = read_number(node[static_cast<std::size_t>(c)], -kMaxCoordinate, kMaxCoordinate);
  }
  return vector;
}

DVec3 read_direction(const JsonNode& node) {
  const DVec3 vector = read_vector(node);
  const double largest = std::max({std::abs(vector.x), std::abs(vector.y), std::abs(vector.z)});
  if (!(largest >= std::numeric_limits<double>::min())) node.fail("a direction must not be zero");
  return glm::normalize(vector / largest);  // scaled first, so that tiny vectors do not underflow when squared
}

Vec3 read_color(const JsonNode& node, double high) {
  if (node.is_number()) return Vec3(static_cast<float>(read_number(node, 0.0, high)));
  if (!node.is_array()) node.fail(fmt::format("expected a number or [r, g, b], found {}", describe(node.value())));
  expect_array(node, 3);
  Vec3 color;
  for (int c = 0; c < 3; ++c) {
    color[c] = static_cast<float>(read_number(node[static_cast<std::size_t>(c)], 0.0, high));
  }
  return color;
}

}  // namespace hemiray

// Typed, range-checked reading of JSON values that know their place: every fault becomes "file: /json/path: ...".
#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "host/base/vec.hpp"

namespace hemiray {

/// Largest absolute coordinate or length [m]: squares and products of two still fit into float.
inline constexpr double kMaxCoordinate = 1e18;
/// Largest radiance, intensity or irradiance.
inline constexpr double kMaxRadiance = 1e30;

/// A JSON value with its place. Refers to the value and the file name, which must outlive it.
class JsonNode {
 public:
  JsonNode(const nlohmann::json& value, const std::string& file) : value_(&value), file_(&file) {}

  [[nodiscard]] const nlohmann::json& value() const { return *value_; }
  /// "file: /json/path", or "file" for the root.
  [[nodiscard]] std::string place() const;
  /// Throws InputError at this place.
  [[noreturn]] void fail(std::string_view message) const;

  [[nodiscard]] bool is_array() const { return value_->is_array(); }
  [[nodiscard]] bool is_object() const { return value_->is_object(); }
  [[nodiscard]] bool is_string() const { return value_->is_string(); }
  [[nodiscard]] bool is_number() const { return value_->is_number(); }
  [[nodiscard]] std::size_t size() const { return value_->size(); }

  /// The member of that name, if any. The node must be an object.
  [[nodiscard]] std::optional<JsonNode> find(std::string_view key) const;
  /// The member of that name; throws InputError "missing key" where absent. The node must be an object.
  [[nodiscard]] JsonNode at(std::string_view key) const;
  /// An array's element, which must exist.
  [[nodiscard]] JsonNode operator[](std::size_t index) const;

 private:
  const nlohmann::json* value_;
  const std::string* file_;
  std::string path_;
};

/// "a number", "an array of 2", "a string" ...: what a wrong value is called in messages.
std::string describe(const nlohmann::json& value);

/// Throws unless the node is an object with only the keys of json_keys(type), and all of the required ones.
void check_keys(const JsonNode& node, std::string_view type);

/// Throws unless the node is an array (of `size` elements, where given).
void expect_array(const JsonNode& node, std::optional<std::size_t> size = {});

/// A finite number in [low, high].
double read_number(const JsonNode& node, double low, double high);
/// A finite number in (0, high].
double read_positive(const JsonNode& node, double high);
/// A whole number in [low, high]; 4.0 counts as whole.
std::int64_t read_integer(const JsonNode& node, std::int64_t low, std::int64_t high);
bool read_bool(const JsonNode& node);
std::string read_string(const JsonNode& node);
/// A string out of `choices`: its index.
std::size_t read_choice(const JsonNode& node, std::span<const std::string_view> choices);
/// [x, y, z] within +-kMaxCoordinate.
DVec3 read_vector(const JsonNode& node);
/// [x, y, z] of any non-zero length, made unit length.
DVec3 read_direction(const JsonNode& node);
/// A number (grey) or [r, g, b], each in [0, high].
Vec3 read_color(const JsonNode& node, double high);

}  // namespace hemiray

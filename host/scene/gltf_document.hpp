// A glTF file taken apart: its JSON, its buffers, and checked access to both.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "host/base/read_file.hpp"
#include "host/scene/json_values.hpp"
#include "host/scene/notes.hpp"

namespace hemiray {

/// Most nested arrays and objects in a glTF file's JSON.
inline constexpr int kMaxGltfJsonDepth = 512;
/// Largest count, length or offset accepted from JSON: exact in double, and sums of a few cannot overflow.
inline constexpr std::int64_t kMaxGltfInteger = std::int64_t{1} << 53;
inline constexpr double kMaxGltfNumber = std::numeric_limits<double>::max();

/// A bufferView's bytes.
struct GltfView {
  std::span<const std::uint8_t> bytes;
  std::size_t stride = 0;  ///< 0: tightly packed
};

/// Members with a default, for JSON objects.
double number_or(const JsonNode& object, std::string_view key, double fallback, double low, double high);
std::int64_t integer_or(const JsonNode& object, std::string_view key, std::int64_t fallback, std::int64_t low,
                        std::int64_t high);
/// The member, which must be there and an object.
JsonNode object_at(const JsonNode& object, std::string_view key);
/// The member "name" as a string made fit for messages and names, or "".
std::string name_of(const JsonNode& object);
/// object.extensions.NAME, which must be an object, if present.
std::optional<JsonNode> extension(const JsonNode& object, std::string_view name);
/// An array of 3 numbers in [low, high], or the fallback where the member is absent.
DVec3 vector_or(const JsonNode& object, std::string_view key, const DVec3& fallback, double low, double high);

class GltfDocument {
 public:
  /// Takes a .gltf text or a .glb container apart and checks version and extensions; buffers are read when first used.
  /// All arguments must outlive the document. Throws InputError.
  GltfDocument(std::span<const std::uint8_t> bytes, const std::string& file, const FileResolver& resolve, Notes& notes);
  GltfDocument(const GltfDocument&) = delete;
  GltfDocument& operator=(const GltfDocument&) = delete;

  [[nodiscard]] JsonNode root() const { return JsonNode(json_, file_); }
  [[nodiscard]] const std::string& file() const { return file_; }
  /// How many elements the top-level array of that name has; 0 if there is none.
  [[nodiscard]] std::size_t count(std::string_view array) const;
  /// Element `index` (which must exist) of a top-level array; it must be an object.
  [[nodiscard]] JsonNode item(std::string_view array, std::size_t index) const;
  /// The index that `node` holds into a top-level array. Throws InputError unless that element exists.
  [[nodiscard]] std::size_t index_of(const JsonNode& node, std::string_view array) const;

  /// The bytes of a bufferView, bounds checked against the buffer as it really is.
  GltfView view(std::size_t index);
  /// The bytes behind a URI, from the text itself or from a file beside the scene.
  std::vector<std::uint8_t> read_uri(const JsonNode& uri) const;

  /// Notes `text` once, with the file's name in front.
  void note(const std::string& text) const { notes_.once(file_ + ": " + text); }

 private:
  std::string_view split_glb(std::span<const std::uint8_t> bytes);
  void check_version() const;
  void check_extensions() const;
  std::span<const std::uint8_t> buffer(std::size_t index);

  const std::string& file_;
  const FileResolver& resolve_;
  Notes& notes_;
  nlohmann::json json_;
  std::optional<std::span<const std::uint8_t>> binary_chunk_;
  std::unordered_map<std::size_t, std::span<const std::uint8_t>> buffers_;
  std::unordered_map<std::string, std::vector<std::uint8_t>> uris_;  // what buffers_ points into
};

}  // namespace hemiray

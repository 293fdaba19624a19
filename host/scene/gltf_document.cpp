// The .glb container, version and extensions, buffers and bufferViews.
#include "host/scene/gltf_document.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "host/base/error.hpp"
#include "host/base/json_text.hpp"
#include "host/base/spelling.hpp"
#include "host/scene/data_uri.hpp"

namespace hemiray {

namespace {

constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kBinChunk = 0x004E4942;   // "BIN"

constexpr std::array<std::string_view, 5> kSupportedExtensions = {
    "KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_materials_ior", "KHR_materials_transmission",
    "KHR_mesh_quantization"};

std::uint32_t read_u32(std::span<const std::uint8_t> bytes, std::size_t offset) {
  return static_cast<std::uint32_t>(bytes[offset]) | static_cast<std::uint32_t>(bytes[offset + 1]) << 8 |
         static_cast<std::uint32_t>(bytes[offset + 2]) << 16 | static_cast<std::uint32_t>(bytes[offset + 3]) << 24;
}

}  // namespace

double number_or(const JsonNode& object, std::string_view key, double fallback, double low, double high) {
  const std::optional<JsonNode> member = object.find(key);
  return member ? read_number(*member, low, high) : fallback;
}

std::int64_t integer_or(const JsonNode& object, std::string_view key, std::int64_t fallback, std::int64_t low,
                        std::int64_t high) {
  const std::optional<JsonNode> member = object.find(key);
  return member ? read_integer(*member, low, high) : fallback;
}

JsonNode object_at(const JsonNode& object, std::string_view key) {
  JsonNode node = object.at(key);
  if (!node.is_object()) node.fail("expected an object, found " + describe(node.value()));
  return node;
}

std::string name_of(const JsonNode& object) {
  const std::optional<JsonNode> member = object.find("name");
  return member ? printable(read_string(*member)) : std::string();
}

std::optional<JsonNode> extension(const JsonNode& object, std::string_view name) {
  const std::optional<JsonNode> all = object.find("extensions");
  if (!all) return {};
  if (!all->is_object()) all->fail("expected an object, found " + describe(all->value()));
  std::optional<JsonNode> found = all->find(name);
  if (found && !found->is_object()) found->fail("expected an object, found " + describe(found->value()));
  return found;
}

DVec3 vector_or(const JsonNode& object, std::string_view key, const DVec3& fallback, double low, double high) {
  const std::optional<JsonNode> member = object.find(key);
  if (!member) return fallback;
  expect_array(*member, 3);
  DVec3 vector;
  for (int i = 0; i < 3; ++i) vector[i] = read_number((*member)[static_cast<std::size_t>(i)], low, high);
  return vector;
}

GltfDocument::GltfDocument(std::span<const std::uint8_t> bytes, const std::string& file, const FileResolver& resolve,
                           Notes& notes)
    : file_(file), resolve_(resolve), notes_(notes) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("glTF")) {
    text = split_glb(bytes);
  } else if (text.starts_with("\xEF\xBB\xBF")) {
    text.remove_prefix(3);
  }
  json_ = parse_json_text(text, file_, kMaxGltfJsonDepth);
  if (!json_.is_object()) root().fail("expected an object, found " + describe(json_));
  check_version();
  check_extensions();
}

std::string_view GltfDocument::split_glb(std::span<const std::uint8_t> bytes) {
  const auto fail = [this](std::size_t offset, const std::string& message) {
    throw InputError(file_, "byte " + std::to_string(offset) + ": " + message);
  };
  if (bytes.size() < 20) fail(bytes.size(), "the .glb file ends within its header; it is truncated");
  const std::uint32_t version = read_u32(bytes, 4);
  if (version != 2) fail(4, "glTF container version " + std::to_string(version) + "; version 2 is supported");
  const std::uint32_t length = read_u32(bytes, 8);
  if (length != bytes.size()) {
    fail(8, "the header says " + std::to_string(length) + " bytes, the file has " + std::to_string(bytes.size()) +
                (length > bytes.size() ? "; it is truncated" : ""));
  }
  std::optional<std::string_view> json;
  std::size_t offset = 12;
  while (offset < bytes.size()) {
    if (bytes.size() - offset < 8) fail(offset, "the file ends within a chunk's header");
    const std::uint32_t chunk_length = read_u32(bytes, offset);
    const std::uint32_t type = read_u32(bytes, offset + 4);
    const std::span<const std::uint8_t> left = bytes.subspan(offset + 8);
    if (chunk_length > left.size()) {
      fail(offset, "the chunk says " + std::to_string(chunk_length) + " bytes, but " + std::to_string(left.size()) +
                       " are left");
    }
    const std::span<const std::uint8_t> chunk = left.first(chunk_length);
    if (!json) {
      if (type != kJsonChunk) fail(offset + 4, "the first chunk must be of type JSON");
      json = std::string_view(reinterpret_cast<const char*>(chunk.data()), chunk.size());
    } else if (type == kBinChunk && !binary_chunk_) {
      binary_chunk_ = chunk;
    }
    offset += 8 + std::size_t{chunk_length};
  }
  return *json;  // the file has at least 20 bytes, so the loop saw a first chunk
}

void GltfDocument::check_version() const {
  const JsonNode asset = object_at(root(), "asset");
  const JsonNode version = asset.at("version");
  if (!read_string(version).starts_with("2.")) {
    version.fail("glTF version '" + printable(read_string(version)) + "'; version 2.0 is supported");
  }
  const std::optional<JsonNode> minimum = asset.find("minVersion");
  if (minimum && read_string(*minimum) != "2.0") {
    minimum->fail("needs glTF version '" + printable(read_string(*minimum)) + "'; version 2.0 is supported");
  }
}

void GltfDocument::check_extensions() const {
  const auto supported = [](const std::string& name) {
    return std::find(kSupportedExtensions.begin(), kSupportedExtensions.end(), name) != kSupportedExtensions.end();
  };
  if (const std::optional<JsonNode> required = root().find("extensionsRequired")) {
    expect_array(*required);
    for (std::size_t i = 0; i < required->size(); ++i) {
      const std::string name = read_string((*required)[i]);
      if (!supported(name)) {
        (*required)[i].fail("the file requires the extension '" + printable(name) + "', which is not supported");
      }
    }
  }
  if (const std::optional<JsonNode> used = root().find("extensionsUsed")) {
    expect_array(*used);
    for (std::size_t i = 0; i < used->size(); ++i) {
      const std::string name = read_string((*used)[i]);
      if (!supported(name)) note("extension '" + printable(name) + "' is not supported, ignored");
    }
  }
}

std::size_t GltfDocument::count(std::string_view array) const {
  const std::optional<JsonNode> node = root().find(array);
  if (!node) return 0;
  expect_array(*node);
  return node->size();
}

JsonNode GltfDocument::item(std::string_view array, std::size_t index) const {
  JsonNode element = root().at(array)[index];
  if (!element.is_object()) element.fail("expected an object, found " + describe(element.value()));
  return element;
}

std::size_t GltfDocument::index_of(const JsonNode& node, std::string_view array) const {
  const std::int64_t index = read_integer(node, 0, kMaxGltfInteger);
  const std::size_t available = count(array);
  if (static_cast<std::uint64_t>(index) >= available) {
    node.fail(std::string(array) + "[" + std::to_string(index) + "] does not exist; there are " +
              std::to_string(available));
  }
  return static_cast<std::size_t>(index);
}

std::vector<std::uint8_t> GltfDocument::read_uri(const JsonNode& uri) const {
  const std::string text = read_string(uri);
  if (is_data_uri(text)) return decode_data_uri(text, uri.place());
  const std::string name = file_of_uri(text, uri.place());
  std::optional<std::vector<std::uint8_t>> bytes = resolve_(name);
  if (!bytes) uri.fail("file '" + printable(name) + "' not found beside the scene");
  return std::move(*bytes);
}

std::span<const std::uint8_t> GltfDocument::buffer(std::size_t index) {
  const auto known = buffers_.find(index);
  if (known != buffers_.end()) return known->second;
  const JsonNode node = item("buffers", index);
  const JsonNode length_node = node.at("byteLength");
  const auto length = static_cast<std::uint64_t>(read_integer(length_node, 1, kMaxGltfInteger));
  std::span<const std::uint8_t> bytes;
  if (const std::optional<JsonNode> uri = node.find("uri")) {
    const std::string key = read_string(*uri);
    auto read = uris_.find(key);
    if (read == uris_.end()) read = uris_.emplace(key, read_uri(*uri)).first;
    bytes = read->second;
  } else if (index == 0 && binary_chunk_) {
    bytes = *binary_chunk_;
  } else {
    node.fail("has neither a uri nor a binary chunk");
  }
  if (length > bytes.size()) {
    length_node.fail("says " + std::to_string(length) + " bytes, but the buffer has only " +
                     std::to_string(bytes.size()) + "; it is truncated");
  }
  bytes = bytes.first(static_cast<std::size_t>(length));
  buffers_.emplace(index, bytes);
  return bytes;
}

GltfView GltfDocument::view(std::size_t index) {
  const JsonNode node = item("bufferViews", index);
  const std::span<const std::uint8_t> bytes = buffer(index_of(node.at("buffer"), "buffers"));
  const auto offset = static_cast<std::uint64_t>(integer_or(node, "byteOffset", 0, 0, kMaxGltfInteger));
  const auto length = static_cast<std::uint64_t>(read_integer(node.at("byteLength"), 1, kMaxGltfInteger));
  if (offset > bytes.size() || length > bytes.size() - offset) {
    node.fail("bytes " + std::to_string(offset) + " to " + std::to_string(offset + length) +
              " lie outside the buffer of " + std::to_string(bytes.size()) + " bytes");
  }
  GltfView view;
  view.bytes = bytes.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
  view.stride = static_cast<std::size_t>(integer_or(node, "byteStride", 0, 4, 252));
  return view;
}

}  // namespace hemiray

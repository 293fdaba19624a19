// Builds binary PLY bodies, glTF documents and .glb containers for tests.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace hemiray::test {

/// Bytes of `value` in the given order.
template <typename T>
void append(std::vector<std::uint8_t>& bytes, T value, bool big_endian = false) {
  std::uint8_t raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  const bool reverse = big_endian != (std::endian::native == std::endian::big);
  for (std::size_t i = 0; i < sizeof(T); ++i) bytes.push_back(raw[reverse ? sizeof(T) - 1 - i : i]);
}

/// Base64 of bytes, written for the tests alone.
inline std::string base64(const std::vector<std::uint8_t>& bytes) {
  static const std::string kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63U];
    }
  }
  return text;
}

/// A glTF document under construction: one buffer, one scene, one mesh `0` placed by node 0.
struct GltfBuilder {
  nlohmann::json json = {{"asset", {{"version", "2.0"}}},
                         {"scene", 0},
                         {"scenes", {{{"nodes", {0}}}}},
                         {"nodes", {{{"mesh", 0}}}},
                         {"bufferViews", nlohmann::json::array()},
                         {"accessors", nlohmann::json::array()},
                         {"meshes", {{{"primitives", nlohmann::json::array()}}}}};
  std::vector<std::uint8_t> binary;

  /// A bufferView over `bytes`, aligned to 4; returns its index.
  int view(const std::vector<std::uint8_t>& bytes) {
    binary.resize((binary.size() + 3) / 4 * 4);
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes.size()}});
    binary.insert(binary.end(), bytes.begin(), bytes.end());
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }

  /// A tightly packed accessor; returns its index.
  template <typename T>
  int accessor(const std::vector<T>& values, int component_type, const std::string& type, std::size_t components) {
    std::vector<std::uint8_t> bytes;
    for (const T value : values) append(bytes, value);
    json["accessors"].push_back({{"bufferView", view(bytes)},
                                 {"componentType", component_type},
                                 {"count", values.size() / components},
                                 {"type", type}});
    return static_cast<int>(json["accessors"].size()) - 1;
  }
  int floats3(const std::vector<float>& values) { return accessor(values, 5126, "VEC3", 3); }
  int floats2(const std::vector<float>& values) { return accessor(values, 5126, "VEC2", 2); }
  int indices(const std::vector<std::uint16_t>& values) { return accessor(values, 5123, "SCALAR", 1); }

  nlohmann::json& add_primitive(const nlohmann::json& primitive) {
    nlohmann::json& all = json["meshes"][0]["primitives"];
    all.push_back(primitive);
    return all.back();
  }

  /// The document with its buffer as a data: URI.
  [[nodiscard]] std::vector<std::uint8_t> gltf() const {
    nlohmann::json whole = json;
    if (!binary.empty() && !whole.contains("buffers")) {
      whole["buffers"] = {
          {{"byteLength", binary.size()}, {"uri", "data:application/octet-stream;base64," + base64(binary)}}};
    }
    const std::string text = whole.dump();
    return {text.begin(), text.end()};
  }

  /// The document as a .glb container.
  [[nodiscard]] std::vector<std::uint8_t> glb() const {
    nlohmann::json whole = json;
    whole["buffers"] = {{{"byteLength", binary.size()}}};
    std::string text = whole.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::vector<std::uint8_t> chunk = binary;
    chunk.resize((chunk.size() + 3) / 4 * 4);
    std::vector<std::uint8_t> bytes;
    append(bytes, std::uint32_t{0x46546C67});
    append(bytes, std::uint32_t{2});
    append(bytes, static_cast<std::uint32_t>(28 + text.size() + chunk.size()));
    append(bytes, static_cast<std::uint32_t>(text.size()));
    append(bytes, std::uint32_t{0x4E4F534A});
    bytes.insert(bytes.end(), text.begin(), text.end());
    append(bytes, static_cast<std::uint32_t>(chunk.size()));
    append(bytes, std::uint32_t{0x004E4942});
    bytes.insert(bytes.end(), chunk.begin(), chunk.end());
    return bytes;
  }
};

/// One triangle in the xy plane, ready to be changed or broken.
inline GltfBuilder triangle_gltf() {
  GltfBuilder builder;
  const int positions = builder.floats3({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int indices = builder.indices({0, 1, 2});
  builder.add_primitive({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  return builder;
}

}  // namespace hemiray::test

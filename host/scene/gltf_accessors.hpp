// Typed reading of glTF accessors: strides, normalised integers, sparse values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/base/vec.hpp"
#include "host/scene/gltf_document.hpp"

namespace hemiray {

/// Most elements of an accessor that has no bufferView and so takes no space in the file.
inline constexpr std::int64_t kMaxZeroElements = std::int64_t{1} << 22;

/// An accessor whose every element is known to lie within its buffer. Elements are decoded one at a time: several
/// primitives often share one large accessor and use a part of it each.
class GltfAccessor {
 public:
  /// Throws InputError at the accessor's JSON path if anything lies outside its buffer.
  GltfAccessor(GltfDocument& document, std::size_t index);

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] int components() const { return components_; }  ///< 1 to 4; matrices are refused
  [[nodiscard]] bool is_unsigned_integer() const;
  [[nodiscard]] bool is_normalized() const { return normalized_; }
  [[nodiscard]] const JsonNode& node() const { return node_; }

  /// Element `i` < count(): floats as stored, integers as numbers or, if normalised, in [0,1] or [-1,1]. Components the
  /// accessor does not have are 0.
  [[nodiscard]] Vec4 value(std::size_t i) const;
  /// Element `i` < count() of an unsigned integer accessor of one component.
  [[nodiscard]] std::uint32_t index(std::size_t i) const;

 private:
  enum class Component { int8 = 5120, uint8 = 5121, int16 = 5122, uint16 = 5123, uint32 = 5125, float32 = 5126 };

  void read_type();
  void read_base(GltfDocument& document);
  void read_sparse(GltfDocument& document);
  [[nodiscard]] std::size_t component_size() const;
  [[nodiscard]] const std::uint8_t* element(std::size_t i) const;
  [[nodiscard]] std::uint32_t bits(const std::uint8_t* data) const;
  [[nodiscard]] float decode(const std::uint8_t* data) const;

  JsonNode node_;
  Component component_ = Component::float32;
  int components_ = 1;
  bool normalized_ = false;
  std::size_t count_ = 0;
  std::size_t element_size_ = 0;
  std::size_t stride_ = 0;
  std::span<const std::uint8_t> base_;         // empty: all zero
  std::vector<std::uint32_t> sparse_indices_;  // ascending
  std::span<const std::uint8_t> sparse_values_;
};

}  // namespace hemiray

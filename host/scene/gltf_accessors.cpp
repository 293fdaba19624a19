// Accessor layout checks and element decoding.
#include "host/scene/gltf_accessors.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace hemiray {

GltfAccessor::GltfAccessor(GltfDocument& document, std::size_t index) : node_(document.item("accessors", index)) {
  read_type();
  count_ = static_cast<std::size_t>(read_integer(node_.at("count"), 1, kMaxGltfInteger));
  read_base(document);
  if (node_.find("sparse")) read_sparse(document);
}

void GltfAccessor::read_type() {
  const JsonNode component = node_.at("componentType");
  const std::int64_t code = read_integer(component, 0, kMaxGltfInteger);
  if (code < 5120 || code > 5126 || code == 5124) {
    component.fail("unknown component type " + std::to_string(code) + "; use 5120 to 5123, 5125 or 5126");
  }
  component_ = static_cast<Component>(code);
  const JsonNode type = node_.at("type");
  const std::string name = read_string(type);
  static constexpr std::array<std::string_view, 4> kTypes = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  const auto known = std::find(kTypes.begin(), kTypes.end(), name);
  if (known == kTypes.end())
    type.fail("unsupported type " + describe(type.value()) + "; use SCALAR, VEC2, VEC3 or VEC4");
  components_ = static_cast<int>(known - kTypes.begin()) + 1;
  if (const std::optional<JsonNode> normalized = node_.find("normalized")) normalized_ = read_bool(*normalized);
  element_size_ = component_size() * static_cast<std::size_t>(components_);
}

void GltfAccessor::read_base(GltfDocument& document) {
  const std::optional<JsonNode> view_node = node_.find("bufferView");
  if (!view_node) {
    if (count_ > static_cast<std::size_t>(kMaxZeroElements)) {
      node_.fail("more than " + std::to_string(kMaxZeroElements) + " elements without a bufferView");
    }
    return;
  }
  const GltfView view = document.view(document.index_of(*view_node, "bufferViews"));
  const auto offset = static_cast<std::uint64_t>(integer_or(node_, "byteOffset", 0, 0, kMaxGltfInteger));
  stride_ = view.stride == 0 ? element_size_ : view.stride;
  if (stride_ < element_size_) {
    node_.fail("elements of " + std::to_string(element_size_) + " bytes do not fit the byteStride of " +
               std::to_string(stride_));
  }
  // Divided rather than multiplied, so that nothing can overflow.
  const std::uint64_t size = view.bytes.size();
  const bool fits =
      offset <= size && element_size_ <= size - offset && count_ - 1 <= (size - offset - element_size_) / stride_;
  if (!fits) {
    node_.fail(std::to_string(count_) + " elements of " + std::to_string(element_size_) + " bytes from byte " +
               std::to_string(offset) + " on lie outside the bufferView of " + std::to_string(size) + " bytes");
  }
  base_ = view.bytes.subspan(static_cast<std::size_t>(offset));
}

void GltfAccessor::read_sparse(GltfDocument& document) {
  const JsonNode sparse = node_.at("sparse");
  const auto count = static_cast<std::size_t>(read_integer(sparse.at("count"), 1, kMaxGltfInteger));
  const auto part = [&](std::string_view key, std::size_t size) {
    const JsonNode node = sparse.at(key);
    const GltfView view = document.view(document.index_of(node.at("bufferView"), "bufferViews"));
    const auto offset = static_cast<std::uint64_t>(integer_or(node, "byteOffset", 0, 0, kMaxGltfInteger));
    if (offset > view.bytes.size() || count > (view.bytes.size() - offset) / size) {
      node.fail(std::to_string(count) + " elements of " + std::to_string(size) + " bytes from byte " +
                std::to_string(offset) + " on lie outside the bufferView of " + std::to_string(view.bytes.size()) +
                " bytes");
    }
    return view.bytes.subspan(static_cast<std::size_t>(offset), count * size);
  };
  const JsonNode indices = sparse.at("indices");
  const JsonNode type = indices.at("componentType");
  const std::int64_t code = read_integer(type, 0, kMaxGltfInteger);
  if (code != 5121 && code != 5123 && code != 5125) type.fail("sparse indices must have type 5121, 5123 or 5125");
  const std::size_t index_size = code == 5121 ? 1 : (code == 5123 ? 2 : 4);
  const std::span<const std::uint8_t> index_bytes = part("indices", index_size);
  sparse_values_ = part("values", element_size_);
  sparse_indices_.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t value = 0;
    for (std::size_t b = 0; b < index_size; ++b) {
      value |= static_cast<std::uint32_t>(index_bytes[i * index_size + b]) << (8 * b);
    }
    if (value >= count_)
      indices.fail("element " + std::to_string(value) + " does not exist; there are " + std::to_string(count_));
    if (i > 0 && value <= sparse_indices_.back()) indices.fail("the indices must strictly increase");
    sparse_indices_.push_back(value);
  }
}

bool GltfAccessor::is_unsigned_integer() const {
  return component_ == Component::uint8 || component_ == Component::uint16 || component_ == Component::uint32;
}

std::size_t GltfAccessor::component_size() const {
  switch (component_) {
    case Component::int8:
    case Component::uint8:
      return 1;
    case Component::int16:
    case Component::uint16:
      return 2;
    default:
      return 4;
  }
}

// Null for elements that are zero.
const std::uint8_t* GltfAccessor::element(std::size_t i) const {
  if (!sparse_indices_.empty()) {
    const auto at = std::lower_bound(sparse_indices_.begin(), sparse_indices_.end(), i);
    if (at != sparse_indices_.end() && *at == i) {
      return sparse_values_.data() + static_cast<std::size_t>(at - sparse_indices_.begin()) * element_size_;
    }
  }
  return base_.empty() ? nullptr : base_.data() + i * stride_;
}

std::uint32_t GltfAccessor::bits(const std::uint8_t* data) const {
  std::uint32_t value = 0;
  for (std::size_t b = 0; b < component_size(); ++b) value |= static_cast<std::uint32_t>(data[b]) << (8 * b);
  return value;
}

float GltfAccessor::decode(const std::uint8_t* data) const {
  const std::uint32_t raw = bits(data);
  switch (component_) {
    case Component::float32:
      return std::bit_cast<float>(raw);
    case Component::int8: {
      const auto value = static_cast<float>(static_cast<std::int8_t>(raw));
      return normalized_ ? std::max(value / 127.0F, -1.0F) : value;
    }
    case Component::int16: {
      const auto value = static_cast<float>(static_cast<std::int16_t>(raw));
      return normalized_ ? std::max(value / 32767.0F, -1.0F) : value;
    }
    case Component::uint8:
      return static_cast<float>(raw) / (normalized_ ? 255.0F : 1.0F);
    case Component::uint16:
      return static_cast<float>(raw) / (normalized_ ? 65535.0F : 1.0F);
    default:
      return static_cast<float>(static_cast<double>(raw) / (normalized_ ? 4294967295.0 : 1.0));
  }
}

Vec4 GltfAccessor::value(std::size_t i) const {
  Vec4 result(0.0F);
  const std::uint8_t* data = element(i);
  if (data == nullptr) return result;
  for (int c = 0; c < components_; ++c) result[c] = decode(data + static_cast<std::size_t>(c) * component_size());
  return result;
}

std::uint32_t GltfAccessor::index(std::size_t i) const {
  const std::uint8_t* data = element(i);
  return data == nullptr ? 0 : bits(data);
}

}  // namespace hemiray

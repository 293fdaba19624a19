// Reads PLY values, binary or ascii, with every length checked before use.
#include "host/scene/ply_values.hpp"

#include <bit>
#include <cmath>
#include <limits>

#include "host/base/error.hpp"
#include "host/base/spelling.hpp"

namespace hemiray {

namespace {

std::pair<double, double> integer_range(PlyType type) {
  switch (type) {
    case PlyType::int8:
      return {-128.0, 127.0};
    case PlyType::uint8:
      return {0.0, 255.0};
    case PlyType::int16:
      return {-32768.0, 32767.0};
    case PlyType::uint16:
      return {0.0, 65535.0};
    case PlyType::int32:
      return {-2147483648.0, 2147483647.0};
    default:
      return {0.0, 4294967295.0};
  }
}

}  // namespace

PlyValues::PlyValues(std::span<const std::uint8_t> bytes, PlyFormat format, const TextCursor& cursor)
    : bytes_(bytes), format_(format), cursor_(cursor), offset_(cursor.offset_after_line()) {}

std::string PlyValues::where() const {
  return element_ == nullptr ? std::string() : printable(element_->name) + " " + std::to_string(index_) + ": ";
}

void PlyValues::fail(std::string_view message) const {
  const std::string text = where() + std::string(message);
  if (is_ascii()) cursor_.fail(text);
  throw InputError(cursor_.file(), text);
}

void PlyValues::begin_element(const PlyElement& element) {
  element_ = &element;
  std::uint64_t smallest = 0;  // bytes an instance takes at least: a digit and a separator, or the binary values
  for (const PlyProperty& property : element.properties) {
    smallest += is_ascii() ? 2 : ply_type_size(property.is_list ? property.count_type : property.type);
  }
  const std::uint64_t left = is_ascii() ? cursor_.remaining() + 1 : bytes_.size() - offset_;
  if (smallest > 0 && element.count > left / smallest) {
    throw InputError(element.place, "element '" + printable(element.name) + "': " + std::to_string(element.count) +
                                        " instances need at least " + std::to_string(smallest) +
                                        " bytes each, but the file has only " + std::to_string(left) +
                                        " left; it is truncated or the count is wrong");
  }
}

void PlyValues::begin_instance(std::uint64_t index) {
  index_ = index;
  if (is_ascii() && !cursor_.next_line()) fail("the file ends here; it is truncated");
}

void PlyValues::end_instance() {
  if (is_ascii() && !cursor_.at_line_end()) {
    const std::string extra = printable(cursor_.token());
    fail("unexpected '" + extra + "' at the end of the line");
  }
}

double PlyValues::binary_scalar(PlyType type) {
  const std::size_t size = ply_type_size(type);
  if (bytes_.size() - offset_ < size) fail("the file ends here; it is truncated");
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t at = format_ == PlyFormat::binary_big_endian ? i : size - 1 - i;
    bits = bits << 8 | bytes_[offset_ + at];
  }
  offset_ += size;
  switch (type) {
    case PlyType::int8:
      return static_cast<std::int8_t>(bits);
    case PlyType::int16:
      return static_cast<std::int16_t>(bits);
    case PlyType::int32:
      return static_cast<std::int32_t>(bits);
    case PlyType::float32:
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    case PlyType::float64:
      return std::bit_cast<double>(bits);
    default:
      return static_cast<double>(bits);
  }
}

double PlyValues::ascii_scalar(PlyType type) {
  if (cursor_.at_line_end()) {
    cursor_.token();  // moves the place to the line's end
    fail("the line ends early; a value is missing");
  }
  const double value = cursor_.number(element_->name + " " + std::to_string(index_));
  if (ply_is_integer(type)) {
    const auto [low, high] = integer_range(type);
    if (value != std::floor(value)) fail("expected an integer");
    if (value < low || value > high) fail("the value does not fit the property's type");
  }
  return value;
}

double PlyValues::scalar(PlyType type) { return is_ascii() ? ascii_scalar(type) : binary_scalar(type); }

std::uint64_t PlyValues::list_length(const PlyProperty& property) {
  const double length = scalar(property.count_type);
  if (length < 0.0) fail("list '" + printable(property.name) + "' has a negative length");
  const auto count = static_cast<std::uint64_t>(length);
  const std::uint64_t left =
      is_ascii() ? (cursor_.remaining() + 1) / 2 : (bytes_.size() - offset_) / ply_type_size(property.type);
  if (count > left) fail("list '" + printable(property.name) + "' is longer than the file; it is truncated");
  return count;
}

void PlyValues::skip(const PlyProperty& property) {
  if (!property.is_list) {
    scalar(property.type);
    return;
  }
  const std::uint64_t count = list_length(property);
  if (is_ascii()) {
    for (std::uint64_t i = 0; i < count; ++i) scalar(property.type);
  } else {
    offset_ += static_cast<std::size_t>(count) * ply_type_size(property.type);
  }
}

}  // namespace hemiray

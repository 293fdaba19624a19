// The values of a PLY file's body one after the other, whatever the format.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "host/scene/ply_header.hpp"

namespace hemiray {

/// Hands out values in file order. Errors name the element and the instance at hand: "file: vertex 12: ..." in binary
/// files, "file:line:column: vertex 12: ..." in ascii ones.
class PlyValues {
 public:
  /// `cursor` stands on the end_header line of `bytes`.
  PlyValues(std::span<const std::uint8_t> bytes, PlyFormat format, const TextCursor& cursor);

  /// Starts the element; throws InputError at its header line if the rest of the file cannot hold `element.count`
  /// instances, so that callers may allocate for that many.
  void begin_element(const PlyElement& element);
  void begin_instance(std::uint64_t index);
  void end_instance();

  /// The next value. In ascii text it must be finite and fit its type; in binary data it may be NaN or infinite.
  double scalar(PlyType type);
  /// The length of a list, checked against the rest of the file.
  std::uint64_t list_length(const PlyProperty& property);
  /// Skips a scalar or a whole list.
  void skip(const PlyProperty& property);

  [[nodiscard]] bool is_ascii() const { return format_ == PlyFormat::ascii; }
  [[noreturn]] void fail(std::string_view message) const;

 private:
  [[nodiscard]] std::string where() const;
  double binary_scalar(PlyType type);
  double ascii_scalar(PlyType type);

  std::span<const std::uint8_t> bytes_;
  PlyFormat format_;
  TextCursor cursor_;
  std::size_t offset_;
  const PlyElement* element_ = nullptr;
  std::uint64_t index_ = 0;
};

}  // namespace hemiray

// Parses PLY headers.
#include "host/scene/ply_header.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "host/base/spelling.hpp"

namespace hemiray {

namespace {

PlyType read_type(TextCursor& cursor) {
  static constexpr std::array<std::pair<std::string_view, PlyType>, 16> kNames = {{{"char", PlyType::int8},
                                                                                   {"int8", PlyType::int8},
                                                                                   {"uchar", PlyType::uint8},
                                                                                   {"uint8", PlyType::uint8},
                                                                                   {"short", PlyType::int16},
                                                                                   {"int16", PlyType::int16},
                                                                                   {"ushort", PlyType::uint16},
                                                                                   {"uint16", PlyType::uint16},
                                                                                   {"int", PlyType::int32},
                                                                                   {"int32", PlyType::int32},
                                                                                   {"uint", PlyType::uint32},
                                                                                   {"uint32", PlyType::uint32},
                                                                                   {"float", PlyType::float32},
                                                                                   {"float32", PlyType::float32},
                                                                                   {"double", PlyType::float64},
                                                                                   {"float64", PlyType::float64}}};
  const std::string_view name = cursor.token();
  for (const auto& [known, type] : kNames) {
    if (name == known) return type;
  }
  cursor.fail("unknown type '" + printable(name) + "'; use char, uchar, short, ushort, int, uint, float or double");
}

PlyFormat read_format(TextCursor& cursor) {
  const std::string_view name = cursor.token();
  std::optional<PlyFormat> format;
  if (name == "ascii") format = PlyFormat::ascii;
  if (name == "binary_little_endian") format = PlyFormat::binary_little_endian;
  if (name == "binary_big_endian") format = PlyFormat::binary_big_endian;
  if (!format) {
    cursor.fail("unknown format '" + printable(name) + "'; use ascii, binary_little_endian or binary_big_endian");
  }
  const std::string_view version = cursor.token();
  if (version != "1.0") cursor.fail("unknown version '" + printable(version) + "'; 1.0 is supported");
  return *format;
}

PlyElement read_element(TextCursor& cursor, const PlyHeader& header) {
  PlyElement element;
  const std::string_view name = cursor.token();
  if (name.empty()) cursor.fail("element: a name is missing");
  element.name = std::string(name);
  element.place = cursor.place();
  for (const PlyElement& other : header.elements) {
    if (other.name == element.name) cursor.fail("element '" + printable(name) + "' is declared twice");
  }
  element.count =
      static_cast<std::uint64_t>(cursor.integer("element count", 0, std::numeric_limits<std::int64_t>::max()));
  return element;
}

PlyProperty read_property(TextCursor& cursor, const PlyElement& element) {
  PlyProperty property;
  TextCursor ahead = cursor;
  if (ahead.token() == "list") {
    cursor.token();
    property.is_list = true;
    property.count_type = read_type(cursor);
    if (!ply_is_integer(property.count_type)) cursor.fail("the length of a list must have an integer type");
  }
  property.type = read_type(cursor);
  const std::string_view name = cursor.token();
  if (name.empty()) cursor.fail("property: a name is missing");
  property.name = std::string(name);
  for (const PlyProperty& other : element.properties) {
    if (other.name == property.name) cursor.fail("property '" + printable(name) + "' is declared twice");
  }
  return property;
}

}  // namespace

std::size_t ply_type_size(PlyType type) {
  switch (type) {
    case PlyType::int8:
    case PlyType::uint8:
      return 1;
    case PlyType::int16:
    case PlyType::uint16:
      return 2;
    case PlyType::float64:
      return 8;
    default:
      return 4;
  }
}

bool ply_is_integer(PlyType type) { return type != PlyType::float32 && type != PlyType::float64; }

PlyHeader read_ply_header(TextCursor& cursor) {
  // Each name is compared with all before it; real headers have a dozen.
  constexpr std::size_t kMaxNames = 1024;
  PlyHeader header;
  if (!cursor.next_line() || cursor.token() != "ply") cursor.fail("not a PLY file: it must start with a line 'ply'");
  bool has_format = false;
  std::size_t names = 0;
  while (cursor.next_line()) {
    const std::string_view key = cursor.token();
    if (key == "comment" || key == "obj_info") continue;
    if (++names > kMaxNames) cursor.fail("more than " + std::to_string(kMaxNames) + " header lines");
    if (key == "end_header") {
      cursor.expect_line_end();
      if (!has_format) cursor.fail("the header has no format line; add 'format ascii 1.0' or a binary one");
      return header;
    }
    if (key == "format") {
      if (has_format) cursor.fail("a second format line; remove it");
      header.format = read_format(cursor);
      has_format = true;
    } else if (key == "element") {
      header.elements.push_back(read_element(cursor, header));
    } else if (key == "property") {
      if (header.elements.empty()) cursor.fail("a property before the first element");
      header.elements.back().properties.push_back(read_property(cursor, header.elements.back()));
    } else {
      cursor.fail("unknown header line '" + printable(key) + "'");
    }
    cursor.expect_line_end();
  }
  cursor.fail("the file ends within the header; 'end_header' is missing");
}

}  // namespace hemiray

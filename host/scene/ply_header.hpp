// The header of a PLY file: which elements follow, and how they are stored.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/scene/text_cursor.hpp"

namespace hemiray {

enum class PlyFormat { ascii, binary_little_endian, binary_big_endian };
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Size of one binary value [bytes].
std::size_t ply_type_size(PlyType type);
bool ply_is_integer(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  bool is_list = false;
  PlyType count_type = PlyType::uint8;  ///< of a list's length; an integer type
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::string place;  ///< of the header line that declares it
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
};

/// Reads the header up to and including `end_header`; the cursor stays on that line.
/// Throws InputError "file:line:column: ...".
PlyHeader read_ply_header(TextCursor& cursor);

}  // namespace hemiray

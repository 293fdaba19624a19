// Files made of named sections, each with a checksum; they appear whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/base/atomic_file.hpp"

namespace hemiray {

/// Layout: a first line "hemiray KIND VERSION\n"; sections: name (8 bytes, zeros behind it), size (8 bytes,
/// little-endian), bytes, SHA-256 of number, name, size and bytes; the last one is "end" and empty. So no section can
/// be changed, cut, left out or put elsewhere unnoticed.
struct SectionFileKind {
  std::string_view name;  ///< "solution"
  std::uint32_t version;
};

class SectionWriter {
 public:
  /// Throws as AtomicFile does; so do the others.
  SectionWriter(const std::filesystem::path& path, SectionFileKind kind);
  /// `name`: at most 8 characters.
  void add(std::string_view name, std::span<const std::uint8_t> bytes);
  /// Ends the file and gives it its name; the one that had it before is there until then.
  void commit();

 private:
  AtomicFile file_;
  std::uint64_t number_ = 0;
};

class SectionReader {
 public:
  /// Throws InputError for a file that is missing, of another kind or version; messages go on from the file's name.
  SectionReader(const std::filesystem::path& path, SectionFileKind kind);
  /// The next section, "end" last. Throws InputError where it is damaged or cut short.
  struct Section {
    std::string name;
    std::vector<std::uint8_t> bytes;
  };
  Section next();

 private:
  void read(void* to, std::size_t size);

  std::ifstream stream_;
  std::uint64_t left_ = 0;  ///< bytes
  std::uint64_t number_ = 0;
};

}  // namespace hemiray

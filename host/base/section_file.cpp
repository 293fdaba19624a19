#include "host/base/section_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

#include <fmt/format.h>

#include "host/base/error.hpp"
#include "host/base/sha256.hpp"

namespace hemiray {
namespace {

constexpr std::string_view kEnd = "end";
constexpr std::size_t kNameLength = 8, kLongestLine = 80;

std::array<std::uint8_t, 8> little_endian(std::uint64_t value) {
  std::array<std::uint8_t, 8> bytes{};
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(value);
    value >>= 8U;
  }
  return bytes;
}

std::uint64_t from_little_endian(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8U | bytes[i];
  return value;
}

// Name and size.
using Head = std::array<std::uint8_t, kNameLength + 8>;

Sha256::Digest digest_of(std::uint64_t number, const Head& head, std::span<const std::uint8_t> bytes) {
  Sha256 hash;
  hash.add(little_endian(number));
  hash.add(head);
  hash.add(bytes);
  return hash.digest();
}

[[noreturn]] void fail(const std::string& why) { throw InputError(why); }

std::string first_line(SectionFileKind kind) { return fmt::format("hemiray {} {}\n", kind.name, kind.version); }

}  // namespace

SectionWriter::SectionWriter(const std::filesystem::path& path, SectionFileKind kind) : file_(path) {
  const std::string line = first_line(kind);
  file_.write({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()});
}

void SectionWriter::add(std::string_view name, std::span<const std::uint8_t> bytes) {
  Head head{};
  std::copy(name.begin(), name.end(), head.begin());
  const auto size = little_endian(bytes.size());
  std::copy(size.begin(), size.end(), head.begin() + kNameLength);
  file_.write(head);
  file_.write(bytes);
  file_.write(digest_of(number_++, head, bytes));
}

void SectionWriter::commit() {
  add(kEnd, {});
  file_.commit();
}

SectionReader::SectionReader(const std::filesystem::path& path, SectionFileKind kind)
    : stream_(path, std::ios::binary) {
  std::error_code error;
  left_ = std::filesystem::file_size(path, error);
  if (error || !stream_) {
    fail("cannot be read: " + (error ? error.message() : std::string(std::strerror(errno))));
  }
  std::string line;
  for (char c = 0; c != '\n' && line.size() < kLongestLine && stream_.get(c);) line += c;
  const std::string ours = first_line(kind), begin = fmt::format("hemiray {} ", kind.name);
  if (!line.starts_with(begin)) fail(fmt::format("is no {} that hemiray saved", kind.name));
  if (line != ours) {
    fail(fmt::format("has version {} of its format, and this program reads version {}",
                     line.substr(begin.size(), line.size() - begin.size() - 1), kind.version));
  }
  left_ -= line.size();
}

void SectionReader::read(void* to, std::size_t size) {
  if (size > left_) fail("is cut short");
  left_ -= size;
  if (size > 0 && !stream_.read(static_cast<char*>(to), static_cast<std::streamsize>(size))) fail("cannot be read");
}

SectionReader::Section SectionReader::next() {
  Head head{};
  read(head.data(), head.size());
  Section section;
  section.name.assign(head.begin(), std::find(head.begin(), head.begin() + kNameLength, 0));
  const std::uint64_t size = from_little_endian(std::span(head).subspan(kNameLength));
  if (size > left_) fail("is cut short or damaged");  // before that much is allocated
  section.bytes.resize(static_cast<std::size_t>(size));
  read(section.bytes.data(), section.bytes.size());
  Sha256::Digest digest{};
  read(digest.data(), digest.size());
  if (digest != digest_of(number_++, head, section.bytes)) fail("is damaged: a checksum does not fit");
  if (section.name == kEnd && left_ > 0) fail("is damaged: it goes on behind its end");
  return section;
}

}  // namespace hemiray

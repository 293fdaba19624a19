// Decoding of URIs.
#include "host/scene/data_uri.hpp"

#include <algorithm>
#include <cctype>

#include "host/base/error.hpp"
#include "host/base/read_file.hpp"
#include "host/base/spelling.hpp"

namespace hemiray {

namespace {

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  if (c == '/') return 63;
  return -1;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string percent_bytes(std::string_view text, const std::string& place) {
  std::string bytes;
  bytes.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      bytes += text[i];
      continue;
    }
    const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
    const int low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
    if (high < 0 || low < 0) throw InputError(place, "malformed %XX sequence in the URI");
    bytes += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return bytes;
}

bool has_scheme(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  if (colon == std::string_view::npos || colon == 0) return false;
  return std::all_of(uri.begin(), uri.begin() + static_cast<std::ptrdiff_t>(colon), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '+' || c == '-' || c == '.';
  });
}

}  // namespace

std::vector<std::uint8_t> decode_base64(std::string_view text, const std::string& place) {
  std::size_t padding = 0;
  while (padding < 2 && text.ends_with('=')) {
    text.remove_suffix(1);
    ++padding;
  }
  if (text.size() % 4 == 1 || (padding > 0 && (text.size() + padding) % 4 != 0)) {
    throw InputError(place, "base64 data are truncated");
  }
  std::vector<std::uint8_t> bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int count = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int digit = base64_digit(text[i]);
    if (digit < 0) {
      throw InputError(place, "'" + printable(text.substr(i, 1)) + "' at byte " + std::to_string(i) +
                                  " of the base64 data is not a base64 digit");
    }
    bits = (bits << 6 | static_cast<std::uint32_t>(digit)) & 0xFFFFFFU;
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes.push_back(static_cast<std::uint8_t>(bits >> count));
    }
  }
  return bytes;
}

std::string decode_percent(std::string_view text, const std::string& place) {
  std::string decoded = percent_bytes(text, place);
  if (decoded.find('\0') != std::string::npos) throw InputError(place, "the URI holds a NUL byte");
  return decoded;
}

bool is_data_uri(std::string_view uri) {
  return uri.size() >= 5 && (uri.starts_with("data:") || uri.starts_with("DATA:"));
}

std::vector<std::uint8_t> decode_data_uri(std::string_view uri, const std::string& place) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos) throw InputError(place, "the data: URI has no comma before its data");
  const std::string_view head = uri.substr(0, comma);
  const std::string_view payload = uri.substr(comma + 1);
  if (head.ends_with(";base64")) return decode_base64(payload, place);
  const std::string bytes = percent_bytes(payload, place);
  return {bytes.begin(), bytes.end()};
}

std::string file_of_uri(std::string_view uri, const std::string& place) {
  if (has_scheme(uri)) {
    throw InputError(place, "'" + printable(uri) +
                                "': only data: URIs and relative file names are read; save the file beside the scene");
  }
  const std::string name = decode_percent(uri, place);
  if (name.empty()) throw InputError(place, "the URI is empty");
  if (is_absolute_name(name)) {
    throw InputError(place, "'" + printable(name) + "' is an absolute path; name the file relative to the scene");
  }
  return name;
}

}  // namespace hemiray

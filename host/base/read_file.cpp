// Whole files into memory.
#include "host/base/read_file.hpp"

#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "host/base/error.hpp"

namespace hemiray {

namespace {

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

}  // namespace

std::vector<std::uint8_t> read_file(const std::filesystem::path& file, std::uint64_t limit) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    throw InputError(file.string(), "no such file; check the path");
  }
  if (std::filesystem::is_directory(status)) throw InputError(file.string(), "is a directory; name a file in it");

  const std::unique_ptr<std::FILE, FileCloser> stream(std::fopen(file.c_str(), "rb"));
  if (!stream) throw InputError(file.string(), std::string("cannot be opened: ") + std::strerror(errno));

  std::vector<std::uint8_t> bytes;
  const auto too_long = [&] {
    return InputError(file.string(), "is longer than the limit of " + std::to_string(limit) + " bytes");
  };
  if (std::filesystem::is_regular_file(status)) {
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (!error && size > limit) throw too_long();
    if (!error) bytes.reserve(static_cast<std::size_t>(size));
  }
  std::vector<std::uint8_t> chunk(std::size_t{1} << 18);
  for (;;) {
    const std::size_t got = std::fread(chunk.data(), 1, chunk.size(), stream.get());
    bytes.insert(bytes.end(), chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(got));
    if (bytes.size() > limit) throw too_long();
    if (got < chunk.size()) {
      if (std::ferror(stream.get())) {
        throw InputError(file.string(), std::string("cannot be read: ") + std::strerror(errno));
      }
      return bytes;
    }
  }
}

FileResolver folder_resolver(const std::filesystem::path& folder) {
  return [folder](const std::string& name) -> std::optional<std::vector<std::uint8_t>> {
    const std::filesystem::path file = folder / name;
    std::error_code error;
    const std::filesystem::file_type type = std::filesystem::status(file, error).type();
    if (type == std::filesystem::file_type::not_found) return std::nullopt;
    return read_file(file);
  };
}

bool is_absolute_name(const std::string& name) {
  if (name.empty()) return false;
  if (name[0] == '/' || name[0] == '\\') return true;
  return name.size() >= 2 && std::isalpha(static_cast<unsigned char>(name[0])) != 0 && name[1] == ':';
}

}  // namespace hemiray

// Whole files into memory, and the way readers get at the files that lie beside the one they read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hemiray {

/// Scene, mesh and texture files above this size [bytes] are refused.
inline constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 32;

/// All bytes of `file`. Throws InputError if it is missing, a directory, unreadable or longer than `limit` bytes.
std::vector<std::uint8_t> read_file(const std::filesystem::path& file, std::uint64_t limit = kMaxFileBytes);

/// Gives the bytes of a file named relative to the one being read, or nothing if there is no such file. Tests and
/// fuzzers answer from memory.
using FileResolver = std::function<std::optional<std::vector<std::uint8_t>>(const std::string& name)>;

/// Resolves names against `folder` on disk. The resolver throws InputError for a file that is there but unreadable.
FileResolver folder_resolver(const std::filesystem::path& folder);

/// True for names that do not lie below or beside a file: "/a", "C:\a", "\\host\a".
bool is_absolute_name(const std::string& name);

}  // namespace hemiray

// Compiled programs on disk, so that a second run need not compile.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/gpu/device.hpp"

namespace hemiray {

/// What a compiled program is: the device's binary and, for every kernel, its argument names in order (drivers do not
/// tell them for programs made from binaries).
struct CompiledProgram {
  std::vector<unsigned char> binary;
  std::map<std::string, std::vector<std::string>> argument_names;
};

/// SHA-256 of source text, options, device, platform and driver, in hexadecimal: whatever changes one of them makes
/// another entry.
std::string program_key(const std::string& source, const std::string& options, const DeviceInfo& device);

/// The folder: HEMIRAY_CACHE_DIR, else $XDG_CACHE_HOME/hemiray, else ~/.cache/hemiray; empty (no cache) if none is set.
std::filesystem::path program_cache_folder();

/// The entry, or nothing if it is absent, damaged or not ours: the caller then compiles.
std::optional<CompiledProgram> load_program(const std::filesystem::path& folder, const std::string& key);

/// Writes the entry under a temporary name and renames it, so that writers may race. A cache that cannot be written is
/// no error: false.
bool store_program(const std::filesystem::path& folder, const std::string& key, const CompiledProgram& program);

}  // namespace hemiray

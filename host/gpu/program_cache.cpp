#include "host/gpu/program_cache.hpp"

#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/base/sha256.hpp"

namespace hemiray {
namespace {

// Layout of an entry: this line, SHA-256 of key and rest (hex), newline, JSON of argument names, newline, binary.
constexpr std::string_view kMagic = "hemiray program 1\n";
constexpr std::size_t kHashLength = 64;

// Ties an entry to its key, so that a renamed one is refused.
std::string entry_hash(const std::string& key, std::string_view body) { return sha256(key + std::string(body)) + '\n'; }

}  // namespace

std::string program_key(const std::string& source, const std::string& options, const DeviceInfo& device) {
  std::string text;
  for (const std::string* part :
       {&source, &options, &device.name, &device.version, &device.driver, &device.platform, &device.platform_version}) {
    text += std::to_string(part->size()) + ":" + *part;  // lengths keep ("ab","c") apart from ("a","bc")
  }
  return sha256(text);
}

std::filesystem::path program_cache_folder() {
  if (const char* own = std::getenv("HEMIRAY_CACHE_DIR")) return own;
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache == '/') {
    return std::filesystem::path(cache) / "hemiray";
  }
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/') {
    return std::filesystem::path(home) / ".cache" / "hemiray";
  }
  return {};
}

std::optional<CompiledProgram> load_program(const std::filesystem::path& folder, const std::string& key) {
  if (folder.empty()) return std::nullopt;
  const std::filesystem::path path = folder / (key + ".bin");
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  const std::string content{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const std::string_view view = content;
  const std::size_t body_start = kMagic.size() + kHashLength + 1;
  if (view.size() <= body_start || view.substr(0, kMagic.size()) != kMagic) return std::nullopt;
  const std::string_view body = view.substr(body_start);
  if (view.substr(kMagic.size(), kHashLength + 1) != entry_hash(key, body)) return std::nullopt;
  const std::size_t newline = body.find('\n');
  if (newline == std::string_view::npos) return std::nullopt;
  CompiledProgram program;
  try {
    program.argument_names =
        nlohmann::json::parse(body.substr(0, newline)).get<std::map<std::string, std::vector<std::string>>>();
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
  program.binary.assign(body.begin() + static_cast<std::ptrdiff_t>(newline) + 1, body.end());
  return program;
}

bool store_program(const std::filesystem::path& folder, const std::string& key, const CompiledProgram& program) {
  if (folder.empty()) return false;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::string body = nlohmann::json(program.argument_names).dump() + "\n";
  body.append(program.binary.begin(), program.binary.end());
  static std::atomic<unsigned> writes = 0;  // threads of one process race as well
  const std::filesystem::path temporary = folder / fmt::format("{}.{}.{}.tmp", key, getpid(), writes++);
  {
    std::ofstream file(temporary, std::ios::binary);
    file << kMagic << entry_hash(key, body) << body;
    if (!file.flush()) {
      std::filesystem::remove(temporary, error);
      return false;
    }
  }
  std::filesystem::rename(temporary, folder / (key + ".bin"), error);
  if (!error) return true;
  std::filesystem::remove(temporary, error);
  return false;
}

}  // namespace hemiray

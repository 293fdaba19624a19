// A folder for one test's files.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace hemiray::test {

/// A fresh, empty folder under the system's temporary folder; removed with everything in it on destruction.
class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// The path of `name` in the folder.
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  /// Writes `content` (any bytes) to `name` in the folder and returns its path. Throws std::runtime_error on failure.
  std::filesystem::path write(const std::string& name, std::string_view content) const;

 private:
  std::filesystem::path path_;
};

/// All bytes of a file. Throws std::runtime_error on failure.
[[nodiscard]] std::string read_whole_file(const std::filesystem::path& path);

}  // namespace hemiray::test

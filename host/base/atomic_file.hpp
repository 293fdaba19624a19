// Output files that appear whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

namespace hemiray {

/// A hidden temporary (".hemiray-<process>-<n>.tmp") in the folder of `path`, which commit() syncs to disk and renames
/// to `path`: that name shows the old content or the new, never a part. A symbolic link is followed; the permissions of
/// a file that is replaced are kept. Without commit() the temporary is removed and `path` is left as it was. Members
/// throw InputError where the name cannot be written (as check_writable), DeviceError where the disk is full or fails.
class AtomicFile {
 public:
  explicit AtomicFile(const std::filesystem::path& path);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();
  void write(std::span<const std::uint8_t> bytes);
  /// To be called once, last.
  void commit();

 private:
  std::filesystem::path path_;  ///< as the user wrote it, for messages
  std::filesystem::path target_, name_;
  int descriptor_ = -1;
  bool renamed_ = false;
};

/// All of a file at once.
void write_file_atomically(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);
void write_file_atomically(const std::filesystem::path& path, std::string_view text);

/// To be called before long work that ends in write_file_atomically(path): throws what that would throw for a missing
/// or read-only folder, a folder or device in place of the file, or a read-only file. Leaves nothing behind.
void check_writable(const std::filesystem::path& path);

/// Whether both names mean one file, there or not, by links and folders ("a", "./a").
bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace hemiray

// POSIX calls rather than streams: fsync, exclusive creation and the exact errno are needed.
#include "host/base/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include "host/base/error.hpp"

namespace hemiray {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxLinks = 40;      // as the kernel's own limit
constexpr int kMaxAttempts = 100;  // temporary names that are taken, by processes that were killed
constexpr mode_t kNewFileMode = 0666;
constexpr mode_t kPermissionBits = 07777;
constexpr std::size_t kWriteChunk = std::size_t{1} << 26U;

// What the caller can mend by choosing another name is an input error; the rest is the system's.
[[noreturn]] void throw_system_error(const fs::path& path, const std::string& doing, int error) {
  const std::string reason = doing + ": " + std::strerror(error);
  switch (error) {
    case EACCES:
    case EPERM:
    case EROFS:
    case ENOENT:
    case ENOTDIR:
    case EISDIR:
    case ENAMETOOLONG:
    case ELOOP:
      throw InputError(path.string(), reason + "; choose another output file");
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      throw DeviceError(path.string() + ": " + reason + "; free some space or choose another disk");
    default:
      throw DeviceError(path.string() + ": " + reason);
  }
}

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

// The file that `path` names after following links, also where the last one points to nothing yet.
fs::path follow_links(const fs::path& path) {
  fs::path target = path;
  for (int i = 0; i < kMaxLinks; ++i) {
    std::error_code error;
    if (!fs::is_symlink(fs::symlink_status(target, error))) return target;
    const fs::path link = fs::read_symlink(target, error);
    if (error) throw_system_error(path, "cannot follow the link", error.value());
    target = link.is_absolute() ? link : folder_of(target) / link;
  }
  throw_system_error(path, "cannot follow the link", ELOOP);
}

/// Where a file goes and what stands there now.
struct Destination {
  fs::path file;
  bool exists = false;
  mode_t mode = 0;
};

Destination examine(const fs::path& path) {
  if (path.empty()) throw InputError("the name of the output file is empty");
  if (!path.has_filename()) throw InputError(path.string(), "names a folder; add a file name");
  Destination destination{follow_links(path), false, 0};
  const fs::path folder = folder_of(destination.file);
  std::error_code ignored;
  if (!fs::exists(folder, ignored)) {
    throw InputError(path.string(), "the folder " + folder.string() + " does not exist; create it first");
  }
  struct stat status {};
  if (stat(destination.file.c_str(), &status) != 0) {
    if (errno != ENOENT) throw_system_error(path, "cannot write", errno);
    return destination;
  }
  if (S_ISDIR(status.st_mode)) throw InputError(path.string(), "is a folder; name a file");
  // Renaming over a device would replace the device.
  if (!S_ISREG(status.st_mode)) throw InputError(path.string(), "is not a regular file; name another output file");
  if (access(destination.file.c_str(), W_OK) != 0) throw_system_error(path, "cannot replace the file", errno);
  destination.exists = true;
  destination.mode = status.st_mode & kPermissionBits;
  return destination;
}

}  // namespace

AtomicFile::AtomicFile(const fs::path& path) : path_(path) {
  const Destination destination = examine(path);
  target_ = destination.file;
  static std::atomic<unsigned> counter{0};
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    const std::string name = ".hemiray-" + std::to_string(getpid()) + "-" + std::to_string(counter++) + ".tmp";
    name_ = folder_of(target_) / name;
    descriptor_ = open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kNewFileMode);
    if (descriptor_ >= 0) break;
    if (errno != EEXIST) throw_system_error(path, "cannot write in its folder", errno);
  }
  if (descriptor_ < 0) throw_system_error(path, "cannot write in its folder", EEXIST);
  if (destination.exists) static_cast<void>(fchmod(descriptor_, destination.mode));  // not all file systems can
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) close(descriptor_);
  if (!renamed_) unlink(name_.c_str());
}

void AtomicFile::write(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), std::min(bytes.size(), kWriteChunk));
    if (count < 0) {
      if (errno == EINTR) continue;
      throw_system_error(path_, "cannot write", errno);
    }
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

void AtomicFile::commit() {
  // EINVAL: the file system has nothing to sync.
  if (fsync(descriptor_) != 0 && errno != EINVAL) throw_system_error(path_, "cannot write", errno);
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (close(descriptor) != 0 && errno != EINTR) throw_system_error(path_, "cannot write", errno);
  if (std::rename(name_.c_str(), target_.c_str()) != 0) throw_system_error(path_, "cannot rename", errno);
  renamed_ = true;
}

void write_file_atomically(const fs::path& path, std::span<const std::uint8_t> bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

void write_file_atomically(const fs::path& path, std::string_view text) {
  write_file_atomically(path, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

// Permission bits do not tell everything (read-only mounts, root, access lists): try it.
void check_writable(const fs::path& path) { const AtomicFile probe(path); }

bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  const auto resolved = [&ignored](const fs::path& path) {
    return fs::weakly_canonical(fs::absolute(path, ignored), ignored);
  };
  return resolved(a) == resolved(b);
}

}  // namespace hemiray

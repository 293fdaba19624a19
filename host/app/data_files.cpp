#include "host/app/data_files.hpp"

#include <system_error>

#include "host/base/error.hpp"

namespace hemiray::app {

namespace fs = std::filesystem;

fs::path data_file(const std::string& name) {
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  const fs::path installed = (program.parent_path().parent_path() / HR_DATA_DIR / "hemiray" / name).lexically_normal();
  if (!program.empty() && fs::is_regular_file(installed, ignored)) return installed;
  const fs::path in_source = fs::path(HR_SOURCE_DATA_DIR) / name;
  if (fs::is_regular_file(in_source, ignored)) return in_source;
  throw InputError(name,
                   "neither at " + installed.string() + " nor at " + in_source.string() + "; install hemiray anew");
}

}  // namespace hemiray::app

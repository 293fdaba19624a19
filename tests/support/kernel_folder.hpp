// Kernel sources of a test's own, which HEMIRAY_KERNEL_DIR puts before the embedded ones.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "tests/support/temp_folder.hpp"

namespace hemiray::test {

/// Sets an environment variable (or removes it, with nullopt) for as long as it lives.
class ScopedVariable {
 public:
  ScopedVariable(std::string name, const std::optional<std::string>& value) : name_(std::move(name)) {
    if (const char* old = getenv(name_.c_str())) old_ = old;
    set(value);
  }
  ~ScopedVariable() { set(old_); }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;

 private:
  void set(const std::optional<std::string>& value) const {
    if (value) {
      setenv(name_.c_str(), value->c_str(), 1);
    } else {
      unsetenv(name_.c_str());
    }
  }

  std::string name_;
  std::optional<std::string> old_;
};

/// A folder that HEMIRAY_KERNEL_DIR names while it lives. What an outer HEMIRAY_KERNEL_DIR holds is in it too, so that
/// probes test the kernels under experiment.
class KernelFolder {
 public:
  KernelFolder() : variable_("HEMIRAY_KERNEL_DIR", prepare(folder_)) {}
  KernelFolder(const std::string& name, std::string_view text) : KernelFolder() { write(name, text); }

  void write(const std::string& name, std::string_view text) const { folder_.write(name, text); }

 private:
  static std::string prepare(const TempFolder& folder) {
    if (const char* outer = getenv("HEMIRAY_KERNEL_DIR")) {
      std::filesystem::copy(outer, folder.path(), std::filesystem::copy_options::recursive);
    }
    return folder.path().string();
  }

  TempFolder folder_;
  ScopedVariable variable_;
};

}  // namespace hemiray::test

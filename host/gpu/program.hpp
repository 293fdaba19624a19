// A compiled set of kernels, and their launch with arguments by name.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "host/gpu/buffer.hpp"
#include "host/gpu/context.hpp"
#include "host/gpu/program_cache.hpp"

namespace hemiray {

/// One kernel argument: a buffer's handle or a plain value, with the name it has in the kernel.
struct Argument {
  static constexpr std::size_t kMaxSize = 256;
  std::string name;
  std::size_t size = 0;
  std::array<std::byte, kMaxSize> value{};
};
using Arguments = std::vector<Argument>;

template <typename T>
Argument arg(const char* name, const T& value) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= Argument::kMaxSize);
  Argument argument{name, sizeof(T), {}};
  std::memcpy(argument.value.data(), &value, sizeof(T));
  return argument;
}
template <typename T>
Argument arg(const char* name, const Buffer<T>& buffer) {
  return arg(name, buffer.handle()());
}

/// A kernel with the names of its arguments.
struct Kernel {
  std::string name;
  cl::Kernel handle;
  std::vector<std::string> argument_names;
  std::size_t local_size = 0;  ///< compiled in; 0: a chunked kernel, any
  bool launched = false;
};

/// How a program is compiled.
struct ProgramOptions {
  std::uint32_t features = 0;     ///< effect mask, HR_FEATURES
  bool strict = false;            ///< same bits from every engine: no contraction, own elementary functions
  std::string defines{};          ///< more options, "-DNAME=value ..."
  bool double_precision = false;  ///< `real` is double; for kernels without explicit vectors
};

/// What compiling gives, for all programs of a context that have the same text and options.
struct BuiltProgram {
  cl::Program handle;
  std::map<std::string, Kernel> kernels;
};

/// Kernels from one or more files of kernels/, compiled for the context's device, or taken from the cache: the
/// context's own of what it has compiled before, and the one on disk.
class Program {
 public:
  /// Throws DeviceError with the build log's first error, and where the whole log is, if the kernels do not compile.
  Program(Context& context, std::string name, const std::vector<std::string>& files, const ProgramOptions& options);

  /// The kernel of that name; throws std::logic_error if there is none.
  Kernel& kernel(const std::string& name);

  [[nodiscard]] bool from_cache() const { return from_cache_; }
  [[nodiscard]] double build_ms() const { return build_ms_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::size_t kernel_count() const { return built_->kernels.size(); }

 private:
  bool build_from_cache(const std::string& options);
  void build_from_source(const std::string& options);
  void save_to_cache() const;
  void add_kernels(const std::map<std::string, std::vector<std::string>>* known_names);

  Context* context_;
  std::string name_;
  std::string source_;
  std::string key_;
  std::shared_ptr<BuiltProgram> built_;
  bool from_cache_ = false;
  double build_ms_ = 0.0;
};

/// Queues `items` work-items of the kernel (rounded up to its local size). The arguments must be exactly the kernel's;
/// anything else is a std::logic_error. The time is profiled under the kernel's name.
void launch(Context& context, Kernel& kernel, std::uint64_t items, const Arguments& arguments);

template <typename... Args>
Arguments arguments(const Args&... parts) {
  Arguments all;
  const auto add = [&all](const auto& part) {
    if constexpr (std::is_same_v<std::decay_t<decltype(part)>, Argument>) {
      all.push_back(part);
    } else {
      all.insert(all.end(), part.begin(), part.end());
    }
  };
  (add(parts), ...);
  return all;
}

}  // namespace hemiray

#include "host/gpu/program.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include "host/base/atomic_file.hpp"
#include "host/base/clock.hpp"
#include "host/gpu/cl_error.hpp"
#include "host/gpu/source_store.hpp"

namespace hemiray {
namespace {

std::string compile_options(const DeviceInfo& device, const DeviceProfile& profile, const ProgramOptions& options) {
  std::string text = fmt::format("-cl-std=CL1.2 -cl-kernel-arg-info -DHR_FEATURES={:#x}u -DHR_LOCAL_SIZE={}",
                                 options.features, profile.local_size);
  if (device.kind == DeviceKind::cpu) text += " -DHR_ON_CPU=1";
  if (!options.defines.empty()) text += " " + options.defines;
  if (options.double_precision) {
    if (!device.has_fp64) {
      throw DeviceError(device.name + " has no double precision (cl_khr_fp64); take --precision single");
    }
    text += " -DHR_DOUBLE=1";
  }
  if (options.strict) {
    text += " -DHR_STRICT=1";
    if (device.rounds_divide_correctly) text += " -DHR_ROUNDS_DIVIDE=1 -cl-fp32-correctly-rounded-divide-sqrt";
  }
  return text;
}

// Intel's runtime for CPUs puts several work-items into the lanes of one vector unless a kernel says that it has
// vectors of its own. With 2026.2 paths got lost in loops that lanes leave at different times, the wavefront took twice
// as long, and compiling four times as long. The hint is for programs whose platform was loaded before
// switch_off_vectorizer() (device.cpp); it does not reach all of the compiler.
std::string source_prelude(const DeviceInfo& device) {
  const bool is_intel_cpu = device.kind == DeviceKind::cpu && device.platform.rfind("Intel(R) OpenCL", 0) == 0;
  return is_intel_cpu ? "// vectorizer off\n#define kernel __kernel __attribute__((vec_type_hint(float4)))\n" : "";
}

std::string trimmed_name(std::string name) {
  name.erase(std::find(name.begin(), name.end(), '\0'), name.end());
  return name;
}

std::vector<std::string> query_argument_names(const cl::Kernel& kernel) {
  std::vector<std::string> names;
  const cl_uint count = kernel.getInfo<CL_KERNEL_NUM_ARGS>();
  for (cl_uint i = 0; i < count; i++) names.push_back(trimmed_name(kernel.getArgInfo<CL_KERNEL_ARG_NAME>(i)));
  return names;
}

// The first line that names an error, else the first that says anything.
std::string first_error(const std::string& log) {
  std::istringstream lines(log);
  std::string first;
  for (std::string line; std::getline(lines, line);) {
    if (line.find("error") != std::string::npos) return line;
    if (first.empty()) first = line;
  }
  return first.empty() ? "the compiler says nothing" : first;
}

// A build log has many lines, a message one: the whole log goes beside the cached programs.
std::string keep_log(const std::string& name, const std::string& log) {
  try {
    const std::filesystem::path folder = program_cache_folder();
    if (folder.empty()) return "";
    std::filesystem::create_directories(folder);
    const std::filesystem::path file = folder / (name + "_build.log");
    write_file_atomically(file, log);
    return "; the whole log is in " + file.string();
  } catch (const std::exception&) {
    return "";  // the error itself matters more
  }
}

void dump_source(const std::string& name, const std::string& source) {
  const char* folder = std::getenv("HEMIRAY_DUMP_KERNELS");
  if (folder == nullptr || *folder == '\0') return;
  std::error_code error;  // shows as a failure to write
  std::filesystem::create_directories(folder, error);
  std::ofstream file(fmt::format("{}/{}.cl", folder, name), std::ios::binary);
  if (!(file << source)) throw InputError("--dump-kernels", fmt::format("cannot write to {}", folder));
}

}  // namespace

Program::Program(Context& context, std::string name, const std::vector<std::string>& files,
                 const ProgramOptions& options)
    : context_(&context), name_(std::move(name)), source_(flatten_kernels(files)) {
  const double start_us = context.profiler().now_us();
  const double start = steady_ms();
  const std::string text = compile_options(context.device(), context.profile(), options);
  key_ = program_key(source_prelude(context.device()) + source_, text, context.device());
  dump_source(name_, source_);
  std::shared_ptr<BuiltProgram>& known = context.built_program(key_);
  from_cache_ = known != nullptr;
  built_ = from_cache_ ? known : std::make_shared<BuiltProgram>();
  if (!from_cache_ && !build_from_cache(text)) build_from_source(text);
  known = built_;
  build_ms_ = steady_ms() - start;
  context.account_build(build_ms_);
  context.profiler().record_host(fmt::format("compile {}{}", name_, from_cache_ ? " (cached)" : ""), "compile",
                                 start_us, context.profiler().now_us() - start_us);
}

bool Program::build_from_cache(const std::string& options) {
  const std::optional<CompiledProgram> cached = load_program(program_cache_folder(), key_);
  if (!cached) return false;
  try {
    built_->handle = cl::Program(context_->handle(), {context_->device().handle}, {cached->binary});
    built_->handle.build({context_->device().handle}, options.c_str());
    add_kernels(&cached->argument_names);
  } catch (const cl::Error&) {
    built_->kernels.clear();  // an entry the driver does not take: compile instead
    return false;
  } catch (const std::out_of_range&) {
    built_->kernels.clear();  // an entry that lacks a kernel
    return false;
  }
  from_cache_ = true;
  return true;
}

void Program::build_from_source(const std::string& options) {
  cl_guard("compiling kernels '" + name_ + "'",
           [&] { built_->handle = cl::Program(context_->handle(), source_prelude(context_->device()) + source_); });
  try {
    built_->handle.build({context_->device().handle}, options.c_str());
  } catch (const cl::Error& error) {
    const std::string log = name_sources(built_->handle.getBuildInfo<CL_PROGRAM_BUILD_LOG>(context_->device().handle),
                                         source_prelude(context_->device()) + source_);
    throw DeviceError(fmt::format("compiling kernels '{}' for {} with '{}': {}; {}{}", name_, context_->device().name,
                                  options, describe_cl_error(error.err()), first_error(log), keep_log(name_, log)));
  }
  cl_guard("reading the kernels of '" + name_ + "'", [&] { add_kernels(nullptr); });
  if (!context_->profile().has_own_cache) save_to_cache();
}

void Program::add_kernels(const std::map<std::string, std::vector<std::string>>* known_names) {
  std::vector<cl::Kernel> handles;
  built_->handle.createKernels(&handles);
  for (const cl::Kernel& handle : handles) {
    Kernel kernel;
    kernel.handle = handle;
    kernel.name = trimmed_name(handle.getInfo<CL_KERNEL_FUNCTION_NAME>());
    kernel.argument_names = known_names != nullptr ? known_names->at(kernel.name) : query_argument_names(handle);
    kernel.local_size = handle.getWorkGroupInfo<CL_KERNEL_COMPILE_WORK_GROUP_SIZE>(context_->device().handle)[0];
    built_->kernels.emplace(kernel.name, std::move(kernel));
  }
}

Kernel& Program::kernel(const std::string& name) {
  const auto found = built_->kernels.find(name);
  if (found == built_->kernels.end()) {
    throw std::logic_error(fmt::format("program '{}' has no kernel '{}'", name_, name));
  }
  return found->second;
}

void Program::save_to_cache() const {
  CompiledProgram compiled;
  try {
    const auto binaries = built_->handle.getInfo<CL_PROGRAM_BINARIES>();
    if (binaries.empty() || binaries.front().empty()) return;
    compiled.binary = binaries.front();
  } catch (const cl::Error&) {
    return;  // a driver without binaries: every run compiles
  }
  for (const auto& [name, kernel] : built_->kernels) compiled.argument_names[name] = kernel.argument_names;
  store_program(program_cache_folder(), key_, compiled);
}

// Some drivers compile a kernel when it first runs: what its first launch takes beyond the run itself is compilation.
static void note_first_launch(Context& context, Kernel& kernel, const cl::Event& event, double start_us) {
  context.queue().finish();
  const double wall_us = context.profiler().now_us() - start_us;
  const double run_us = static_cast<double>(event.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
                                            event.getProfilingInfo<CL_PROFILING_COMMAND_START>()) *
                        1e-3;
  const double compile_us = std::max(wall_us - run_us, 0.0);
  context.account_first_launch(compile_us * 1e-3);
  context.profiler().record_host("first launch " + kernel.name, "compile", start_us, compile_us);
  kernel.launched = true;
}

void launch(Context& context, Kernel& kernel, std::uint64_t items, const Arguments& arguments) {
  if (arguments.size() != kernel.argument_names.size()) {
    throw std::logic_error(fmt::format("kernel {} takes {} arguments, {} given", kernel.name,
                                       kernel.argument_names.size(), arguments.size()));
  }
  for (cl_uint i = 0; i < kernel.argument_names.size(); i++) {
    const std::string& name = kernel.argument_names[i];
    const auto found =
        std::find_if(arguments.begin(), arguments.end(), [&name](const Argument& a) { return a.name == name; });
    if (found == arguments.end()) {
      throw std::logic_error(fmt::format("kernel {}: argument '{}' is missing", kernel.name, name));
    }
    cl_guard(fmt::format("kernel {}, argument '{}'", kernel.name, name),
             [&] { kernel.handle.setArg(i, found->size, found->value.data()); });
  }
  const DeviceProfile& profile = context.profile();
  const std::size_t chunk_local = items % profile.chunk_local_size == 0 ? profile.chunk_local_size : 1;
  const std::size_t local = kernel.local_size != 0 ? kernel.local_size : chunk_local;
  const std::size_t global = (items + local - 1) / local * local;
  cl_guard("launching kernel " + kernel.name, [&] {
    if (!kernel.launched) context.queue().finish();
    cl::Event event;
    const double start_us = context.profiler().now_us();
    context.queue().enqueueNDRangeKernel(kernel.handle, cl::NullRange, cl::NDRange(global), cl::NDRange(local), nullptr,
                                         &event);
    if (!kernel.launched) note_first_launch(context, kernel, event, start_us);
    context.profiler().record(kernel.name, "kernel", items, event);
  });
  if (context.profiler().has_pending()) context.finish();
}

}  // namespace hemiray

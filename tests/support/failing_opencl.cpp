// A device that breaks: preloaded (LD_PRELOAD) into the program under test, it makes launches of one kernel fail as a
// driver would. HR_FAIL_KERNEL names the kernel; HR_FAIL_LAUNCH says which of its launches fails on a queue, counted
// from 1 (later ones fail, too); HR_FAIL_QUEUES how many queues break: those that come so far first.
#include <dlfcn.h>

#include <cstddef>
#include <cstdlib>
#include <map>
#include <mutex>
#include <set>
#include <string>

namespace {

// From OpenCL's headers, which only host/gpu includes.
constexpr int kOutOfResources = -5;
constexpr unsigned kKernelFunctionName = 0x1190;

template <typename Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

std::string name_of(void* kernel) {
  using GetInfo = int (*)(void*, unsigned, std::size_t, void*, std::size_t*);
  static const auto get_info = real<GetInfo>("clGetKernelInfo");
  char name[256] = "";
  get_info(kernel, kKernelFunctionName, sizeof(name) - 1, name, nullptr);
  return name;
}

int number(const char* variable) {
  const char* text = std::getenv(variable);
  return text != nullptr ? std::atoi(text) : 0;
}

bool fails(void* queue, void* kernel) {
  static std::mutex mutex;
  static std::map<void*, int> launches;
  static std::set<void*> broken;
  const char* wanted = std::getenv("HR_FAIL_KERNEL");
  if (wanted == nullptr || name_of(kernel) != wanted) return false;
  const std::lock_guard lock(mutex);
  if (++launches[queue] < number("HR_FAIL_LAUNCH")) return false;
  if (static_cast<int>(broken.size()) < number("HR_FAIL_QUEUES")) broken.insert(queue);
  return broken.count(queue) > 0;
}

}  // namespace

extern "C" int clEnqueueNDRangeKernel(void* queue, void* kernel, unsigned dimensions, const std::size_t* offset,
                                      const std::size_t* global, const std::size_t* local, unsigned waits,
                                      void* const* wait_list, void** event) {
  using Enqueue = int (*)(void*, void*, unsigned, const std::size_t*, const std::size_t*, const std::size_t*, unsigned,
                          void* const*, void**);
  static const auto enqueue = real<Enqueue>("clEnqueueNDRangeKernel");
  if (fails(queue, kernel)) return kOutOfResources;
  return enqueue(queue, kernel, dimensions, offset, global, local, waits, wait_list, event);
}

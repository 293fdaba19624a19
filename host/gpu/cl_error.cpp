#include "host/gpu/cl_error.hpp"

#include <array>

#include <fmt/format.h>

namespace hemiray {
namespace {

struct ErrorText {
  int code;
  const char* name;
  const char* meaning;
};

constexpr std::array kErrors = {
    ErrorText{-1, "CL_DEVICE_NOT_FOUND", "no such device"},
    ErrorText{-2, "CL_DEVICE_NOT_AVAILABLE", "the device is not available"},
    ErrorText{-3, "CL_COMPILER_NOT_AVAILABLE", "the driver has no compiler"},
    ErrorText{-4, "CL_MEM_OBJECT_ALLOCATION_FAILURE", "the device could not allocate the memory"},
    ErrorText{-5, "CL_OUT_OF_RESOURCES", "the device ran out of resources, or a kernel touched memory it must not"},
    ErrorText{-6, "CL_OUT_OF_HOST_MEMORY", "the host ran out of memory"},
    ErrorText{-7, "CL_PROFILING_INFO_NOT_AVAILABLE", "no timings for this command"},
    ErrorText{-11, "CL_BUILD_PROGRAM_FAILURE", "the kernels do not compile on this device"},
    ErrorText{-14, "CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST", "an earlier command failed"},
    ErrorText{-19, "CL_KERNEL_ARG_INFO_NOT_AVAILABLE", "the driver does not tell argument names"},
    ErrorText{-30, "CL_INVALID_VALUE", "an argument of the call is not valid"},
    ErrorText{-33, "CL_INVALID_DEVICE", "the device is not valid"},
    ErrorText{-34, "CL_INVALID_CONTEXT", "the context is not valid"},
    ErrorText{-36, "CL_INVALID_COMMAND_QUEUE", "the queue is not valid"},
    ErrorText{-38, "CL_INVALID_MEM_OBJECT", "the buffer is not valid"},
    ErrorText{-42, "CL_INVALID_BINARY", "the cached program is not for this device"},
    ErrorText{-43, "CL_INVALID_BUILD_OPTIONS", "the driver does not know a compiler option"},
    ErrorText{-44, "CL_INVALID_PROGRAM", "the program is not valid"},
    ErrorText{-45, "CL_INVALID_PROGRAM_EXECUTABLE", "the program was not built for this device"},
    ErrorText{-46, "CL_INVALID_KERNEL_NAME", "the program has no such kernel"},
    ErrorText{-48, "CL_INVALID_KERNEL", "the kernel is not valid"},
    ErrorText{-49, "CL_INVALID_ARG_INDEX", "the kernel has no such argument"},
    ErrorText{-50, "CL_INVALID_ARG_VALUE", "an argument's value is not valid"},
    ErrorText{-51, "CL_INVALID_ARG_SIZE", "an argument's size is not the kernel's"},
    ErrorText{-52, "CL_INVALID_KERNEL_ARGS", "an argument was not set"},
    ErrorText{-54, "CL_INVALID_WORK_GROUP_SIZE", "the work-group size does not suit the device"},
    ErrorText{-55, "CL_INVALID_WORK_ITEM_SIZE", "too many work-items in a work-group"},
    ErrorText{-61, "CL_INVALID_BUFFER_SIZE", "the buffer is larger than one allocation on the device may be"},
    ErrorText{-63, "CL_INVALID_GLOBAL_WORK_SIZE", "the launch is too large or empty"},
    ErrorText{-1001, "CL_PLATFORM_NOT_FOUND_KHR", "no OpenCL platform is installed"},
};

}  // namespace

std::string describe_cl_error(int code) {
  for (const ErrorText& error : kErrors) {
    if (error.code == code) return fmt::format("{} ({}): {}", error.name, code, error.meaning);
  }
  return fmt::format("OpenCL error {}: no meaning known", code);
}

DeviceError make_cl_error(int code, const std::string& call, const std::string& what) {
  return DeviceError(fmt::format("{}: {} failed with {}", what, call, describe_cl_error(code)));
}

}  // namespace hemiray

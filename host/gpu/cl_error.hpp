// OpenCL error codes in words.
#pragma once

#include <functional>
#include <string>

#include "host/base/error.hpp"
#include "host/gpu/opencl.hpp"

namespace hemiray {

/// "CL_OUT_OF_RESOURCES (-5): the device ran out of resources ...": name, code and meaning.
std::string describe_cl_error(int code);

/// A DeviceError for `code` raised by `call` while doing `what` ("allocating 12 MiB for bvh_nodes").
DeviceError make_cl_error(int code, const std::string& call, const std::string& what);

/// Runs `body` and turns a cl::Error into a DeviceError that says what was being done.
template <typename Body>
auto cl_guard(const std::string& what, Body&& body) -> decltype(body()) {
  try {
    return body();
  } catch (const cl::Error& error) {
    throw make_cl_error(error.err(), error.what(), what);
  }
}

}  // namespace hemiray

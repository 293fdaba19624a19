// Scalars and vectors that mean the same to the host (C++20) and the device (OpenCL C 1.2).
#ifndef HR_SHARED_SCALAR_H
#define HR_SHARED_SCALAR_H

#ifndef __cplusplus

#define HR_SHARED_BEGIN
#define HR_SHARED_END

// Arithmetic is written over `real`; scene buffers hold float in every build, so that oracle inputs are exact.
#ifdef HR_DOUBLE
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
typedef double real;
typedef double2 real2;
typedef double3 real3;
typedef double4 real4;
#define REAL(x) x
#else
typedef float real;
typedef float2 real2;
typedef float3 real3;
typedef float4 real4;
#define REAL(x) x##f
#endif

#else

#include <cstdint>

#define HR_SHARED_BEGIN namespace hemiray::shared {
#define HR_SHARED_END }

namespace hemiray::shared {
using uint = std::uint32_t;
using ulong = std::uint64_t;
struct alignas(8) float2 {
  float x, y;
};
struct alignas(16) float4 {
  float x, y, z, w;
};
struct alignas(8) int2 {
  std::int32_t x, y;
};
struct alignas(8) uint2 {
  uint x, y;
};
struct alignas(16) uint4 {
  uint x, y, z, w;
};
using real = float;
using real4 = float4;
}  // namespace hemiray::shared

#endif

#endif

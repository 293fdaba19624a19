// Vectors whose width is a compile-time parameter, and sets of their lanes. With HR_EXPLICIT_VECTORS 0 there are none:
// the functions that use them have a scalar twin.
#ifndef HR_LIB_LANES_H
#define HR_LIB_LANES_H

#include "shared/scalar.h"

#define HR_PASTE2(a, b) a##b
#define HR_PASTE(a, b) HR_PASTE2(a, b)

// A set of lanes, found by comparing vectors: its first lane, and the set without it. Two forms:
//  1 the processor's own sign mask, a bit a lane, worth 10 to 25 % on AVX2;
//  2 portable: comparison results narrowed to bytes and read as one number, a byte a lane.
#ifndef HR_LANE_MASK
#if defined(__has_builtin)
#if __has_builtin(__builtin_ia32_movmskps256) && __has_builtin(__builtin_ctz) && defined(__AVX__)
#define HR_LANE_MASK 1
#endif
#endif
#endif
#ifndef HR_LANE_MASK
#define HR_LANE_MASK 2
#endif

#if HR_LANE_MASK == 1

typedef uint LaneSet;
typedef float NativeFloat8 __attribute__((__vector_size__(32)));
typedef float NativeFloat4 __attribute__((__vector_size__(16)));
static inline LaneSet lanes_of8(int8 m) { return (uint)__builtin_ia32_movmskps256((NativeFloat8)as_float8(m)); }
static inline LaneSet lanes_of4(int4 m) { return (uint)__builtin_ia32_movmskps((NativeFloat4)as_float4(m)); }
static inline LaneSet lanes_of2(int2 m) { return (uint)(m.x & 1) | (uint)(m.y & 2); }
static inline uint first_lane(LaneSet s) { return (uint)__builtin_ctz(s); }
static inline LaneSet without_first(LaneSet s) { return s & (s - 1); }
static inline LaneSet lane_bit(uint lane) { return 1u << lane; }

#else

typedef ulong LaneSet;
static inline LaneSet lanes_of8(int8 m) { return as_ulong(convert_char8(m)); }
static inline LaneSet lanes_of4(int4 m) { return as_uint(convert_char4(m)); }
static inline LaneSet lanes_of2(int2 m) { return as_ushort(convert_char2(m)); }
static inline uint first_bit(ulong s) { return 63u - (uint)clz(s & (ulong)(-(long)s)); }
static inline uint first_lane(LaneSet s) { return first_bit(s) >> 3; }
static inline LaneSet without_first(LaneSet s) { return s & ~(0xfful << (first_bit(s) & 56u)); }
static inline LaneSet lane_bit(uint lane) { return 1ul << (8 * lane); }

#endif

// On an array of so many floats: a vector of them may be stored to it through a cast pointer.
#define HR_ALIGN_AS_VECTOR(lanes) __attribute__((aligned(4 * (lanes))))

// Puts a vector of so many lanes into an array of floats that is aligned no better than its elements.
#define HR_STORE(lanes, vector, array) HR_PASTE(vstore, lanes)(vector, 0, array)

// Lanes 8 to 15. Not a.hi: Oclgrind 21.10 takes lane 11 of any shuffle for uninitialised. Compiled, they are the same.
static inline int8 upper_lanes(int16 a) { return ((const int8*)&a)[1]; }

static inline bool any_lane16(int16 m) { return lanes_of8(m.lo | upper_lanes(m)) != 0; }

// A hint that a condition is seldom true.
#if defined(__has_builtin) && !defined(__SPIR__) && !defined(__SPIRV__)
#if __has_builtin(__builtin_expect)
#define HR_UNLIKELY(condition) (__builtin_expect((condition) ? 1 : 0, 0) != 0)
#endif
#endif
#ifndef HR_UNLIKELY
#define HR_UNLIKELY(condition) (condition)
#endif

// A hint that memory at p will be read soon, for CPUs: GPUs hide the wait themselves, and NVIDIA's compiler does not
// take a pointer to global memory for it. SPIR-V has no word for the builtin.
#if defined(HR_ON_CPU) && defined(__has_builtin) && !defined(__SPIR__) && !defined(__SPIRV__)
#if __has_builtin(__builtin_prefetch)
#define HR_PREFETCH(p) __builtin_prefetch(p)
#endif
#endif
#ifndef HR_PREFETCH
#define HR_PREFETCH(p)
#endif

#endif

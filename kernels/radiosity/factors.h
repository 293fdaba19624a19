// Form factors as solvers read them: in single precision, or (HR_HALF_FACTORS) rounded to half with a scale a row.
#ifndef HR_RADIOSITY_FACTORS_H
#define HR_RADIOSITY_FACTORS_H

#if HR_HALF_FACTORS

// Parameters of a kernel: values, and the scales of their rows.
#define HR_FACTORS(values) global const half *restrict values, global const float *restrict values##_scales
// Entry e, of row k; it and the next three.
#define HR_FACTOR(values, k, e) half_factor(values, values##_scales[k], e)
#define HR_FACTORS4(values, k, e) half_factors4(values, values##_scales[k], e)

// Core OpenCL 1.2: half is a format of memory here, not of arithmetic.
static inline float half_factor(global const half* values, float scale, uint e) {
  return vload_half(e, values) * scale;
}
static inline float4 half_factors4(global const half* values, float scale, uint e) {
  return vload_half4(0, values + e) * scale;
}

#else

#define HR_FACTORS(values) global const float* restrict values
#define HR_FACTOR(values, k, e) values[e]
#define HR_FACTORS4(values, k, e) vload4(0, values + e)

#endif

#endif

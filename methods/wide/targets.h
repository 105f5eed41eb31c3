#pragma once

// Which instruction sets a kernels.cpp is compiled for. It is chosen here and not by the compiler's flags, so that a build for
// this very machine still holds the AVX2 kernels, and a build for any machine the AVX-512 ones. To be included before all else,
// with HWY_TARGET_INCLUDE defined and hwy/foreach_target.h after it.

#undef HWY_COMPILE_ONLY_STATIC
#ifdef __AVX2__
#define HWY_BASELINE_TARGETS HWY_AVX2
#else
#define HWY_BASELINE_TARGETS HWY_SSE4
#endif
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)

#include <hwy/detect_targets.h>

// N_X::f where it is compiled for X, else null.
#if HWY_TARGETS & HWY_AVX3
#define RAYSTUDY_OF_AVX512(f) N_AVX3::f
#else
#define RAYSTUDY_OF_AVX512(f) nullptr
#endif
#if HWY_TARGETS & HWY_AVX2
#define RAYSTUDY_OF_AVX2(f) N_AVX2::f
#else
#define RAYSTUDY_OF_AVX2(f) nullptr
#endif
#if HWY_TARGETS & HWY_SSE4
#define RAYSTUDY_OF_SSE4(f) N_SSE4::f
#else
#define RAYSTUDY_OF_SSE4(f) nullptr
#endif

/// Initializes an array of the function `f` of each instruction set, to be indexed by wide::instruction_set.
#define RAYSTUDY_OF_EACH(f) \
  { RAYSTUDY_OF_AVX512(f), RAYSTUDY_OF_AVX2(f), RAYSTUDY_OF_SSE4(f) }

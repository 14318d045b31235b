// Which instructions the inner loops use: the portable ones every x86-64 machine has, or those of 2013 and later (AVX2,
// BMI, POPCNT), chosen while the program runs. Both give the same bytes: only integers and comparisons are vectorized.
#pragma once

namespace tet4d::hypermesh {

enum class Simd { kPortable, kWide };

// What this machine can do. The environment variable TET4D_SIMD=portable chooses the portable loops, for tests.
Simd bestSimd();

}  // namespace tet4d::hypermesh

// Marks the twin of a portable function. The body must be inlined into both.
#if defined(__x86_64__)
#define TET4D_WIDE [[gnu::target("avx2,bmi,bmi2,lzcnt,popcnt")]]
#else
#define TET4D_WIDE
#endif

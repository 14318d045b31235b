#include "libpreprocess/hypermesh/simd.h"

#include <cstdlib>
#include <string_view>

namespace tet4d::hypermesh {

Simd bestSimd() {
  static const Simd best = [] {
    const char* wanted = std::getenv("TET4D_SIMD");
    if (wanted != nullptr && std::string_view(wanted) == "portable") return Simd::kPortable;
#if defined(__x86_64__)
    const bool wide = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("bmi") != 0 &&
                      __builtin_cpu_supports("bmi2") != 0 && __builtin_cpu_supports("popcnt") != 0;
    return wide ? Simd::kWide : Simd::kPortable;
#else
    return Simd::kPortable;
#endif
  }();
  return best;
}

}  // namespace tet4d::hypermesh

#include "libpreprocess/outofcore/huge_pages.h"

#include <sys/mman.h>

#include <cstdint>

namespace tet4d::outofcore {

void adviseHugePages(void* begin, std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  constexpr std::uintptr_t kSmallPage = 4096, kHugePage = std::uintptr_t{1} << 21;
  if (bytes < 2 * kHugePage) return;
  const auto address = reinterpret_cast<std::uintptr_t>(begin);
  const std::uintptr_t first = (address + kSmallPage - 1) / kSmallPage * kSmallPage;
  const std::uintptr_t last = (address + bytes) / kSmallPage * kSmallPage;
  static_cast<void>(madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE));
#else
  static_cast<void>(begin), static_cast<void>(bytes);
#endif
}

}  // namespace tet4d::outofcore

// Large arrays that are read in no order cost a translation of addresses with every access; on large pages hardly any.
#pragma once

#include <cstddef>
#include <vector>

namespace tet4d::outofcore {

// Asks the system for large pages under [begin, begin + bytes), which must not have been written yet. Only a hint: no
// failure, and nothing where the system has no such call.
void adviseHugePages(void* begin, std::size_t bytes);

// items.reserve(count), on large pages where the system has them and the array fills some.
template <class T>
void reserveHuge(std::vector<T>& items, std::size_t count) {
  if (count <= items.capacity()) return;
  items.reserve(count);
  if (items.empty()) adviseHugePages(items.data(), count * sizeof(T));
}

}  // namespace tet4d::outofcore

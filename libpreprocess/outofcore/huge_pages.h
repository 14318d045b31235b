// Large arrays that are read in no order cost a translation of addresses with every access; on large pages hardly any.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace tet4d::outofcore {

// Asks the system for large pages under [begin, begin + bytes), which must not have been written yet. Only a hint: no
// failure, and nothing where the system has no such call.
void adviseHugePages(void* begin, std::size_t bytes);

// Puts arrays at the begin of a line of the cache, so that items of one or two lines are fetched as such.
template <class T>
struct LineAllocator {
  using value_type = T;
  static constexpr std::align_val_t kLine{64};
  LineAllocator() = default;
  template <class U>
  LineAllocator(const LineAllocator<U>& /*other*/) {}  // NOLINT(google-explicit-constructor): as allocators convert
  T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), kLine)); }
  void deallocate(T* items, std::size_t /*count*/) { ::operator delete(items, kLine); }
  friend bool operator==(const LineAllocator& /*a*/, const LineAllocator& /*b*/) { return true; }
};

// items.reserve(count), on large pages where the system has them and the array fills some.
template <class T, class Allocator>
void reserveHuge(std::vector<T, Allocator>& items, std::size_t count) {
  if (count <= items.capacity()) return;
  items.reserve(count);
  if (items.empty()) adviseHugePages(items.data(), count * sizeof(T));
}

}  // namespace tet4d::outofcore

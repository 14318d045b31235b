#include "player/stream/page_buffer.h"

#include <sys/mman.h>

namespace tet4d::stream {
namespace {

constexpr std::uint64_t kMachinePage = 4096;

}  // namespace

std::uint64_t PageBuffer::cost(std::uint64_t bytes) { return (bytes + kMachinePage - 1) / kMachinePage * kMachinePage; }

PageBuffer::PageBuffer(std::uint64_t bytes) {
  if (bytes == 0) return;
  void* data = mmap(nullptr, cost(bytes), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (data == MAP_FAILED) return;
  data_ = static_cast<std::byte*>(data);
  bytes_ = bytes;
}

PageBuffer::~PageBuffer() {
  if (data_ != nullptr) munmap(data_, cost(bytes_));
}

}  // namespace tet4d::stream

// Memory of one page, taken from the system and given back to it at once, so that a budget in bytes holds to the byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace tet4d::stream {

class PageBuffer {
 public:
  PageBuffer() = default;
  // Empty if the system has no `bytes` left.
  explicit PageBuffer(std::uint64_t bytes);
  PageBuffer(PageBuffer&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), bytes_(std::exchange(other.bytes_, 0)) {}
  PageBuffer& operator=(PageBuffer&& other) noexcept {
    std::swap(data_, other.data_), std::swap(bytes_, other.bytes_);
    return *this;
  }
  ~PageBuffer();

  bool empty() const { return data_ == nullptr; }
  std::span<std::byte> bytes() const { return {data_, bytes_}; }
  // What `bytes` take in whole pages of the machine.
  static std::uint64_t cost(std::uint64_t bytes);

 private:
  std::byte* data_ = nullptr;
  std::uint64_t bytes_ = 0;
};

}  // namespace tet4d::stream

// What the fuzz targets share: bytes as a file that is only in memory, and files whose checksums are mended, so that
// the fuzzer reaches what stands behind them.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "tests/formats/support/forge.h"

namespace tet4d::fuzz {

class MemoryFile {
 public:
  explicit MemoryFile(std::span<const std::byte> bytes) : fd_(memfd_create("fuzz", MFD_CLOEXEC)) {
    if (fd_ < 0 || ::write(fd_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) std::abort();
  }
  ~MemoryFile() { ::close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

// The same bytes with a proper header in front and every checksum right.
inline std::vector<std::byte> mended(std::span<const std::byte> bytes, std::uint32_t payload) {
  test::Image image{{bytes.begin(), bytes.end()}};
  container::FileHeader& header = image.header();
  std::memcpy(header.magic, "T4D\r\n\x1a\n\0", 8);
  header.endian_mark = 0x01020304;
  header.container_version = header.payload_version = 1;
  header.payload = payload;
  header.file_bytes = bytes.size();
  header.reserved = 0;
  image.seal();
  return std::move(image.bytes);
}

// Calls `target` with a file of the input as it is, and one of the input mended.
template <class Target>
int run(const std::uint8_t* data, std::size_t size, std::uint32_t payload, Target target) {
  const auto bytes = std::as_bytes(std::span(data, size));
  target(MemoryFile(bytes).path());
  if (size >= sizeof(container::FileHeader)) target(MemoryFile(mended(bytes, payload)).path());
  return 0;
}

}  // namespace tet4d::fuzz

// Bytes read once, from front to back, through one fixed buffer: of a file, or of a pipe that hands them out in pieces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libpreprocess/exchange/input_file.h"

namespace tet4d::exchange {

class ByteStream {
 public:
  // The bytes of a file from `offset` on. `file` must outlive the stream.
  explicit ByteStream(const InputFile& file, std::uint64_t offset = 0);
  // The bytes of an open descriptor, which stays the caller's; `name` is what messages call it.
  ByteStream(int descriptor, std::string name);

  const std::string& name() const { return name_; }
  std::uint64_t position() const { return position_; }  // of the next byte; in a file from its beginning
  // Bytes that are at hand: at least one, which a pipe waits for, unless the stream has ended. Valid until the next
  // call.
  std::span<const std::byte> peek();
  // Takes `bytes` of those peeked at.
  void consume(std::size_t bytes);
  // The next bytes.size() bytes; returns how many there were (fewer only at the end).
  std::size_t read(std::span<std::byte> bytes);
  // Passes over up to `bytes` bytes; returns how many there were.
  std::uint64_t skip(std::uint64_t bytes);

 private:
  // One read of the system: 0 only at the end. Throws Error{kIo}.
  std::size_t fetch(std::span<std::byte> bytes);

  const InputFile* file_ = nullptr;
  int descriptor_ = -1;
  std::string name_;
  std::uint64_t position_ = 0;  // of buffer_[used_]
  std::vector<std::byte> buffer_;
  std::size_t used_ = 0, filled_ = 0;
};

}  // namespace tet4d::exchange

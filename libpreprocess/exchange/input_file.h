// A foreign file as bytes, read at any place. Errors name the file and the byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace tet4d::exchange {

// A regular file opened for reading. Throws Error{kIo} if it cannot be opened or is no regular file.
class InputFile {
 public:
  explicit InputFile(const std::string& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& path() const { return path_; }
  std::uint64_t size() const { return size_; }
  // Reads up to bytes.size() bytes at `offset`; returns how many there were (fewer only at the end of the file).
  std::size_t readSome(std::uint64_t offset, std::span<std::byte> bytes) const;
  // Reads exactly bytes.size() bytes at `offset`; a shorter file is Error{kBadInput}.
  void read(std::uint64_t offset, std::span<std::byte> bytes) const;

 private:
  std::string path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace tet4d::exchange

// Foreign files as bytes: a file read at any place, and a gzip stream in it. Both name the file and the byte in their
// errors, and neither holds more than a fixed buffer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
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

// The decoded bytes of a gzip stream (one or several members, to the end of the file), read once from front to back.
// A truncated stream, broken data and a wrong checksum are Error{kBadInput} that name the byte in the compressed file.
class GzipStream {
 public:
  // `file` must outlive the stream; the first member begins at `offset`.
  GzipStream(const InputFile& file, std::uint64_t offset);
  ~GzipStream();
  GzipStream(const GzipStream&) = delete;
  GzipStream& operator=(const GzipStream&) = delete;

  std::uint64_t position() const { return position_; }  // decoded bytes handed out so far
  // The next bytes.size() decoded bytes; fewer are an error.
  void read(std::span<std::byte> bytes);
  void skip(std::uint64_t bytes);
  // Proves that the stream ends here with good checksums; further decoded bytes are an error.
  void finish();

 private:
  struct State;
  std::size_t readSome(std::span<std::byte> bytes);
  [[noreturn]] void fail(const std::string& what, const std::string& remedy) const;
  std::unique_ptr<State> state_;
  std::uint64_t position_ = 0;
};

}  // namespace tet4d::exchange

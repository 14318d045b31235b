// The decoded bytes of a gzip or zlib stream, read once from front to back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "libpreprocess/exchange/byte_stream.h"

namespace tet4d::exchange {

// A truncated stream, broken data and a wrong checksum are Error{kBadInput} that name the byte in the compressed input.
class GzipStream {
 public:
  enum class Wrapper { kGzip, kGzipOrZlib };

  // One or several members, to the end of the file. `file` must outlive the stream; the first member begins at
  // `offset`.
  GzipStream(const InputFile& file, std::uint64_t offset, Wrapper wrapper = Wrapper::kGzip);
  // One gzip member; what follows it in `bytes` stays there. `bytes` must outlive the stream.
  explicit GzipStream(ByteStream& bytes);
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
  void start(Wrapper wrapper);
  std::size_t readSome(std::span<std::byte> bytes);
  [[noreturn]] void fail(const std::string& what, const std::string& remedy) const;
  std::unique_ptr<State> state_;
  std::uint64_t position_ = 0;
};

}  // namespace tet4d::exchange

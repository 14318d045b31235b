// NRRD files as frames: the header first, then any frame into the caller's buffer.
//
// Raw data are read where they stand. Gzip data are decoded from front to back: frames read in order cost one pass, a
// frame before the last one read costs a new start. Neither holds more than a fixed buffer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "libpreprocess/exchange/nrrd_header.h"

namespace tet4d::exchange {

class NrrdFile {
 public:
  // Reads the header. Throws as readNrrdHeader().
  explicit NrrdFile(const std::string& path);
  NrrdFile(NrrdFile&&) noexcept;
  ~NrrdFile();

  const NrrdHeader& header() const { return header_; }
  // Reads frame k, header().frameBytes() bytes in native byte order. Throws Error{kBadInput} naming the data file and
  // the byte: a file that has become short, a truncated or broken gzip stream, a wrong checksum (seen with a stream's
  // last frame).
  void readFrame(std::uint64_t k, std::span<std::byte> samples);
  // Closes the data file that readFrame() keeps open.
  void close();

 private:
  struct OpenFile;
  OpenFile& open(std::uint64_t file, std::uint64_t at);
  NrrdHeader header_;
  std::unique_ptr<OpenFile> open_;
};

}  // namespace tet4d::exchange

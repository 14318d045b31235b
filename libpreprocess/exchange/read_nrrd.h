// NRRD files as frames: the header first, then any layers into the caller's buffer.
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

class NrrdFile final : public FrameFile {
 public:
  // Reads the header. Throws as readNrrdHeader().
  explicit NrrdFile(const std::string& path);
  ~NrrdFile() override;

  const NrrdHeader& header() const override { return header_; }
  // The checksum of a gzip stream is seen with its last layer.
  void readLayers(std::uint64_t frame, std::uint64_t z_begin, std::uint64_t z_end,
                  std::span<std::byte> samples) override;
  void close() override;

 private:
  struct OpenFile;
  OpenFile& open(std::uint64_t file, std::uint64_t at);
  NrrdHeader header_;
  std::unique_ptr<OpenFile> open_;
};

}  // namespace tet4d::exchange

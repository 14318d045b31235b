// NRRD files as frames: the header first, then any layers into the caller's buffer.
//
// Layers read in growing order cost one pass over the data, a layer before the last one read of gzip data a new start.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "libpreprocess/exchange/nrrd_header.h"

namespace tet4d::exchange {

class NrrdFile final : public FrameFile {
 public:
  // Reads the header. Throws as readNrrdHeader().
  explicit NrrdFile(const std::string& path, const FrameFileOptions& options = {});

  const NrrdHeader& header() const override { return header_; }
  // The checksum of a gzip stream is seen with its last layer.
  void readLayers(std::uint64_t frame, std::uint64_t z_begin, std::uint64_t z_end,
                  std::span<std::byte> samples) override;
  void close() override { samples_.close(); }

 private:
  NrrdHeader header_;
  SampleReader samples_;
};

}  // namespace tet4d::exchange

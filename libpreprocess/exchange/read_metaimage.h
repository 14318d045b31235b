// MetaImage files as frames: the header first, then any layers into the caller's buffer. Layers read in growing order
// cost one pass over the data, a layer before the last one read of compressed data a new start.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "libpreprocess/exchange/metaimage_header.h"

namespace tet4d::exchange {

class MetaImageFile final : public FrameFile {
 public:
  // Reads the header. Throws as readMetaImageHeader(). A MetaImage has no centerings: its positions are samples'.
  explicit MetaImageFile(const std::string& path, const FrameFileOptions& options = {});

  const MetaImageHeader& header() const override { return header_; }
  void readLayers(std::uint64_t frame, std::uint64_t z_begin, std::uint64_t z_end,
                  std::span<std::byte> samples) override;
  void close() override { samples_.close(); }

 private:
  MetaImageHeader header_;
  SampleReader samples_;
};

}  // namespace tet4d::exchange

// Raw files: samples and nothing that describes them. The caller says how they are to be understood.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "libpreprocess/exchange/frame_file.h"
#include "libpreprocess/exchange/sample_files.h"

namespace tet4d::exchange {

// The grid of a layout. Throws Error{kUsage} that names the option: a size of 0, an array over 2^63 bytes, a spacing or
// origin that is not finite, a spacing of 0.
GridInfo gridOfRaw(const RawLayout& layout, Centering centering);

// One or many frames behind each other; how many follows from the file's size. No times are told.
class RawFile final : public FrameFile {
 public:
  // Throws Error{kBadInput} if the file holds no whole number of frames, with the sizes in bytes.
  RawFile(const std::string& path, const RawLayout& layout, Centering centering);

  const FrameFileHeader& header() const override { return header_; }
  void readLayers(std::uint64_t frame, std::uint64_t z_begin, std::uint64_t z_end,
                  std::span<std::byte> samples) override;
  void close() override { samples_.close(); }

 private:
  FrameFileHeader header_;
  SampleReader samples_;
};

}  // namespace tet4d::exchange

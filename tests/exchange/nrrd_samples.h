// NRRD files made for tests, by other means than the reader's own.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "formats/core/sample_type.h"
#include "libpreprocess/exchange/frame_source.h"

namespace tet4d::testing {

// A gzip stream of the text.
std::string gzipped(std::string_view text);

// `count` samples 0, 1, 2, … (plus `first`, wrapping in small types) as bytes of a type and order.
std::string sampleText(SampleType type, std::size_t count, bool big_endian, std::uint64_t first = 0);

// The same samples as a reader must deliver them.
std::vector<std::byte> nativeSamples(SampleType type, std::size_t count, std::uint64_t first = 0);

// A 2 x 3 x 2 float header without its end: "NRRD0004 … endian: little". Lines may be added behind it.
std::string smallHeader(const std::string& encoding = "raw");
inline constexpr std::size_t kSmallVoxels = 12;

// A whole 2 x 3 x 2 float file with a time.
std::string smallFile(const std::string& time_line = "", std::uint64_t first = 0);

// Frame k of a source, or of a file's frames.
std::vector<std::byte> frameOf(exchange::FrameSource& source, std::size_t k);
// The same, read one layer at a time.
std::vector<std::byte> frameByLayers(exchange::FrameSource& source, std::size_t k);

}  // namespace tet4d::testing

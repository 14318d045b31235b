#include "libpreprocess/exchange/read_raw.h"

#include <cassert>
#include <cmath>
#include <limits>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/number_text.h"

namespace tet4d::exchange {
namespace {

FrameFileHeader headerOf(const std::string& path, const RawLayout& layout, Centering centering) {
  FrameFileHeader header;
  header.path = path;
  header.grid = gridOfRaw(layout, centering);
  const std::uint64_t size = InputFile(path).size(), frame = header.frameBytes();
  const std::string frame_text = "a frame of " + sizeText(header.grid) + " samples of type " +
                                 std::string(sampleName(layout.type)) + " takes " + std::to_string(frame) + " bytes";
  const auto fail = [&](std::uint64_t at, const std::string& what) {
    throw Error(FaultCode::kBadInput, path, "byte " + std::to_string(at), what,
                "correct --size, --type or --skip, or copy the file again");
  };
  const std::string behind = layout.skip == 0 ? "" : " behind the " + std::to_string(layout.skip) + " skipped";
  if (size < layout.skip || size - layout.skip < frame) {
    fail(size, "the file is short: " + frame_text + ", but it holds " +
                   std::to_string(size < layout.skip ? 0 : size - layout.skip) + behind);
  }
  const std::uint64_t held = size - layout.skip;
  header.frames = held / frame;
  if (held % frame != 0) {
    fail(layout.skip + header.frames * frame, frame_text + ", but the file holds " + std::to_string(held) + behind +
                                                  ": " + std::to_string(header.frames) + " frames and " +
                                                  std::to_string(held % frame) + " bytes more");
  }
  if (header.frames > kMaxFrames) {
    fail(layout.skip, std::to_string(header.frames) + " frames, at most " + std::to_string(kMaxFrames) +
                          " can be told apart in float32");
  }
  return header;
}

SampleFiles samplesOf(const FrameFileHeader& header, const RawLayout& layout) {
  SampleFiles files;
  files.header_path = header.path;
  files.swap_bytes = isOtherByteOrder(layout.big_endian);
  files.file_bytes = header.frames * header.frameBytes();
  files.begin = layout.skip;
  return files;
}

}  // namespace

GridInfo gridOfRaw(const RawLayout& layout, Centering centering) {
  const auto fail = [](const std::string& option, const std::string& what, const std::string& remedy) {
    throw Error(FaultCode::kUsage, "", "option " + option, what, remedy);
  };
  GridInfo grid;
  grid.dims = layout.dims;
  grid.type = layout.type;
  constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  std::uint64_t bytes = sampleBytes(layout.type);
  for (std::size_t c = 0; c < 3; ++c) {
    const std::uint64_t size = layout.dims[c];
    if (size == 0) fail("--size", "a size is 0", "give the counts of samples along x, y and z, each at least 1");
    if (bytes > kMost / size) fail("--size", "the product of the sizes is over 2^63 bytes", "correct the sizes");
    bytes *= size;
    const double spacing = layout.spacing[c], origin = layout.origin[c];
    if (!std::isfinite(spacing) || spacing == 0) {
      fail("--spacing", "the spacing " + numberText(spacing) + " is not finite, or 0", "give three numbers");
    }
    if (!std::isfinite(origin)) fail("--origin", "the origin is not finite", "give three numbers");
    grid.index_to_world.axes[c] = {0, 0, 0};
    grid.index_to_world.axes[c][c] = spacing;
    grid.index_to_world.origin[c] = origin + (centering == Centering::kCell ? spacing / 2 : 0);
  }
  if (!isUsable(grid.index_to_world)) {
    fail("--spacing", "a cell's volume is no float64 number above 0", "give the spacing in another unit");
  }
  return grid;
}

RawFile::RawFile(const std::string& path, const RawLayout& layout, Centering centering)
    : header_(headerOf(path, layout, centering)), samples_(samplesOf(header_, layout)) {}

void RawFile::readLayers(std::uint64_t frame, std::uint64_t z_begin, [[maybe_unused]] std::uint64_t z_end,
                         std::span<std::byte> samples) {
  const GridInfo& grid = header_.grid;
  assert(frame < header_.frames && z_begin <= z_end && z_end <= grid.dims[2]);
  assert(samples.size() == (z_end - z_begin) * grid.layerBytes());
  samples_.read(frame * grid.frameBytes() + z_begin * grid.layerBytes(), samples, sampleBytes(grid.type));
}

}  // namespace tet4d::exchange

#include "libpreprocess/exchange/read_metaimage.h"

#include <cassert>

namespace tet4d::exchange {

MetaImageFile::MetaImageFile(const std::string& path, const FrameFileOptions&)
    : header_(readMetaImageHeader(path)), samples_(header_.data) {}

void MetaImageFile::readLayers(std::uint64_t frame, std::uint64_t z_begin, [[maybe_unused]] std::uint64_t z_end,
                               std::span<std::byte> samples) {
  const GridInfo& grid = header_.grid;
  assert(frame < header_.frames && z_begin <= z_end && z_end <= grid.dims[2]);
  assert(samples.size() == (z_end - z_begin) * grid.layerBytes());
  samples_.read(frame * grid.frameBytes() + z_begin * grid.layerBytes(), samples, sampleBytes(grid.type));
}

}  // namespace tet4d::exchange

#include "libpreprocess/hypermesh/frame_ring.h"

#include <algorithm>
#include <bit>

namespace tet4d::hypermesh {

FrameRing::FrameRing(exchange::FrameSource& source, std::size_t frames, std::uint64_t run_bytes)
    : source_(source), run_bytes_(run_bytes) {
  static_assert(std::endian::native == std::endian::little, "the digest is over little-endian samples");
  for (std::size_t i = 0; i < frames; ++i)
    slots_.push_back(std::make_unique_for_overwrite<std::byte[]>(source.grid().frameBytes()));
}

std::size_t FrameRing::readNext(const Look& look) {
  const exchange::GridInfo& grid = source_.grid();
  const std::uint64_t layer = grid.layerBytes(), layers = grid.dims[2];
  const std::uint64_t run = std::max<std::uint64_t>(1, run_bytes_ / std::max<std::uint64_t>(1, layer));
  const std::size_t frame = digests_.size();
  std::byte* const into = slots_[frame % slots_.size()].get();
  stream_.reset();
  for (std::uint64_t z = 0; z < layers; z += run) {
    const std::uint64_t end = std::min(layers, z + run);
    const std::span<std::byte> samples(into + z * layer, (end - z) * layer);
    source_.readLayers(frame, z, end, samples);
    look(z, end, [&] { stream_.add(samples); });
  }
  digests_.push_back(stream_.digest());
  return frame;
}

std::uint64_t FrameRing::digest() const { return container::xxh3(std::as_bytes(std::span(digests_))); }

}  // namespace tet4d::hypermesh

// The latest frames of a source in memory, in the source's own type. Every frame is read once, in order, in runs of
// layers small enough to be digested and looked at while they are in the cache.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "formats/container.h"
#include "libpreprocess/exchange/frame_source.h"

namespace tet4d::hypermesh {

class FrameRing {
 public:
  // Keeps the latest `frames` frames; reads them in runs of about `run_bytes`.
  FrameRing(exchange::FrameSource& source, std::size_t frames, std::uint64_t run_bytes);

  // Takes a run of layers that is there, and must call `digest` once, before or beside its own work, on any thread.
  using Look = std::function<void(std::uint64_t z_begin, std::uint64_t z_end, const std::function<void()>& digest)>;
  // Reads the next frame, whose number it returns, run by run. Throws what the source throws.
  std::size_t readNext(const Look& look);
  std::size_t framesRead() const { return digests_.size(); }
  // The samples of one of the latest frames. Aligned for every type.
  const std::byte* samples(std::size_t frame) const { return slots_[frame % slots_.size()].get(); }

  // XXH3-64 over the XXH3-64s (u64) of the frames read, each over its samples in the source's type, little-endian.
  std::uint64_t digest() const;
  static std::uint64_t bytes(const exchange::GridInfo& grid, std::size_t frames) { return frames * grid.frameBytes(); }

 private:
  exchange::FrameSource& source_;
  std::uint64_t run_bytes_;
  std::vector<std::unique_ptr<std::byte[]>> slots_;
  container::Xxh3Stream stream_;
  std::vector<std::uint64_t> digests_;
};

}  // namespace tet4d::hypermesh

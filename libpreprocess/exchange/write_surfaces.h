// Surfaces whose vertices move into one .t4q.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "formats/paged.h"
#include "libpreprocess/exchange/surface_source.h"
#include "libpreprocess/outofcore/progress.h"

namespace tet4d::exchange {

// Writes every frame of `source`, in order (phase "write"). `provenance` gets a digest of triangles, map and positions,
// the same whatever files they came from. Memory of one frame. Throws Error as the source and the writer.
void writeSurfaceSequence(const std::string& path, SurfaceSource& source, paged::Codec codec, bool force,
                          const std::function<std::string(std::uint64_t)>& provenance, outofcore::Progress& progress);

// Collects the digest of a source: triangles and map first, then frame by frame.
class SurfaceDigest {
 public:
  explicit SurfaceDigest(const SurfaceInfo& info);
  void add(std::span<const Vec3f> positions);
  std::uint64_t value() const;

 private:
  std::vector<std::uint64_t> parts_;
};

}  // namespace tet4d::exchange

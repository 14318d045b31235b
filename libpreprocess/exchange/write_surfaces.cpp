#include "libpreprocess/exchange/write_surfaces.h"

#include "formats/surface_sequence.h"
#include "libpreprocess/error.h"

namespace tet4d::exchange {

SurfaceDigest::SurfaceDigest(const SurfaceInfo& info) {
  parts_.push_back(container::xxh3(std::as_bytes(std::span(info.triangles))));
  parts_.push_back(container::xxh3(std::as_bytes(std::span(&info.index_to_world, 1))));
}

void SurfaceDigest::add(std::span<const Vec3f> positions) {
  parts_.push_back(container::xxh3(std::as_bytes(positions)));
}

std::uint64_t SurfaceDigest::value() const { return container::xxh3(std::as_bytes(std::span(parts_))); }

void writeSurfaceSequence(const std::string& path, SurfaceSource& source, paged::Codec codec, bool force,
                          const std::function<std::string(std::uint64_t)>& provenance, outofcore::Progress& progress) {
  const SurfaceInfo& info = source.info();
  surface_sequence::Header header{};
  header.vertices = info.vertices;
  header.index_to_world = info.index_to_world;
  surface_sequence::Writer writer =
      unwrap(surface_sequence::Writer::create(path, header, info.times, info.triangles, {}, codec, force));
  SurfaceDigest digest(info);
  std::vector<Vec3f> positions(info.vertices);
  progress.phase("write", info.times.size());
  for (std::size_t k = 0; k < info.times.size(); ++k) {
    source.readFrame(k, positions);
    digest.add(positions);
    unwrap(writer.addFrame(positions));
    progress.step(k + 1);
  }
  unwrap(writer.close(provenance(digest.value())));
}

}  // namespace tet4d::exchange

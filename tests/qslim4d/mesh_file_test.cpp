// Files of several parts: read, simplified and written part by part.
#include "libpreprocess/qslim4d/mesh_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libpreprocess/qslim4d/simplify.h"
#include "libpreprocess/topology/links.h"
#include "tests/hypermesh/extracted_mesh.h"
#include "tests/hypermesh/memory_frames.h"
#include "tests/qslim4d/closed_slices.h"

namespace tet4d::qslim4d {
namespace {

namespace marching = hypermesh::testing;

TEST(MeshFile, PartsComeBackAsTheyWere) {
  marching::MemoryFrames<float> frames({15, 15, 15}, 7, [](auto x, auto y, auto z, auto k) {
    const auto f = [](auto i) { return static_cast<double>(i); };
    return static_cast<float>(-std::hypot(f(x) - 6.5 - 0.2 * f(k), f(y) - 7, f(z) - 7));
  });
  hypermesh::Options extraction;
  extraction.iso = -5.3;
  extraction.more_isos = {-3.2, -1.7};
  const std::string path = marching::temporaryPath("parts_in.t4h"), out = marching::temporaryPath("parts_out.t4h");
  const marching::ExtractedMesh mesh = marching::extractTo(path, frames, extraction);
  const hypermesh::File file = std::move(hypermesh::File::open(path)).value();
  const std::vector<std::uint64_t> counts = tetsByPart(file);
  ASSERT_EQ(counts.size(), 3u);
  outofcore::ThreadExecutor executor(2);
  outofcore::Progress progress;
  std::vector<PackedMesh> parts;
  for (std::size_t part = 0; part < 3; ++part) {
    ReadOptions options;
    options.part = part;
    SlimMesh slim = readMesh(file, options, progress);
    EXPECT_EQ(slim.live_tets, counts[part]);
    Options to_a_third;
    to_a_third.target_tets = counts[part] / 3;
    simplify(slim, to_a_third, executor, progress);
    parts.push_back(pack(slim));
  }
  const std::vector<double> isovalues{-5.3, -3.2, -1.7};
  auto writer = hypermesh::Writer::create(out, mesh.header, mesh.times, {}, paged::Codec::kRaw, true, isovalues);
  ASSERT_TRUE(writer.ok());
  writeMeshes(parts, writer.value(), progress);
  ASSERT_TRUE(writer.value().close("{}").ok());
  const hypermesh::File result = std::move(hypermesh::File::open(out)).value();
  EXPECT_TRUE(result.verify().ok()) << result.verify().fault().what;
  ASSERT_EQ(result.parts().size(), 3u);
  EXPECT_EQ(result.parts()[1].isovalue, -3.2);
  for (std::size_t part = 0; part < 3; ++part) {
    EXPECT_EQ(tetsByPart(result)[part], parts[part].tets.size());
    ReadOptions options;
    options.part = part;
    const SlimMesh again = readMesh(result, options, progress);
    EXPECT_EQ(again.positions, parts[part].vertices) << part;
    EXPECT_EQ(testing::liveTets(again), parts[part].tets);
    EXPECT_TRUE(topology::checkLinks(again.tets, again.positions.size(), true).ok());
  }
}

}  // namespace
}  // namespace tet4d::qslim4d

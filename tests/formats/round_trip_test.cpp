// What the writers take comes back from the readers, for every payload, raw and compressed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "tests/formats/support/samples.h"
#include "tests/formats/support/scratch.h"

namespace tet4d::test {
namespace {

std::vector<paged::Codec> codecs() {
  std::vector<paged::Codec> all{paged::Codec::kRaw};
  if (paged::hasCodec(paged::Codec::kZstd)) all.push_back(paged::Codec::kZstd);
  return all;
}

TEST(RoundTrip, EverySampleOpensAndVerifies) {
  Scratch scratch;
  for (const Sample& sample : samples()) {
    const std::string path = scratch.path(sample.name);
    const Status written = sample.write(path);
    ASSERT_TRUE(written.ok()) << sample.name << ": " << written.fault().what;
    const Status status = openAndVerify(path, sample.payload);
    EXPECT_TRUE(status.ok()) << sample.name << ": " << status.fault().place << ": " << status.fault().what;
  }
}

TEST(RoundTrip, TheSameBytesEveryTime) {
  Scratch scratch;
  for (const Sample& sample : samples()) {
    ASSERT_TRUE(sample.write(scratch.path("a")).ok());
    ASSERT_TRUE(sample.write(scratch.path("another name")).ok());
    EXPECT_EQ(readBytes(scratch.path("a")), readBytes(scratch.path("another name"))) << sample.name;
  }
}

TEST(RoundTrip, GridOfEverySampleType) {
  Scratch scratch;
  const std::string path = scratch.path("g.t4g");
  for (const paged::Codec codec : codecs()) {
    for (std::uint32_t type = 1; type <= 10; ++type) {
      grid4::GridHeader header{};
      header.dims[0] = 3, header.dims[1] = 5, header.dims[2] = 2;
      header.sample_type = type;
      header.index_to_world.origin = {1e12, -1e-12, 0.1};
      const std::vector<double> times{-1.5, 1.7e9, 1.7e9 + 1e-6};
      auto writer = grid4::Writer::create(path, header, times, codec, true);
      ASSERT_TRUE(writer.ok()) << writer.fault().what;
      std::vector<std::vector<std::byte>> frames;
      for (std::size_t k = 0; k < times.size(); ++k) {
        frames.emplace_back(30 * sampleBytes(static_cast<SampleType>(type)), static_cast<std::byte>(k * 50 + type));
        frames.back().back() = std::byte{1};
        ASSERT_TRUE(writer.value().addFrame(frames.back()).ok());
      }
      ASSERT_TRUE(writer.value().close("{}").ok());
      auto file = grid4::File::open(path);
      ASSERT_TRUE(file.ok()) << file.fault().what;
      EXPECT_EQ(file.value().header().index_to_world, header.index_to_world);
      EXPECT_TRUE(std::ranges::equal(file.value().times(), times));
      for (std::size_t k = 0; k < times.size(); ++k) {
        auto frame = file.value().loadFrame(k);
        ASSERT_TRUE(frame.ok());
        EXPECT_TRUE(std::ranges::equal(frame.value().bytes(), frames[k]));
        EXPECT_EQ(frame.value().touched(), file.value().pages().entries()[k].bytes);
      }
      EXPECT_TRUE(file.value().verify().ok());
    }
  }
}

TEST(RoundTrip, HypermeshPagesAndTheirForeignVertices) {
  Scratch scratch;
  const std::string path = scratch.path("m.t4h");
  const Sheet sheet = makeSheet(2, 3);
  for (const paged::Codec codec : codecs()) {
    auto writer = hypermesh::Writer::create(path, sheet.header, sheet.times, {}, codec, true);
    ASSERT_TRUE(writer.ok());
    for (const auto& page : sheet.pages) {
      ASSERT_TRUE(writer.value().addPage(page.vertices, page.runs, page.tets, page.bounds).ok());
    }
    EXPECT_EQ(writer.value().nextVertex(), 36u);
    ASSERT_TRUE(writer.value().close("{}").ok());

    auto file = hypermesh::File::open(path);
    ASSERT_TRUE(file.ok()) << file.fault().what;
    EXPECT_EQ(file.value().header().vertices, 36u);
    EXPECT_EQ(file.value().header().tets, 72u);
    EXPECT_EQ(file.value().header().isovalue, 0.5);
    EXPECT_EQ(file.value().header().bounds.max.t, 3.0f);
    ASSERT_EQ(file.value().geometryPages(), 3u);
    for (std::size_t k = 0; k < 3; ++k) {
      auto page = file.value().gather(k);
      ASSERT_TRUE(page.ok()) << page.fault().what;
      const auto& view = page.value().view;
      EXPECT_TRUE(std::ranges::equal(view.vertices, sheet.pages[k].vertices));
      EXPECT_TRUE(std::ranges::equal(view.tets, sheet.pages[k].tets));
      ASSERT_EQ(page.value().positions.size(), 18u);
      for (std::uint32_t i = 0; i < 18; ++i) {
        EXPECT_EQ(view.globalOf(i), k * 9 + i);
        EXPECT_EQ(page.value().positions[i].t, static_cast<float>(k + i / 9));
      }
    }
    EXPECT_TRUE(file.value().verify().ok());
  }
}

// Several runs in a page, one of them across three owners, owners without vertices between.
TEST(RoundTrip, RunsMaySpanPages) {
  Scratch scratch;
  const std::string path = scratch.path("m.t4h");
  const Sheet sheet = makeSheet(1, 1);
  auto writer = hypermesh::Writer::create(path, sheet.header, sheet.times, {}, paged::Codec::kRaw, true);
  ASSERT_TRUE(writer.ok());
  std::vector<Vec4f> all;
  const auto owned = [&](std::size_t n) {
    std::vector<Vec4f> vertices;
    for (std::size_t i = 0; i < n; ++i) vertices.push_back({static_cast<float>(all.size() + i), 0, 0, 0});
    all.insert(all.end(), vertices.begin(), vertices.end());
    return vertices;
  };
  Bounds4f box{{0, 0, 0, 0}, {12, 0, 0, 0}};
  for (const std::size_t n : {3u, 0u, 2u, 4u}) ASSERT_TRUE(writer.value().addPage(owned(n), {}, {}, {}).ok());
  const std::vector<hypermesh::Run> runs{{0, 1}, {2, 4}, {7, 1}, {8, 1}};
  const std::vector<hypermesh::Tet> tets{{0, 3, 4, 9}, {8, 7, 6, 5}};
  ASSERT_TRUE(writer.value().addPage(owned(3), runs, tets, box).ok());
  ASSERT_TRUE(writer.value().close("{}").ok());
  auto file = hypermesh::File::open(path);
  ASSERT_TRUE(file.ok()) << file.fault().what;
  auto page = file.value().gather(4);
  ASSERT_TRUE(page.ok()) << page.fault().what;
  const std::vector<std::uint64_t> expected{9, 10, 11, 0, 2, 3, 4, 5, 7, 8};
  ASSERT_EQ(page.value().positions.size(), expected.size());
  for (std::uint32_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(page.value().view.globalOf(i), expected[i]);
    EXPECT_EQ(page.value().positions[i], all[expected[i]]);
  }
  EXPECT_TRUE(file.value().verify().ok());
}

TEST(RoundTrip, HypermeshColumns) {
  Scratch scratch;
  const std::string path = scratch.path("m.t4h");
  ASSERT_TRUE(sampleNamed("mesh_columns.t4h").write(path).ok());
  auto file = hypermesh::File::open(path);
  ASSERT_TRUE(file.ok()) << file.fault().what;
  ASSERT_EQ(file.value().columns().size(), 2u);
  EXPECT_STREQ(file.value().columns()[0].name, "pressure");
  EXPECT_EQ(file.value().columns()[1].components, 3u);
  auto page = file.value().gather(0);
  auto pressure = file.value().loadColumn(0, 0), velocity = file.value().loadColumn(1, 0);
  ASSERT_TRUE(page.ok() && pressure.ok() && velocity.ok());
  const auto& vertices = page.value().view.vertices;
  std::vector<float> values(vertices.size() * 3);
  std::memcpy(values.data(), pressure.value().bytes().data(), vertices.size() * 4);
  for (std::size_t v = 0; v < vertices.size(); ++v) EXPECT_EQ(values[v], vertices[v].x * 2);
  std::memcpy(values.data(), velocity.value().bytes().data(), vertices.size() * 12);
  for (std::size_t v = 0; v < vertices.size(); ++v) EXPECT_EQ(values[3 * v + 1], -vertices[v].y);
}

TEST(RoundTrip, DynamicTriangles) {
  Scratch scratch;
  const std::string path = scratch.path("d.t4d");
  const Sheet sheet = makeSheet(2, 1);
  const TrianglePage page = trianglesOf(sheet.pages[0].vertices, sheet.pages[0].tets);
  dyntri::Header header{};
  header.last_time = 1;
  for (const paged::Codec codec : codecs()) {
    auto writer = dyntri::Writer::create(path, header, sheet.times, codec, true);
    ASSERT_TRUE(writer.ok()) << writer.fault().what;
    ASSERT_TRUE(writer.value().addPage(page.view(), 24, page.empty).ok());
    ASSERT_TRUE(writer.value().close("{}").ok());
    auto file = dyntri::File::open(path);
    ASSERT_TRUE(file.ok()) << file.fault().what;
    const auto& h = file.value().header();
    EXPECT_EQ(h.vertices, 18u);
    EXPECT_EQ(h.tets, 24u);
    EXPECT_EQ(h.triangles + h.empty, 4 * 24u);
    auto bytes = file.value().pages().load(0);
    ASSERT_TRUE(bytes.ok());
    auto view = dyntri::validatePage(bytes.value().bytes(), file.value().pages().entries()[0], path, 0);
    ASSERT_TRUE(view.ok()) << view.fault().what;
    EXPECT_TRUE(std::ranges::equal(view.value().vertices, page.vertices));
    EXPECT_TRUE(std::ranges::equal(view.value().triangles, page.triangles));
    EXPECT_TRUE(file.value().verify().ok());
  }
}

TEST(RoundTrip, ThePageDigestDoesNotDependOnTheCodec) {
  Scratch scratch;
  const std::string path = scratch.path("m.t4h");
  const Sheet sheet = makeSheet(2, 3);
  std::vector<std::uint64_t> digests;
  for (const paged::Codec codec : codecs()) {
    auto writer = hypermesh::Writer::create(path, sheet.header, sheet.times, {}, codec, true);
    ASSERT_TRUE(writer.ok());
    for (const auto& page : sheet.pages) {
      ASSERT_TRUE(writer.value().addPage(page.vertices, page.runs, page.tets, page.bounds).ok());
    }
    ASSERT_TRUE(writer.value().close("{}").ok());
    auto file = hypermesh::File::open(path);
    ASSERT_TRUE(file.ok());
    auto digest = file.value().pages().contentDigest();
    ASSERT_TRUE(digest.ok());
    digests.push_back(digest.value());
  }
  EXPECT_EQ(digests.front(), digests.back());
  EXPECT_NE(digests.front(), container::xxh3({}));
}

TEST(RoundTrip, EmptyFilesSaySo) {
  Scratch scratch;
  const std::string mesh = scratch.path("m.t4h"), triangles = scratch.path("d.t4d");
  ASSERT_TRUE(sampleNamed("mesh_empty.t4h").write(mesh).ok());
  ASSERT_TRUE(sampleNamed("triangles_empty.t4d").write(triangles).ok());
  auto m = hypermesh::File::open(mesh);
  ASSERT_TRUE(m.ok()) << m.fault().what;
  EXPECT_EQ(m.value().geometryPages(), 0u);
  EXPECT_EQ(m.value().header().bounds.max, (Vec4f{0, 0, 0, 0}));
  auto d = dyntri::File::open(triangles);
  ASSERT_TRUE(d.ok()) << d.fault().what;
  EXPECT_EQ(d.value().pages().size(), 0u);
}

}  // namespace
}  // namespace tet4d::test

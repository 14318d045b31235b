#include "player/stream/page_source.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/player/swept_mesh.h"

namespace tet4d {
namespace {

using stream::PageSource;

dyntri::File openFile(const std::string& path) {
  auto file = dyntri::File::open(path);
  EXPECT_TRUE(file.ok()) << (file.ok() ? "" : file.fault().what);
  return std::move(file).value();
}

TEST(PageSource, ReadsOnlyWhatIsLoaded) {
  const dyntri::File file = openFile(test::writeTestSphere("source_lazy.t4d", 5));
  PageSource source(file, 1u << 30);
  ASSERT_EQ(source.size(), 4u);
  source.beginFrame();
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(source.resident(i), nullptr);
  EXPECT_EQ(source.bytesTouched(), 0u);

  ASSERT_TRUE(source.load(2).ok());
  EXPECT_EQ(source.bytesTouched(), source.entry(2).bytes);
  ASSERT_NE(source.resident(2), nullptr);
  EXPECT_EQ(source.resident(2)->triangles.size(), source.entry(2).counts[2]);
  EXPECT_EQ(source.resident(1), nullptr);

  ASSERT_TRUE(source.load(2).ok());
  EXPECT_EQ(source.bytesTouched(), source.entry(2).bytes) << "a resident page is not read again";
  source.beginFrame();
  EXPECT_EQ(source.bytesTouched(), 0u);
}

TEST(PageSource, EvictsLeastRecentlyUsedDownToTheBudget) {
  const dyntri::File file = openFile(test::writeTestSphere("source_budget.t4d", 5));
  std::uint64_t largest = 0;
  for (const auto& entry : file.geometryEntries()) largest = std::max(largest, entry.raw_bytes);
  PageSource source(file, 2 * largest);
  for (const std::size_t page : {0U, 1U, 2U}) {
    source.beginFrame();
    ASSERT_TRUE(source.load(page).ok());
    if (page == 2) {
      ASSERT_TRUE(source.load(0).ok());  // 0 is used again, so 1 is the oldest
    }
  }
  source.evict();
  EXPECT_NE(source.resident(0), nullptr);
  EXPECT_EQ(source.resident(1), nullptr);
  EXPECT_NE(source.resident(2), nullptr);
  EXPECT_LE(source.residentBytes(), 2 * largest);
  EXPECT_EQ(source.residentBytes(), source.entry(0).raw_bytes + source.entry(2).raw_bytes);
}

TEST(PageSource, NeverEvictsTheCurrentFrame) {
  const dyntri::File file = openFile(test::writeTestSphere("source_whole.t4d", 4));
  PageSource source(file, 1);
  source.beginFrame();
  for (std::size_t i = 0; i < 3; ++i) ASSERT_TRUE(source.load(i).ok());
  source.evict();
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NE(source.resident(i), nullptr);
  source.beginFrame();
  source.evict();
  EXPECT_EQ(source.residentBytes(), 0u);
}

TEST(PageSource, DamagedPageIsAFaultThatNamesIt) {
  const std::string path = test::writeTestSphere("source_damaged.t4d", 4);
  std::uint64_t offset = 0;
  {
    const dyntri::File file = openFile(path);
    offset = file.geometryEntries()[1].offset + 200;
  }
  std::fstream bytes(path, std::ios::in | std::ios::out | std::ios::binary);
  bytes.seekg(static_cast<std::streamoff>(offset));
  const char old = static_cast<char>(bytes.get());
  bytes.seekp(static_cast<std::streamoff>(offset));
  bytes.put(static_cast<char>(old ^ 1));
  bytes.close();
  const dyntri::File file = openFile(path);
  PageSource source(file, 1u << 30);
  EXPECT_TRUE(source.load(0).ok());
  const Status damaged = source.load(1);
  ASSERT_FALSE(damaged.ok());
  EXPECT_EQ(damaged.fault().code, FaultCode::kBadInput);
  EXPECT_EQ(damaged.fault().file, path);
  EXPECT_NE(damaged.fault().place.find("page 1"), std::string::npos) << damaged.fault().place;
  EXPECT_EQ(source.resident(1), nullptr);
}

TEST(PageSource, DecodesCompressedPages) {
  if (!paged::hasCodec(paged::Codec::kZstd)) GTEST_SKIP() << "this build has no zstd";
  const test::Page page = test::sweep(test::icosphere(1), test::kTestSphere.motion(), 0, 1);
  const std::string path = test::writeFile("source_zstd.t4d", {page}, {{}, {0, 1}, paged::Codec::kZstd});
  const dyntri::File file = openFile(path);
  PageSource source(file, 1u << 30);
  source.beginFrame();
  ASSERT_TRUE(source.load(0).ok());
  EXPECT_TRUE(std::equal(page.vertices.begin(), page.vertices.end(), source.resident(0)->vertices.begin()));
  EXPECT_LT(source.bytesTouched(), source.residentBytes());
}

}  // namespace
}  // namespace tet4d

// Writers keep their promises: what exists is kept, what is not closed leaves nothing, a full disk is said to be full.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <limits>

#include "tests/formats/support/samples.h"
#include "tests/formats/support/scratch.h"

namespace tet4d::test {
namespace {

Result<container::Writer> create(const std::string& path, bool force) {
  return container::Writer::create(path, container::fourCc("TEST"), 1, force);
}

TEST(Writer, ExistingFileIsKeptUnlessForced) {
  Scratch scratch;
  const std::string path = scratch.path("a");
  const std::vector<std::byte> old(3, std::byte{7});
  writeBytes(path, old);
  auto refused = create(path, false);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.fault().remedy.find("--force"), std::string::npos);
  EXPECT_EQ(readBytes(path), old);
  auto forced = create(path, true);
  ASSERT_TRUE(forced.ok());
  EXPECT_EQ(readBytes(path), old) << "until the new file is whole";
  ASSERT_TRUE(forced.value().close().ok());
  EXPECT_TRUE(container::peek(path).ok());
  EXPECT_EQ(scratch.names().size(), 1u);
}

TEST(Writer, AFileThatAppearsMeanwhileIsKept) {
  Scratch scratch;
  const std::string path = scratch.path("a");
  {
    auto writer = create(path, false);
    ASSERT_TRUE(writer.ok());
    const std::vector<std::byte> theirs(5, std::byte{9});
    writeBytes(path, theirs);
    EXPECT_FALSE(writer.value().close().ok());
    EXPECT_EQ(readBytes(path), theirs);
  }
  EXPECT_EQ(scratch.names().size(), 1u);
}

TEST(Writer, WithoutCloseNothingIsLeft) {
  Scratch scratch;
  {
    auto writer = create(scratch.path("a"), false);
    ASSERT_TRUE(writer.ok());
    ASSERT_TRUE(writer.value().add<char>(container::fourCc("SOME"), 0, std::string(100, 'x')).ok());
    EXPECT_EQ(scratch.names().size(), 1u) << "the temporary file";
    EXPECT_NE(scratch.names().front(), "a");
    container::Writer moved = std::move(writer).value();
  }
  EXPECT_TRUE(scratch.names().empty());
}

TEST(Writer, ClosingTwiceIsAFaultAndHarmless) {
  Scratch scratch;
  const std::string path = scratch.path("a");
  auto writer = create(path, false);
  ASSERT_TRUE(writer.ok());
  ASSERT_TRUE(writer.value().close().ok());
  const auto bytes = readBytes(path);
  const Status again = writer.value().close();
  ASSERT_FALSE(again.ok());
  EXPECT_EQ(again.fault().code, FaultCode::kUsage);
  EXPECT_EQ(readBytes(path), bytes);
}

TEST(Writer, NoFolderAndNoFile) {
  Scratch scratch;
  auto nowhere = create(scratch.path("missing/a"), false);
  ASSERT_FALSE(nowhere.ok());
  EXPECT_EQ(nowhere.fault().code, FaultCode::kIo);
  auto standard_output = create("-", false);
  ASSERT_FALSE(standard_output.ok());
  EXPECT_EQ(standard_output.fault().code, FaultCode::kUsage);
}

TEST(Writer, ResultHasOrdinaryPermissions) {
  Scratch scratch;
  const mode_t before = umask(027);
  auto writer = create(scratch.path("a"), false);
  ASSERT_TRUE(writer.ok() && writer.value().close().ok());
  struct stat info {};
  ASSERT_EQ(stat(scratch.path("a").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, mode_t{0640});
  EXPECT_EQ(umask(before), mode_t{027}) << "the mask is left as it was";
}

// A limit on the size of files stands for a full disk: write() fails half way in the same place.
class FullDisk : public testing::Test {
 protected:
  void SetUp() override {
    std::signal(SIGXFSZ, SIG_IGN);
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before_), 0);
  }
  void TearDown() override {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, SIG_DFL);
  }
  void limit(rlim_t bytes) {
    rlimit now = before_;
    now.rlim_cur = bytes;
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &now), 0);
  }
  rlimit before_{};
};

TEST_F(FullDisk, AtEverySizeNothingIsLeft) {
  Scratch scratch;
  for (const Sample& sample : samples()) {
    const std::string path = scratch.path(sample.name);
    ASSERT_TRUE(sample.write(path).ok());
    const std::size_t size = readBytes(path).size();
    ASSERT_EQ(unlink(path.c_str()), 0);
    for (std::size_t room = 0; room < size; room += 61) {
      ASSERT_NO_FATAL_FAILURE(limit(room));
      const Status status = sample.write(path);
      ASSERT_NO_FATAL_FAILURE(limit(before_.rlim_cur));
      ASSERT_FALSE(status.ok()) << sample.name << " in " << room << " bytes";
      EXPECT_EQ(status.fault().code, FaultCode::kNoSpace) << status.fault().what;
      EXPECT_EQ(status.fault().file, path);
      ASSERT_TRUE(scratch.names().empty()) << scratch.names().front();
    }
  }
}

TEST_F(FullDisk, TheOldFileSurvives) {
  Scratch scratch;
  const std::string path = scratch.path("m.t4h");
  const Sample& sample = sampleNamed("mesh.t4h");
  ASSERT_TRUE(sample.write(path).ok());
  const auto old = readBytes(path);
  ASSERT_NO_FATAL_FAILURE(limit(5000));
  EXPECT_FALSE(sample.write(path).ok()) << "samples are written with force";
  ASSERT_NO_FATAL_FAILURE(limit(before_.rlim_cur));
  EXPECT_EQ(readBytes(path), old);
  EXPECT_EQ(scratch.names().size(), 1u);
}

TEST(Writer, LeftoversOfAKilledRunAreInNobodysWay) {
  Scratch scratch;
  const std::string path = scratch.path("a");
  auto first = create(path, false), second = create(path, false);
  ASSERT_TRUE(first.ok() && second.ok()) << "two temporary files beside one name";
  EXPECT_EQ(scratch.names().size(), 2u);
  EXPECT_EQ(first.value().path(), path);
  ASSERT_TRUE(first.value().close().ok());
  EXPECT_FALSE(second.value().close().ok()) << "the name is taken by then";
}

TEST(GridWriter, RefusesWhatReadersWould) {
  Scratch scratch;
  const std::string path = scratch.path("g.t4g");
  grid4::GridHeader good{};
  good.dims[0] = good.dims[1] = good.dims[2] = 2;
  good.sample_type = 1;
  const std::vector<double> times{0, 1};
  const auto refused = [&](grid4::GridHeader header, std::vector<double> t) {
    auto writer = grid4::Writer::create(path, header, t, paged::Codec::kRaw, false);
    return !writer.ok() && writer.fault().file == path;
  };
  auto bad = good;
  bad.dims[1] = 0;
  EXPECT_TRUE(refused(bad, times));
  bad.dims[1] = std::uint64_t{1} << 63;
  EXPECT_TRUE(refused(bad, times)) << "a size that wraps";
  bad = good;
  bad.sample_type = 11;
  EXPECT_TRUE(refused(bad, times));
  bad = good;
  bad.index_to_world.axes[2] = {0, 0, 0};
  EXPECT_TRUE(refused(bad, times));
  EXPECT_TRUE(refused(good, {0, 0}));
  EXPECT_TRUE(refused(good, {0, std::numeric_limits<double>::infinity()}));
  EXPECT_TRUE(scratch.names().empty());

  auto writer = grid4::Writer::create(path, good, times, paged::Codec::kRaw, false);
  ASSERT_TRUE(writer.ok());
  EXPECT_FALSE(writer.value().addFrame(std::vector<std::byte>(7)).ok());
  EXPECT_TRUE(writer.value().addFrame(std::vector<std::byte>(8)).ok());
  const Status early = writer.value().close("{}");
  ASSERT_FALSE(early.ok()) << "a frame is missing";
  EXPECT_EQ(early.fault().file, path);
}

TEST(GridWriter, TimesMayComeWithTheFrames) {
  Scratch scratch;
  const std::string path = scratch.path("g.t4g");
  grid4::GridHeader header{};
  header.dims[0] = header.dims[1] = header.dims[2] = 2;
  header.sample_type = 1;
  const std::vector<std::byte> samples(8, std::byte{7});
  const auto write = [&](const std::vector<double>& times) {
    auto writer = grid4::Writer::create(path, header, {}, paged::Codec::kRaw, true);
    if (!writer.ok()) return false;
    for (const double time : times) {
      if (!writer.value().addFrame(samples, time).ok()) return false;
    }
    return writer.value().close("{}").ok();
  };
  EXPECT_FALSE(write({})) << "no frame has come";
  EXPECT_FALSE(write({1, 1}));
  EXPECT_TRUE(scratch.names().empty());
  ASSERT_TRUE(write({-1, 0.5, 7}));
  const auto file = grid4::File::open(path);
  ASSERT_TRUE(file.ok());
  EXPECT_TRUE(std::ranges::equal(file.value().times(), std::vector<double>{-1, 0.5, 7}));
  EXPECT_TRUE(file.value().verify().ok());
}

TEST(HypermeshWriter, RefusesWhatReadersWould) {
  Scratch scratch;
  const Sheet sheet = makeSheet(1, 1);
  const std::string path = scratch.path("m.t4h");
  using Column = hypermesh::Writer::Column;
  const auto refused = [&](const hypermesh::MeshHeader& header, std::vector<Column> columns) {
    return !hypermesh::Writer::create(path, header, sheet.times, columns, paged::Codec::kRaw, false).ok();
  };
  hypermesh::MeshHeader no_domain = sheet.header;
  no_domain.domain = {};
  EXPECT_TRUE(refused(no_domain, {}));
  hypermesh::MeshHeader flags = sheet.header;
  flags.flags = 4;
  EXPECT_TRUE(refused(flags, {}));
  EXPECT_TRUE(refused(sheet.header, {{"", 1}}));
  EXPECT_TRUE(refused(sheet.header, {{std::string(56, 'n'), 1}})) << "must not be cut short in silence";
  EXPECT_FALSE(refused(sheet.header, {{std::string(55, 'n'), 1}}));
  EXPECT_TRUE(refused(sheet.header, {{"a", 0}}));
  EXPECT_TRUE(refused(sheet.header, {{"a", 5}}));
  EXPECT_TRUE(refused(sheet.header, {{"a", 1}, {"b", 1}, {"a", 3}}));

  const std::vector<Column> columns{{"a", 2}};
  auto writer = hypermesh::Writer::create(path, sheet.header, sheet.times, columns, paged::Codec::kRaw, false);
  ASSERT_TRUE(writer.ok());
  const auto& page = sheet.pages[0];
  EXPECT_FALSE(writer.value().addPage(page.vertices, page.runs, page.tets, page.bounds).ok()) << "a column is missing";
  const std::vector<float> short_values(page.vertices.size() * 2 - 1);
  const std::vector<std::span<const float>> values{short_values};
  EXPECT_FALSE(writer.value().addPage(page.vertices, page.runs, page.tets, page.bounds, values).ok());
}

}  // namespace
}  // namespace tet4d::test

// Every prefix and every damaged byte of a small file of each kind is detected, without touching a byte that is not
// there.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <memory>

#include "tests/formats/support/forge.h"
#include "tests/formats/support/samples.h"
#include "tests/formats/support/scratch.h"

namespace tet4d::test {
namespace {

class HostileBytes : public testing::TestWithParam<Sample> {
 protected:
  void SetUp() override {
    path_ = scratch_.path(GetParam().name);
    const Status status = GetParam().write(path_);
    ASSERT_TRUE(status.ok()) << status.fault().what;
    fd_ = ::open(path_.c_str(), O_RDWR | O_CLOEXEC);
    ASSERT_GE(fd_, 0);
    good_ = readBytes(path_);
    ASSERT_TRUE(openAndVerify(path_, GetParam().payload).ok());
  }
  void TearDown() override { ::close(fd_); }
  void put(std::size_t at, std::byte value) { ASSERT_EQ(::pwrite(fd_, &value, 1, static_cast<off_t>(at)), 1); }

  Scratch scratch_;
  std::string path_;
  int fd_ = -1;
  std::vector<std::byte> good_;
};

void expectCleanFault(const Status& status, const std::string& file, std::size_t where) {
  ASSERT_FALSE(status.ok()) << "byte " << where << " passed";
  ASSERT_EQ(status.fault().code, FaultCode::kBadInput) << where << ": " << status.fault().what;
  ASSERT_EQ(status.fault().file, file);
  ASSERT_FALSE(status.fault().place.empty()) << where;
  ASSERT_FALSE(status.fault().what.empty()) << where;
}

TEST_P(HostileBytes, EveryPrefixIsRefused) {
  for (std::size_t size = good_.size(); size-- > 0;) {
    ASSERT_EQ(::ftruncate(fd_, static_cast<off_t>(size)), 0);
    ASSERT_NO_FATAL_FAILURE(expectCleanFault(openAndVerify(path_, GetParam().payload), path_, size));
  }
}

// The same with a header that says the prefix is all there is.
TEST_P(HostileBytes, EveryPrefixWithAHeaderToMatchIsRefused) {
  for (std::size_t size = good_.size() - 1; size >= sizeof(container::FileHeader); --size) {
    Image image{{good_.begin(), good_.begin() + static_cast<std::ptrdiff_t>(sizeof(container::FileHeader))}};
    image.header().file_bytes = size;
    image.header().header_xxh3 =
        container::xxh3(std::span<const std::byte>(image.bytes).first(offsetof(container::FileHeader, header_xxh3)));
    ASSERT_EQ(::ftruncate(fd_, static_cast<off_t>(size)), 0);
    ASSERT_EQ(::pwrite(fd_, image.bytes.data(), 64, 0), 64);
    ASSERT_NO_FATAL_FAILURE(expectCleanFault(openAndVerify(path_, GetParam().payload), path_, size));
  }
}

TEST_P(HostileBytes, EveryFlippedByteIsDetected) {
  for (std::size_t at = 0; at < good_.size(); ++at) {
    put(at, good_[at] ^ std::byte{0xff});
    ASSERT_NO_FATAL_FAILURE(expectCleanFault(openAndVerify(path_, GetParam().payload), path_, at));
    put(at, good_[at] ^ static_cast<std::byte>(1u << (at % 8)));
    ASSERT_NO_FATAL_FAILURE(expectCleanFault(openAndVerify(path_, GetParam().payload), path_, at));
    put(at, good_[at]);
  }
  EXPECT_TRUE(openAndVerify(path_, GetParam().payload).ok()) << "and the restored file is good again";
}

// A byte of a page flipped by someone who mends the checksums: no crash, and either a fault or a file that can be read.
TEST_P(HostileBytes, EveryFlippedByteWithMendedChecksumsIsSurvived) {
  std::size_t accepted = 0;
  for (std::size_t at = 0; at < good_.size(); ++at) {
    for (const unsigned flip : {0xffu, 1u << (at % 8)}) {
      Image image{good_};
      image.bytes[at] ^= static_cast<std::byte>(flip);
      image.seal();
      ASSERT_EQ(::pwrite(fd_, image.bytes.data(), image.bytes.size(), 0), static_cast<ssize_t>(image.bytes.size()));
      const Status status = openAndVerify(path_, GetParam().payload);
      if (status.ok()) {
        ++accepted;
      } else if (paged::hasCodec(paged::Codec::kZstd) || status.fault().code != FaultCode::kNotBuilt) {
        ASSERT_NO_FATAL_FAILURE(expectCleanFault(status, path_, at));
      }
    }
  }
  EXPECT_LT(accepted, good_.size() * 2);
}

std::string nameOf(const testing::TestParamInfo<Sample>& info) {
  std::string name = info.param.name;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}
INSTANTIATE_TEST_SUITE_P(Samples, HostileBytes, testing::ValuesIn(samples()), nameOf);

// validatePage() on exactly as many bytes as there are: a sanitizer build sees any step beyond.
template <class Validate>
void checkPagePrefixes(std::span<const std::byte> page, Validate validate) {
  ASSERT_TRUE(validate(page).ok());
  for (std::size_t size = 0; size < page.size(); ++size) {
    const std::unique_ptr<std::byte[]> exact(new std::byte[size]);
    std::copy_n(page.begin(), size, exact.get());
    ASSERT_FALSE(validate(std::span<const std::byte>(exact.get(), size)).ok()) << size << " bytes";
  }
}

TEST(PagePrefix, OfAHypermeshIsRefused) {
  Scratch scratch;
  const std::string path = scratch.path("a.t4h");
  ASSERT_TRUE(sampleNamed("mesh.t4h").write(path).ok());
  auto file = hypermesh::File::open(path);
  ASSERT_TRUE(file.ok());
  const auto& entry = file.value().geometryEntry(0);
  auto page = file.value().pages().load(0);
  checkPagePrefixes(page.value().bytes(), [&](std::span<const std::byte> bytes) {
    return hypermesh::validatePage(bytes, entry, file.value().header(), path, 0);
  });
}

TEST(PagePrefix, OfDynamicTrianglesIsRefused) {
  Scratch scratch;
  const std::string path = scratch.path("a.t4d");
  ASSERT_TRUE(sampleNamed("triangles.t4d").write(path).ok());
  auto file = dyntri::File::open(path);
  ASSERT_TRUE(file.ok());
  const auto& entry = file.value().pages().entries()[0];
  auto page = file.value().pages().load(0);
  checkPagePrefixes(page.value().bytes(),
                    [&](std::span<const std::byte> bytes) { return dyntri::validatePage(bytes, entry, path, 0); });
}

TEST(PagePrefix, OfASurfaceSequenceIsRefused) {
  Scratch scratch;
  const std::string path = scratch.path("a.t4q");
  ASSERT_TRUE(sampleNamed("surface.t4q").write(path).ok());
  auto file = surface_sequence::File::open(path);
  ASSERT_TRUE(file.ok());
  const auto& entry = file.value().frameEntry(1);
  auto page = file.value().pages().load(1);
  checkPagePrefixes(page.value().bytes(), [&](std::span<const std::byte> bytes) {
    return surface_sequence::validatePage(bytes, entry, file.value().header(), path, 1);
  });
}

TEST(PagePrefix, OfAPatchDagIsRefused) {
  Scratch scratch;
  const std::string path = scratch.path("a.t4p");
  ASSERT_TRUE(sampleNamed("dag.t4p").write(path).ok());
  auto file = patch_dag::File::open(path);
  ASSERT_TRUE(file.ok());
  const auto& entry = file.value().patchEntry(1);
  auto page = file.value().pages().load(1);
  checkPagePrefixes(page.value().bytes(),
                    [&](std::span<const std::byte> bytes) { return patch_dag::validatePage(bytes, entry, path, 1); });
}

}  // namespace
}  // namespace tet4d::test

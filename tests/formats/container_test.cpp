// The container by itself: what opens, what is found, what is refused before anything is read.
#include "formats/container.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <cstring>

#include "tests/formats/support/samples.h"
#include "tests/formats/support/scratch.h"

namespace tet4d::container {
namespace {

constexpr std::uint32_t kTestPayload = fourCc("TEST");
constexpr std::uint32_t kNumbers = fourCc("NUMS");

Status writeSmall(const std::string& path, std::uint16_t version, std::uint32_t extra_flags) {
  auto writer = Writer::create(path, kTestPayload, version, true);
  if (!writer.ok()) return writer.fault();
  const std::array<std::uint64_t, 3> numbers{1, std::uint64_t{1} << 40, ~std::uint64_t{0}};
  if (Status s = writer.value().add<std::uint64_t>(kNumbers, kSectionRequired, numbers); !s.ok()) return s;
  if (Status s = writer.value().add<char>(fourCc("MORE"), extra_flags, std::string("extra")); !s.ok()) return s;
  if (Status s = writer.value().add<char>(kProvenance, 0, std::string(R"({"a":1})")); !s.ok()) return s;
  return writer.value().close();
}

TEST(Container, FourCcReadsAsTextInTheFile) {
  const std::uint32_t code = fourCc("HYPM");
  EXPECT_EQ(std::memcmp(&code, "HYPM", 4), 0);
  EXPECT_EQ(fourCcText(code), "HYPM");
  EXPECT_EQ(fourCcText(fourCc("A\n\x7f ")), "A\\x0a\\x7f ");
}

TEST(Container, ChecksumIsXxh3WithSeedZero) {
  EXPECT_EQ(xxh3({}), 0x2d06800538d394c2u);  // of nothing, from the algorithm's specification
}

TEST(Container, SectionsComeBack) {
  test::Scratch scratch;
  const std::string path = scratch.path("a");
  ASSERT_TRUE(writeSmall(path, 3, 0).ok());
  auto reader = Reader::open(path, kTestPayload, 3, std::array{kNumbers});
  ASSERT_TRUE(reader.ok()) << reader.fault().what;
  auto numbers = reader.value().items<std::uint64_t>(kNumbers);
  ASSERT_TRUE(numbers.ok());
  EXPECT_EQ(numbers.value().size(), 3u);
  EXPECT_EQ(numbers.value()[2], ~std::uint64_t{0});
  EXPECT_EQ(reader.value().provenance(), R"({"a":1})");
  EXPECT_EQ(reader.value().header().payload_version, 3);
  EXPECT_TRUE(reader.value().verifyAll().ok());
  EXPECT_FALSE(reader.value().items<std::uint32_t>(kNumbers).ok()) << "items of another size";
  EXPECT_FALSE(reader.value().single<std::uint64_t>(kNumbers).ok()) << "three items are not one";
  EXPECT_FALSE(reader.value().items<std::uint64_t>(fourCc("NONE")).ok());
  auto peeked = peek(path);
  ASSERT_TRUE(peeked.ok());
  EXPECT_EQ(peeked.value().payload, kTestPayload);
  const Reader moved = std::move(reader).value();
  EXPECT_EQ(moved.items<std::uint64_t>(kNumbers).value()[1], std::uint64_t{1} << 40);
}

TEST(Container, UnknownRequiredSectionIsRefusedAndOptionalSkipped) {
  test::Scratch scratch;
  const std::string path = scratch.path("a");
  ASSERT_TRUE(writeSmall(path, 1, kSectionRequired).ok());
  auto refused = Reader::open(path, kTestPayload, 1, std::array{kNumbers});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.fault().code, FaultCode::kBadInput);
  EXPECT_EQ(refused.fault().place, "section MORE");
  EXPECT_TRUE(Reader::open(path, kTestPayload, 1, std::array{kNumbers, fourCc("MORE")}).ok());
  EXPECT_TRUE(Reader::open(path, 0, 0, {}).ok()) << "a program that only looks takes any";
  ASSERT_TRUE(writeSmall(path, 1, 0).ok());
  EXPECT_TRUE(Reader::open(path, kTestPayload, 1, std::array{kNumbers}).ok());
}

TEST(Container, OtherPayloadsAndNewerVersionsAreRefused) {
  test::Scratch scratch;
  const std::string path = scratch.path("a");
  ASSERT_TRUE(writeSmall(path, 2, 0).ok());
  EXPECT_FALSE(Reader::open(path, kTestPayload, 1, std::array{kNumbers}).ok());
  EXPECT_FALSE(Reader::open(path, fourCc("ELSE"), 2, std::array{kNumbers}).ok());
  for (const test::Sample& sample : test::samples()) {
    ASSERT_TRUE(sample.write(path).ok());
    const auto other = sample.payload == grid4::kPayload ? hypermesh::kPayload : grid4::kPayload;
    const Status status = test::openAndVerify(path, other);
    ASSERT_FALSE(status.ok()) << sample.name;
    EXPECT_EQ(status.fault().place, "header");
  }
}

TEST(Container, WhatIsNoRegularFileIsRefusedAtOnce) {
  test::Scratch scratch;
  const auto missing = Reader::open(scratch.path("missing"), 0, 0, {});
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.fault().code, FaultCode::kIo);
  EXPECT_FALSE(Reader::open(scratch.path("."), 0, 0, {}).ok());
  EXPECT_FALSE(Reader::open("/dev/null", 0, 0, {}).ok());
  const std::string pipe = scratch.path("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_FALSE(Reader::open(pipe, 0, 0, {}).ok()) << "and without waiting for a writer";
}

TEST(Container, DamageIsNamed) {
  test::Scratch scratch;
  const std::string path = scratch.path("a");
  const auto faultOf = [&](std::vector<std::byte> bytes) {
    test::writeBytes(path, bytes);
    auto opened = Reader::open(path, kTestPayload, 1, std::array{kNumbers});
    EXPECT_FALSE(opened.ok());
    EXPECT_EQ(opened.fault().code, FaultCode::kBadInput);
    EXPECT_EQ(opened.fault().file, path);
    EXPECT_FALSE(opened.fault().remedy.empty());
    return opened.fault().what;
  };
  ASSERT_TRUE(writeSmall(path, 1, 0).ok());
  const std::vector<std::byte> good = test::readBytes(path);
  auto text_mode = good;
  text_mode.erase(text_mode.begin() + 3);  // \r\n became \n
  EXPECT_NE(faultOf(text_mode).find("magic"), std::string::npos);
  auto longer = good;
  longer.resize(good.size() + 1);
  EXPECT_NE(faultOf(longer).find(std::to_string(good.size())), std::string::npos) << "says both sizes";
  auto foreign = good;
  foreign[0] = std::byte{'P'};
  EXPECT_NE(faultOf(foreign).find("not a tet4d file"), std::string::npos);
  EXPECT_NE(faultOf({}).find("0 bytes"), std::string::npos);
}

}  // namespace
}  // namespace tet4d::container

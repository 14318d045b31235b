// Files forged field by field, with every checksum right: the structural check itself must catch each, and say where.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/formats/support/bad_files.h"
#include "tests/formats/support/samples.h"
#include "tests/formats/support/scratch.h"

namespace tet4d::test {
namespace {

class ForgedFile : public testing::TestWithParam<BadFile> {};

TEST_P(ForgedFile, IsRefusedAndSaysWhere) {
  const BadFile& bad = GetParam();
  Scratch scratch;
  const std::string path = scratch.path(bad.name);
  writeBytes(path, bytesOf(bad));
  bool opened = false;
  const Status status = openAndVerify(path, sampleNamed(bad.sample).payload, &opened);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.fault().code, FaultCode::kBadInput);
  EXPECT_EQ(status.fault().file, path);
  EXPECT_EQ(status.fault().place.substr(0, bad.place.size()), bad.place) << status.fault().what;
  EXPECT_NE(status.fault().what.find(bad.what), std::string::npos)
      << status.fault().place << ": " << status.fault().what;
  EXPECT_EQ(opened, !bad.at_open) << status.fault().what;
}

std::string nameOf(const testing::TestParamInfo<BadFile>& info) {
  std::string name = info.param.name;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}
INSTANTIATE_TEST_SUITE_P(Tables, ForgedFile, testing::ValuesIn(badTables()), nameOf);
INSTANTIATE_TEST_SUITE_P(Contents, ForgedFile, testing::ValuesIn(badContents()), nameOf);

// The forger's own tool must not be what makes the files bad.
TEST(Forge, ResealingAGoodFileChangesNothing) {
  Scratch scratch;
  for (const Sample& sample : samples()) {
    const std::string path = scratch.path(sample.name);
    ASSERT_TRUE(sample.write(path).ok());
    Image image = Image::of(path);
    image.seal();
    EXPECT_EQ(image.bytes, readBytes(path)) << sample.name;
  }
}

}  // namespace
}  // namespace tet4d::test

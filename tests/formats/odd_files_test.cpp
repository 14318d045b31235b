// Files no writer of ours makes, but that the formats allow, are taken and mean the same.
#include <gtest/gtest.h>

#include <random>

#include "tests/formats/support/dump.h"
#include "tests/formats/support/forge.h"
#include "tests/formats/support/samples.h"
#include "tests/formats/support/scratch.h"

namespace tet4d::test {
namespace {

TEST(OddFiles, AreAcceptedAndMeanTheSame) {
  Scratch scratch;
  const std::string path = scratch.path("plain"), odd = scratch.path("odd");
  std::mt19937 random(20080401);
  for (const Sample& sample : samples()) {
    ASSERT_TRUE(sample.write(path).ok());
    auto expected = dumpOf(path, sample.payload);
    ASSERT_TRUE(expected.ok()) << sample.name;
    const Layout layout = Layout::of(path);
    for (int variant = 0; variant < 25; ++variant) {
      writeBytes(odd, layout.oddly(random));
      auto dump = dumpOf(odd, sample.payload);
      ASSERT_TRUE(dump.ok()) << sample.name << " " << variant << ": " << dump.fault().place << ": "
                             << dump.fault().what;
      EXPECT_EQ(dump.value(), expected.value()) << sample.name << " " << variant;
    }
  }
}

TEST(OddFiles, WithoutProvenance) {
  Scratch scratch;
  const std::string path = scratch.path("m.t4h");
  ASSERT_TRUE(sampleNamed("mesh.t4h").write(path).ok());
  Layout layout = Layout::of(path);
  std::erase_if(layout.sections, [](const auto& s) { return s.kind == container::kProvenance; });
  std::mt19937 random(1);
  writeBytes(path, layout.oddly(random));
  auto file = hypermesh::File::open(path);
  ASSERT_TRUE(file.ok());
  EXPECT_EQ(file.value().reader().provenance(), "{}");
}

}  // namespace
}  // namespace tet4d::test

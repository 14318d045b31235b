// Files kept for ever. golden/: today's writers give the same bytes, and every later reader must read the same content.
// golden_bad/: must go on being refused, with the fault and place written down beside them.
//
// To make them anew after a deliberate change of version: TET4D_WRITE_GOLDEN=1 formats_test --gtest_filter='Golden.*'
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/formats/support/bad_files.h"
#include "tests/formats/support/dump.h"
#include "tests/formats/support/samples.h"
#include "tests/formats/support/scratch.h"

namespace tet4d::test {
namespace {

const std::string kFolder = TET4D_FORMATS_DIR;
const bool kWrite = std::getenv("TET4D_WRITE_GOLDEN") != nullptr;

std::uint32_t payloadOf(const std::string& name) {
  if (name.ends_with(".t4g")) return grid4::kPayload;
  if (name.ends_with(".t4q")) return surface_sequence::kPayload;
  if (name.ends_with(".t4p")) return patch_dag::kPayload;
  return name.ends_with(".t4h") ? hypermesh::kPayload : dyntri::kPayload;
}

// The bad files worth keeping: one or two for each layer.
const std::vector<std::string> kBad{"header_version.t4g",
                                    "section_items_wrap.t4g",
                                    "section_unknown_required.t4g",
                                    "section_time_paged.t4g",
                                    "page_bomb.t4g",
                                    "page_overlaps.t4g",
                                    "grid_dims_wrap.t4g",
                                    "mesh_page_run_overlaps.t4h",
                                    "mesh_page_tet_range.t4h",
                                    "mesh_column_same_name.t4h",
                                    "triangles_page_life_longer.t4d",
                                    "triangles_page_edge_backward.t4d",
                                    "triangles_page_alive_cut.t4d",
                                    "triangles_page_band_gap.t4d",
                                    "surface_triangle_range.t4q",
                                    "surface_page_outside.t4q",
                                    "dag_node_error_grows.t4p",
                                    "dag_node_bounds_apart.t4p",
                                    "dag_arc_upwards.t4p",
                                    "dag_page_tet_range.t4p"};

// What earlier versions' writers made; it goes on being read.
const std::vector<std::string> kKept{"triangles_v1.t4d", "triangles_one_v1.t4d", "triangles_gaps_zstd_v1.t4d"};

std::vector<BadFile> allBad() {
  std::vector<BadFile> all = badTables();
  for (auto& bad : badContents()) all.push_back(std::move(bad));
  return all;
}

// Lines of a manifest, cut at '|'.
std::vector<std::vector<std::string>> manifest(const std::string& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file) << path;
  std::vector<std::vector<std::string>> lines;
  for (std::string line; std::getline(file, line);) {
    std::istringstream cut(line);
    lines.emplace_back();
    for (std::string word; std::getline(cut, word, '|');) lines.back().push_back(word);
  }
  return lines;
}

TEST(Golden, WriteAnewIfAsked) {
  if (!kWrite) GTEST_SKIP() << "TET4D_WRITE_GOLDEN is not set";
  std::ofstream digests(kFolder + "/golden/digests.txt"), faults(kFolder + "/golden_bad/faults.txt");
  for (const Sample& sample : samples()) {
    const std::string path = kFolder + "/golden/" + sample.name;
    ASSERT_TRUE(sample.write(path).ok());
    EXPECT_LE(readBytes(path).size(), std::size_t{16} << 10) << sample.name;
    digests << sample.name << '|' << digestOf(path, sample.payload).value() << '\n';
  }
  for (const std::string& name : kKept)
    digests << name << '|' << digestOf(kFolder + "/golden/" + name, payloadOf(name)).value() << '\n';
  const std::vector<BadFile> all = allBad();
  for (const std::string& name : kBad) {
    const auto bad = std::ranges::find_if(all, [&](const BadFile& b) { return b.name == name; });
    ASSERT_NE(bad, all.end()) << name;
    writeBytes(kFolder + "/golden_bad/" + name, bytesOf(*bad));
    const Status status = openAndVerify(kFolder + "/golden_bad/" + name, payloadOf(name));
    ASSERT_FALSE(status.ok());
    faults << name << '|' << static_cast<int>(status.fault().code) << '|' << status.fault().place << '|' << bad->what
           << '\n';
  }
}

TEST(Golden, WritersGiveTheSameBytes) {
  Scratch scratch;
  for (const Sample& sample : samples()) {
    if (!sample.exact) continue;
    const std::string path = scratch.path(sample.name);
    ASSERT_TRUE(sample.write(path).ok());
    EXPECT_EQ(readBytes(path), readBytes(kFolder + "/golden/" + sample.name)) << sample.name;
  }
}

TEST(Golden, AreReadForEver) {
  const auto lines = manifest(kFolder + "/golden/digests.txt");
  EXPECT_GE(lines.size(), 25u);
  for (const auto& line : lines) {
    ASSERT_EQ(line.size(), 2u);
    const std::string path = kFolder + "/golden/" + line[0];
    auto digest = digestOf(path, payloadOf(line[0]));
    if (!digest.ok() && digest.fault().code == FaultCode::kNotBuilt) continue;  // a build without zstd says so
    ASSERT_TRUE(digest.ok()) << line[0] << ": " << digest.fault().place << ": " << digest.fault().what;
    EXPECT_EQ(digest.value(), line[1]) << line[0];
  }
}

TEST(Golden, BadOnesAreRefusedForEver) {
  const auto lines = manifest(kFolder + "/golden_bad/faults.txt");
  EXPECT_EQ(lines.size(), kBad.size());
  for (const auto& line : lines) {
    ASSERT_EQ(line.size(), 4u);
    const Status status = openAndVerify(kFolder + "/golden_bad/" + line[0], payloadOf(line[0]));
    ASSERT_FALSE(status.ok()) << line[0];
    EXPECT_EQ(static_cast<int>(status.fault().code), std::stoi(line[1])) << line[0];
    EXPECT_EQ(status.fault().place, line[2]) << line[0];
    EXPECT_NE(status.fault().what.find(line[3]), std::string::npos) << line[0] << ": " << status.fault().what;
  }
}

}  // namespace
}  // namespace tet4d::test

#include "player/stream/pager.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <random>
#include <thread>

#include "tests/player/swept_mesh.h"

namespace tet4d {
namespace {

using stream::Pager;
using stream::Want;

dyntri::File openFile(const std::string& path) {
  auto file = dyntri::File::open(path);
  EXPECT_TRUE(file.ok()) << (file.ok() ? "" : file.fault().what);
  return std::move(file).value();
}

std::uint64_t rawBytes(const dyntri::File& file, std::size_t page) { return file.geometryEntries()[page].raw_bytes; }

std::uint64_t largestPage(const dyntri::File& file) {
  std::uint64_t most = 0;
  for (const auto& entry : file.geometryEntries()) most = std::max(most, entry.raw_bytes);
  return (most + 4095) / 4096 * 4096;
}

// A frame that needs `now` and looks forward to `next`, in that order.
void frame(Pager& pager, const std::vector<std::size_t>& now, const std::vector<std::size_t>& next = {}) {
  std::vector<Want> wants;
  for (const std::size_t page : now) wants.push_back({page, 0});
  for (const std::size_t page : next) wants.push_back({page, static_cast<double>(wants.size())});
  pager.beginFrame();
  pager.want(wants);
  pager.waitFor(now);
}

// Until everything asked for has come: the pages show at the next frame.
void settle(Pager& pager, std::uint64_t read) {
  while (pager.totals().read < read) std::this_thread::yield();
}

bool sameAsFile(const dyntri::File& file, const Pager& pager, std::size_t page) {
  const auto loaded = file.loadGeometry(page);
  if (!loaded.ok() || pager.resident(page) == nullptr) return false;
  const auto view = dyntri::validatePage(loaded.value().bytes(), file.geometryEntries()[page], "", page);
  const dyntri::PageView& ours = *pager.resident(page);
  const auto same = [](auto a, auto b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
  };
  return view.ok() && same(view.value().vertices, ours.vertices) && same(view.value().edges, ours.edges) &&
         same(view.value().lifespans, ours.lifespans) && same(view.value().triangles, ours.triangles);
}

void flipByte(const std::string& path, std::uint64_t offset) {
  std::fstream bytes(path, std::ios::in | std::ios::out | std::ios::binary);
  bytes.seekg(static_cast<std::streamoff>(offset));
  const char old = static_cast<char>(bytes.get());
  bytes.seekp(static_cast<std::streamoff>(offset));
  bytes.put(static_cast<char>(old ^ 1));
}

// A budget that shrinks is kept from the next frame on; one that grows is used.
TEST(Pager, ABudgetMayChangeWhilePagesAreHeld) {
  const dyntri::File file = openFile(test::writeTestSphere("pager_change.t4d", 9));
  const std::uint64_t page = largestPage(file);
  Pager pager(file, {4 * page, 1, 1});
  EXPECT_EQ(pager.budget(), 4 * page);
  frame(pager, {0}, {1, 2, 3});
  settle(pager, 4 * file.geometryEntries()[0].bytes);
  EXPECT_GT(pager.totals().held, 2 * page);
  pager.setBudget(2 * page);
  for (std::size_t k = 4; k < 8; ++k) {
    frame(pager, {k}, {k + 1 < 8 ? k + 1 : 0});
    EXPECT_TRUE(sameAsFile(file, pager, k));
    EXPECT_LE(pager.totals().held, 2 * page) << k;
  }
  pager.setBudget(8 * page);
  const std::uint64_t before = pager.totals().read;
  frame(pager, {0}, {1, 2, 3});
  settle(pager, before + 3 * file.geometryEntries()[0].bytes);
  EXPECT_GT(pager.totals().held, 2 * page);
}

TEST(Pager, ReadsOnlyWhatIsWanted) {
  const dyntri::File file = openFile(test::writeTestSphere("pager_lazy.t4d", 5));
  Pager pager(file, {});
  ASSERT_EQ(pager.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(pager.resident(i), nullptr);
  frame(pager, {2});
  EXPECT_TRUE(sameAsFile(file, pager, 2));
  EXPECT_EQ(pager.resident(1), nullptr);
  EXPECT_EQ(pager.frameReads().touched, file.geometryEntries()[2].bytes);
  frame(pager, {2});
  EXPECT_EQ(pager.frameReads().touched, 0u) << "a resident page is not read again";
  EXPECT_EQ(pager.totals().read, file.geometryEntries()[2].bytes);
  EXPECT_EQ(pager.totals().unused, 0u);
}

TEST(Pager, BringsPagesInBeforeTheyAreNeeded) {
  const dyntri::File file = openFile(test::writeTestSphere("pager_ahead.t4d", 5));
  Pager pager(file, {});
  const std::uint64_t first_two = file.geometryEntries()[0].bytes + file.geometryEntries()[1].bytes;
  frame(pager, {0}, {1});
  EXPECT_EQ(pager.frameReads().touched, file.geometryEntries()[0].bytes);
  EXPECT_EQ(pager.frameReads().prefetched, 0u);
  settle(pager, first_two);
  while (pager.resident(1) == nullptr) {  // proved a little after it is read
    pager.beginFrame();
    std::this_thread::yield();
  }
  EXPECT_EQ(pager.totals().unused, file.geometryEntries()[1].bytes);
  frame(pager, {1});
  EXPECT_EQ(pager.frameReads().touched, file.geometryEntries()[1].bytes);
  EXPECT_EQ(pager.frameReads().prefetched, file.geometryEntries()[1].bytes);
  EXPECT_EQ(pager.totals().read, first_two);
  EXPECT_EQ(pager.totals().unused, 0u);
}

TEST(Pager, DropsWhatWasUsedLongestAgo) {
  const dyntri::File file = openFile(test::writeTestSphere("pager_lru.t4d", 5));
  Pager pager(file, {2 * largestPage(file), 1, 1});
  frame(pager, {0});
  frame(pager, {1});
  frame(pager, {0});
  frame(pager, {2});  // of 0 and 1, 1 is the older
  EXPECT_NE(pager.resident(0), nullptr);
  EXPECT_EQ(pager.resident(1), nullptr);
  EXPECT_NE(pager.resident(2), nullptr);
}

TEST(Pager, WhatComesSoonIsNotDroppedForWhatComesLater) {
  const dyntri::File file = openFile(test::writeTestSphere("pager_thrash.t4d", 9));
  Pager pager(file, {3 * largestPage(file), 1, 1});
  std::uint64_t all = 0;
  for (const auto& entry : file.geometryEntries()) all += entry.bytes;
  for (std::size_t page = 0; page < pager.size(); ++page) {
    std::vector<std::size_t> next(pager.size() - page - 1);
    std::iota(next.begin(), next.end(), page + 1);
    frame(pager, {page}, next);
    ASSERT_TRUE(sameAsFile(file, pager, page));
  }
  EXPECT_EQ(pager.totals().read, all) << "each page once";
  EXPECT_EQ(pager.totals().unused, 0u);
}

TEST(Pager, AnyBudgetAndThreadsGiveTheSamePagesWithinTheBudget) {
  const dyntri::File file = openFile(test::writeTestSphere("pager_random.t4d", 12));
  const std::uint64_t page = largestPage(file);
  for (const auto& [budget, io, decode] : {std::tuple<std::uint64_t, unsigned, unsigned>{0, 1, 1},
                                           {page, 2, 2},
                                           {2 * page, 1, 3},
                                           {3 * page + 5, 3, 1},
                                           {5 * page, 2, 2},
                                           {~std::uint64_t{0}, 4, 4}}) {
    Pager pager(file, {budget, io, decode});
    std::mt19937 random(7);
    std::uint64_t most = 0;
    for (int i = 0; i < 150; ++i) {
      std::vector<std::size_t> pages(pager.size());
      std::iota(pages.begin(), pages.end(), std::size_t{0});
      std::shuffle(pages.begin(), pages.end(), random);
      const auto middle = pages.begin() + 1 + static_cast<std::ptrdiff_t>(random() % 2);
      const std::vector<std::size_t> now(pages.begin(), middle);
      frame(pager, now, {middle, pages.end()});
      for (const std::size_t p : now) ASSERT_TRUE(sameAsFile(file, pager, p)) << "budget " << budget << ", frame " << i;
      most = std::max(most, pager.totals().peak);
    }
    EXPECT_LE(most, std::max(budget, 2 * page)) << "a frame's own two pages may exceed the budget, nothing else";
    EXPECT_TRUE(pager.takeFaults().empty());
  }
}

TEST(Pager, WithoutWaitingNothingBlocksAndEverythingComes) {
  const dyntri::File file = openFile(test::writeTestSphere("pager_draw.t4d", 6));
  Pager pager(file, {2 * largestPage(file), 2, 1});
  for (std::size_t page = 0; page < pager.size(); ++page) {
    while (pager.resident(page) == nullptr) {
      pager.beginFrame();
      const Want now{page, 0};
      pager.want({&now, 1});
      std::this_thread::yield();
    }
    EXPECT_TRUE(sameAsFile(file, pager, page));
  }
}

TEST(Pager, DecodesCompressedPagesWithinTheBudget) {
  if (!paged::hasCodec(paged::Codec::kZstd)) GTEST_SKIP() << "this build has no zstd";
  std::vector<test::Page> pages;
  for (int k = 0; k < 6; ++k) pages.push_back(test::sweep(test::icosphere(2), test::kTestSphere.motion(), k, k + 1));
  const dyntri::File file =
      openFile(test::writeFile("pager_zstd.t4d", pages, {{}, {0, 1, 2, 3, 4, 5, 6}, paged::Codec::kZstd}));
  const std::uint64_t budget = 4 * largestPage(file);
  Pager pager(file, {budget, 1, 2});
  for (std::size_t page = 0; page < 6; ++page) {
    frame(pager, {page}, {(page + 1) % 6, (page + 2) % 6});
    EXPECT_TRUE(sameAsFile(file, pager, page));
    EXPECT_LT(pager.frameReads().touched, rawBytes(file, page));
  }
  EXPECT_LE(pager.totals().peak, budget);
}

// Three pages with a column of one value and one of three; values tell page, column and row.
std::string writeColumns(const std::string& name, paged::Codec codec) {
  const std::vector<double> times{0, 1, 2, 3};
  const std::vector<Column> columns{{"heat", 1}, {"normal", 3}};
  dyntri::Header header{};
  header.last_time = 3;
  const std::string path = test::temporaryDirectory() + "/" + name;
  auto writer = dyntri::Writer::create(path, header, times, codec, true, columns);
  EXPECT_TRUE(writer.ok());
  for (int k = 0; k < 3; ++k) {
    const test::Page page = test::sweep(test::icosphere(1), test::kTestSphere.motion(), k, k + 1);
    std::vector<float> heat(page.vertices.size()), normal(3 * page.vertices.size());
    for (std::size_t i = 0; i < heat.size(); ++i) heat[i] = static_cast<float>(1000 * k) + static_cast<float>(i);
    for (std::size_t i = 0; i < normal.size(); ++i) normal[i] = -static_cast<float>(i);
    const std::vector<std::span<const float>> values{heat, normal};
    EXPECT_TRUE(writer.value().addPage(page.view(), 1, 0, values).ok());
  }
  EXPECT_TRUE(writer.value().close("{}").ok());
  return path;
}

TEST(Pager, ReadsOnlyTheColumnsInUse) {
  for (const paged::Codec codec : {paged::Codec::kRaw, paged::Codec::kZstd}) {
    if (!paged::hasCodec(codec)) continue;
    const dyntri::File file = openFile(writeColumns("pager_columns.t4d", codec));
    const auto entries = file.pages().entries();
    ASSERT_EQ(entries.size(), 9u);
    Pager pager(file, {});
    ASSERT_EQ(pager.size(), 3u);
    frame(pager, {1});
    EXPECT_EQ(pager.totals().read, entries[3].bytes);
    EXPECT_TRUE(pager.residentColumn(1, 0).empty());
    const std::size_t normal[] = {1};
    pager.useColumns(normal);
    frame(pager, {1}, {2});
    EXPECT_EQ(pager.frameReads().touched, entries[5].bytes);
    EXPECT_TRUE(pager.residentColumn(1, 0).empty());
    ASSERT_EQ(pager.residentColumn(1, 1).size(), 3 * pager.resident(1)->vertices.size());
    EXPECT_EQ(pager.residentColumn(1, 1)[7], -7);
    EXPECT_TRUE(pager.residentColumn(1, 2).empty()) << "no such column";
    const std::size_t both[] = {0, 1};
    pager.useColumns(both);
    frame(pager, {2});
    ASSERT_EQ(pager.residentColumn(2, 0).size(), pager.resident(2)->vertices.size());
    EXPECT_EQ(pager.residentColumn(2, 0)[5], 2005);
    EXPECT_EQ(pager.residentColumn(2, 1)[4], -4);
    EXPECT_EQ(pager.totals().read,
              entries[3].bytes + entries[5].bytes + entries[6].bytes + entries[7].bytes + entries[8].bytes);
  }
}

TEST(PagerStiff, ADamagedColumnIsAFaultOfItsPageOnlyWhereItIsInUse) {
  const std::string path = writeColumns("pager_column_damaged.t4d", paged::Codec::kRaw);
  flipByte(path, openFile(path).pages().entries()[4].offset + 3);
  const dyntri::File file = openFile(path);
  Pager pager(file, {});
  frame(pager, {1});
  EXPECT_EQ(pager.faultOf(1), nullptr);
  const std::size_t heat[] = {0};
  pager.useColumns(heat);
  frame(pager, {0, 1});
  EXPECT_EQ(pager.faultOf(0), nullptr);
  ASSERT_NE(pager.faultOf(1), nullptr);
  EXPECT_EQ(pager.faultOf(1)->place, "page 4");
  EXPECT_NE(pager.resident(1), nullptr) << "it is drawn without its column";
  EXPECT_TRUE(pager.residentColumn(1, 0).empty());
}

TEST(PagerStiff, NoPagesAndOnePage) {
  const dyntri::File none = openFile(test::writeFile("pager_none.t4d", {}, {{}, {0, 1}, paged::Codec::kRaw}));
  Pager empty(none, {0, 1, 1});
  frame(empty, {});
  EXPECT_EQ(empty.size(), 0u);
  const dyntri::File one = openFile(test::writeTestSphere("pager_one.t4d", 2));
  Pager single(one, {1, 1, 1});
  for (int i = 0; i < 3; ++i) {
    frame(single, {0, 0});
    EXPECT_TRUE(sameAsFile(one, single, 0));
  }
  EXPECT_EQ(single.totals().read, one.pages().entries()[0].bytes) << "what is used stays, whatever the budget";
}

TEST(PagerStiff, ABudgetOfNothingKeepsTheFrameAndNoMore) {
  const dyntri::File file = openFile(test::writeTestSphere("pager_zero.t4d", 4));
  Pager pager(file, {0, 1, 1});
  frame(pager, {0, 1, 2});
  for (std::size_t page = 0; page < 3; ++page) EXPECT_TRUE(sameAsFile(file, pager, page));
  frame(pager, {});
  for (std::size_t page = 0; page < 3; ++page) EXPECT_EQ(pager.resident(page), nullptr);
  frame(pager, {1}, {2});
  EXPECT_EQ(pager.resident(2), nullptr) << "nothing ahead fits";
}

TEST(PagerStiff, ADamagedPageIsNamedOnceAndTheOthersPlayOn) {
  const std::string path = test::writeTestSphere("pager_damaged.t4d", 4);
  flipByte(path, openFile(path).pages().entries()[1].offset + 200);
  const dyntri::File file = openFile(path);
  Pager pager(file, {});
  for (int i = 0; i < 3; ++i) {
    frame(pager, {0, 1, 2});
    EXPECT_NE(pager.resident(0), nullptr);
    EXPECT_EQ(pager.resident(1), nullptr);
    EXPECT_NE(pager.resident(2), nullptr);
  }
  const auto faults = pager.takeFaults();
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].file, path);
  EXPECT_EQ(faults[0].place, "page 1");
  EXPECT_EQ(faults[0].code, FaultCode::kBadInput);
  EXPECT_TRUE(pager.takeFaults().empty());
  ASSERT_NE(pager.faultOf(1), nullptr);
  EXPECT_EQ(pager.faultOf(1)->what, faults[0].what);
  EXPECT_EQ(pager.faultOf(0), nullptr);
}

TEST(PagerStiff, AFileCutOffWhileOpenIsAFaultNotASignal) {
  const std::string path = test::writeTestSphere("pager_cut.t4d", 6);
  const dyntri::File file = openFile(path);
  Pager pager(file, {});
  frame(pager, {0});
  std::filesystem::resize_file(path, file.geometryEntries()[2].offset + 10);
  frame(pager, {0, 1, 2, 3, 4});
  EXPECT_TRUE(pager.resident(0) != nullptr && pager.resident(1) != nullptr);
  EXPECT_EQ(pager.resident(1)->triangles.size(), file.geometryEntries()[1].counts[2]) << "the table is still there";
  for (const std::size_t page : {2u, 3u, 4u}) {
    EXPECT_EQ(pager.resident(page), nullptr);
    ASSERT_NE(pager.faultOf(page), nullptr);
    EXPECT_NE(pager.faultOf(page)->place.find("page " + std::to_string(page)), std::string::npos);
    EXPECT_NE(pager.faultOf(page)->remedy.find("cut off"), std::string::npos) << pager.faultOf(page)->remedy;
  }
  const auto faults = pager.takeFaults();
  EXPECT_EQ(std::count_if(faults.begin(), faults.end(), [](const Fault& f) { return f.place.empty(); }), 1)
      << "that it was changed is said once";
  EXPECT_EQ(file.times().size(), 6u);
}

TEST(PagerStiff, AFileReplacedWhileOpenPlaysOnAndIsNamedOnce) {
  const std::string path = test::writeTestSphere("pager_replaced.t4d", 4);
  const std::string other = test::writeTestSphere("pager_other.t4d", 9);
  const dyntri::File file = openFile(path);
  Pager pager(file, {});
  frame(pager, {0});
  EXPECT_TRUE(pager.takeFaults().empty());
  std::filesystem::rename(other, path);
  frame(pager, {1});
  frame(pager, {2});
  EXPECT_TRUE(sameAsFile(file, pager, 1));
  EXPECT_TRUE(sameAsFile(file, pager, 2));
  const auto faults = pager.takeFaults();
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].file, path);
  EXPECT_NE(faults[0].what.find("replaced"), std::string::npos);
}

TEST(PagerStiff, EndsWhileMuchIsOnTheWay) {
  const dyntri::File file = openFile(test::writeTestSphere("pager_end.t4d", 12));
  for (int i = 0; i < 20; ++i) {
    Pager pager(file, {3 * largestPage(file), 2, 2});
    std::vector<Want> wants;
    for (std::size_t page = 0; page < pager.size(); ++page) wants.push_back({page, static_cast<double>(page)});
    pager.beginFrame();
    pager.want(wants);
    std::reverse(wants.begin(), wants.end());
    for (std::size_t k = 0; k < wants.size(); ++k) wants[k].urgency = static_cast<double>(k);
    pager.want(wants);
  }
}

}  // namespace
}  // namespace tet4d

// Temporary files: what is scattered comes back in order, what is sorted is sorted whatever fits into memory, and a
// folder is taken over by the run it belongs to and by no other.
#include "libpreprocess/outofcore/work_folder.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <string>
#include <tuple>

#include "libpreprocess/error.h"
#include "libpreprocess/outofcore/external_sort.h"
#include "libpreprocess/outofcore/record_files.h"

namespace tet4d::outofcore {
namespace {

namespace fs = std::filesystem;

struct Record {
  std::uint32_t key, sequence;
  bool operator==(const Record&) const = default;
};
struct ByKey {
  bool operator()(const Record& a, const Record& b) const {
    return std::tie(a.key, a.sequence) < std::tie(b.key, b.sequence);
  }
};

class Folders : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = (fs::temp_directory_path() / ("tet4d_folder_" + std::to_string(::getpid()))).string();
    fs::remove_all(path_);
  }
  void TearDown() override { fs::remove_all(path_); }
  std::string path_;
};

FaultCode codeOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_FALSE(error.fault().remedy.empty());
    return error.fault().code;
  }
  ADD_FAILURE() << "nothing was thrown";
  return FaultCode::kBadInput;
}

TEST_F(Folders, RecordsComeBackInTheOrderTheyWereAdded) {
  fs::create_directory(path_);
  BucketFiles buckets(path_ + "/b", 5, 1);  // the least buffers: many flushes
  std::vector<std::vector<Record>> expected(5);
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    const Record record{i * 2654435761U, i};
    const std::size_t bucket = record.key % 4;  // the last stays empty
    expected[bucket].push_back(record);
    buckets.add(bucket, record);
  }
  buckets.finish();
  for (std::size_t b = 0; b < 5; ++b) {
    EXPECT_EQ(buckets.bytes(b), expected[b].size() * sizeof(Record));
    EXPECT_EQ(readRecords<Record>(buckets.path(b)), expected[b]);
    RecordReader<Record> reader(buckets.path(b), 100);
    std::vector<Record> streamed;
    for (Record record{}; reader.next(record);) streamed.push_back(record);
    EXPECT_EQ(streamed, expected[b]);
    const MappedFile mapped(buckets.path(b));
    EXPECT_EQ(mapped.records<Record>().size(), expected[b].size());
  }
}

TEST_F(Folders, SortingDoesNotDependOnMemory) {
  fs::create_directory(path_);
  std::mt19937 random(7);
  std::vector<Record> records;
  for (std::uint32_t i = 0; i < 30'000; ++i) records.push_back({static_cast<std::uint32_t>(random() % 1000), i});
  std::vector<Record> expected = records;
  std::sort(expected.begin(), expected.end(), ByKey{});
  for (const std::size_t memory : {std::size_t{0}, std::size_t{4096}, std::size_t{100'000}, std::size_t{1} << 24}) {
    ExternalSort<Record, ByKey> sort(path_ + "/runs", memory);
    if (memory == 0) records.resize(500), expected = records, std::sort(expected.begin(), expected.end(), ByKey{});
    for (const Record& record : records) sort.add(record);
    std::vector<Record> sorted;
    sort.finish([&](const Record& record) { sorted.push_back(record); });
    EXPECT_EQ(sorted, expected) << memory;
  }
  EXPECT_TRUE(fs::is_empty(path_)) << "runs are removed";
}

TEST_F(Folders, AFolderVanishesUnlessItIsKept) {
  {
    WorkFolder folder(path_, "run", false);
    writeFile(folder.file("x"), {});
  }
  EXPECT_FALSE(fs::exists(path_));
  {
    WorkFolder folder(path_, "run", false);
    writeFile(folder.file("x"), {});
    folder.record("first");
    folder.keep();
  }
  EXPECT_TRUE(fs::exists(path_ + "/x"));
  {
    WorkFolder folder(path_, "run", true);
    EXPECT_TRUE(folder.isResumed());
    EXPECT_TRUE(folder.isDone("first"));
    EXPECT_FALSE(folder.isDone("fir"));
    EXPECT_FALSE(folder.isDone("run"));
    EXPECT_TRUE(fs::exists(path_ + "/x"));
    folder.record("second");
    folder.keep();
  }
  {
    WorkFolder folder(path_, "run", true);
    EXPECT_TRUE(folder.isDone("first") && folder.isDone("second"));
    folder.keep();
  }
  // Without --resume it begins anew.
  WorkFolder folder(path_, "another", false);
  EXPECT_FALSE(folder.isResumed() || folder.isDone("first") || fs::exists(path_ + "/x"));
}

TEST_F(Folders, ALineThatAKillCutOffCountsForNothing) {
  {
    WorkFolder folder(path_, "run", false);
    folder.record("cell 0 12");
    folder.keep();
  }
  std::ofstream(path_ + "/journal", std::ios::app) << "cell 0 1";  // of "cell 0 13"
  {
    WorkFolder folder(path_, "run", true);
    EXPECT_TRUE(folder.isDone("cell 0 12"));
    EXPECT_FALSE(folder.isDone("cell 0 1"));
    folder.record("cell 0 2");
    folder.keep();
  }
  const WorkFolder folder(path_, "run", true);
  EXPECT_TRUE(folder.isDone("cell 0 2"));
  EXPECT_FALSE(folder.isDone("cell 0 1")) << "nor later";
}

TEST_F(Folders, OtherRunsOtherFoldersAndFoldersInUseAreRefused) {
  {
    WorkFolder folder(path_, "run", false);
    EXPECT_EQ(codeOf([&] { const WorkFolder again(path_, "run", true); }), FaultCode::kIo) << "in use";
    EXPECT_EQ(codeOf([&] { const WorkFolder again(path_, "run", false); }), FaultCode::kIo) << "in use";
    folder.keep();
  }
  EXPECT_EQ(codeOf([&] { const WorkFolder other(path_, "other", true); }), FaultCode::kUsage);
  EXPECT_TRUE(fs::exists(path_ + "/journal")) << "what is refused is left alone";
  fs::remove_all(path_);
  fs::create_directory(path_);
  std::ofstream(path_ + "/mine") << "x";
  EXPECT_EQ(codeOf([&] { const WorkFolder other(path_, "run", false); }), FaultCode::kIo);
  EXPECT_TRUE(fs::exists(path_ + "/mine"));
}

}  // namespace
}  // namespace tet4d::outofcore

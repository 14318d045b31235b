#include "libpreprocess/outofcore/output_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "libpreprocess/error.h"

namespace tet4d::outofcore {
namespace {

namespace fs = std::filesystem;

class OutputFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    directory_ = fs::path(::testing::TempDir()) / (std::string("output_file_") + info->name());
    fs::remove_all(directory_);
    fs::create_directory(directory_);
  }
  void TearDown() override { fs::remove_all(directory_); }

  std::string path(const std::string& name) const { return directory_ / name; }
  static std::string content(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  std::set<std::string> names() const {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(directory_)) all.insert(entry.path().filename());
    return all;
  }
  template <class Action>
  static Fault faultOf(Action action) {
    try {
      action();
    } catch (const Error& error) {
      return error.fault();
    }
    ADD_FAILURE() << "no Error was thrown";
    return {};
  }

  fs::path directory_;
};

TEST_F(OutputFileTest, AppearsAtCommitOnly) {
  OutputFile file(path("a.ply"), false);
  file.write(std::string_view("vertices "));
  file.print("%d", 12);
  EXPECT_EQ(file.bytesWritten(), 11u);
  EXPECT_FALSE(fs::exists(path("a.ply")));
  file.commit();
  EXPECT_EQ(content(path("a.ply")), "vertices 12");
  EXPECT_EQ(names(), std::set<std::string>{"a.ply"});
}

TEST_F(OutputFileTest, WithoutCommitNothingIsLeft) {
  { OutputFile(path("a.ply"), false).write(std::string_view("half")); }
  EXPECT_TRUE(names().empty());
}

TEST_F(OutputFileTest, MovedFileCommitsOnce) {
  OutputFile first(path("a"), false);
  first.write(std::string_view("x"));
  OutputFile second(std::move(first));
  second.writeValue<std::uint16_t>(0x6261);
  second.commit();
  EXPECT_EQ(content(path("a")), "xab");
}

TEST_F(OutputFileTest, AnExistingFileIsKept) {
  std::ofstream(path("a")) << "old";
  const Fault fault = faultOf([&] { OutputFile(path("a"), false); });
  EXPECT_EQ(fault.code, FaultCode::kIo);
  EXPECT_NE(fault.remedy.find("--force"), std::string::npos);
  EXPECT_EQ(content(path("a")), "old");
  EXPECT_EQ(names(), std::set<std::string>{"a"});
}

TEST_F(OutputFileTest, AFileThatAppearsMeanwhileIsKept) {
  OutputFile file(path("a"), false);
  file.write(std::string_view("new"));
  std::ofstream(path("a")) << "other";
  EXPECT_EQ(faultOf([&] { file.commit(); }).code, FaultCode::kIo);
  EXPECT_EQ(content(path("a")), "other");
}

TEST_F(OutputFileTest, ForceReplaces) {
  std::ofstream(path("a")) << "old and longer";
  OutputFile file(path("a"), true);
  file.write(std::string_view("new"));
  EXPECT_EQ(content(path("a")), "old and longer");
  file.commit();
  EXPECT_EQ(content(path("a")), "new");
}

TEST_F(OutputFileTest, PermissionsFollowTheMask) {
  const mode_t mask = ::umask(027);
  OutputFile file(path("a"), false);
  file.commit();
  ::umask(mask);
  struct stat info {};
  ASSERT_EQ(::stat(path("a").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777u, 0640u);
}

TEST_F(OutputFileTest, AMissingDirectoryIsNamed) {
  const Fault fault = faultOf([&] { OutputFile(path("nowhere/a"), false); });
  EXPECT_EQ(fault.code, FaultCode::kIo);
  EXPECT_EQ(fault.file, path("nowhere/a"));
  EXPECT_FALSE(fault.remedy.empty());
}

TEST_F(OutputFileTest, ADirectoryIsNoOutput) {
  EXPECT_EQ(faultOf([&] { OutputFile(directory_, true); }).code, FaultCode::kIo);
}

TEST_F(OutputFileTest, AFullDiskIsNoSpace) {
  if (!fs::exists("/dev/full")) GTEST_SKIP();
  const Fault small = faultOf([&] {
    OutputFile file("/dev/full", false);
    EXPECT_TRUE(file.isStream());
    file.write(std::string_view("stays in the buffer until commit"));
    file.commit();
  });
  EXPECT_EQ(small.code, FaultCode::kNoSpace);
  const Fault large = faultOf([&] {
    OutputFile file("/dev/full", false);
    const std::string block(1 << 20, 'x');
    file.write(block);
  });
  EXPECT_EQ(large.code, FaultCode::kNoSpace);
  EXPECT_FALSE(large.remedy.empty());
  const Fault stream = faultOf([&] {
    OutputFile file("/dev/full", false);
    for (int i = 0; i < 100000; ++i) std::fputs("a library's own writes", file.stream());
    file.commit();
  });
  EXPECT_EQ(stream.code, FaultCode::kNoSpace) << "what commit() finds after writes failed elsewhere";
  EXPECT_TRUE(fs::exists("/dev/full"));
}

TEST_F(OutputFileTest, RefuseExistingSparesDevices) {
  std::ofstream(path("a")) << "old";
  EXPECT_THROW(refuseExisting(path("a"), false), Error);
  EXPECT_NO_THROW(refuseExisting(path("a"), true));
  EXPECT_NO_THROW(refuseExisting(path("b"), false));
  EXPECT_NO_THROW(refuseExisting("/dev/null", false));
  EXPECT_NO_THROW(refuseExisting("-", false));
}

}  // namespace
}  // namespace tet4d::outofcore

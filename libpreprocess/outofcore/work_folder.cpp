#include "libpreprocess/outofcore/work_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "libpreprocess/error.h"

namespace tet4d::outofcore {
namespace {

constexpr std::string_view kMagic = "tet4d work folder 1 ";
constexpr const char* kJournal = "journal";

[[noreturn]] void fail(const std::string& path, const std::string& what, const std::string& remedy) {
  throw Error(FaultCode::kIo, path, "", what, remedy);
}

// Complete lines only: a kill may leave a part of one.
std::vector<std::string> readLines(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line) && !file.eof();) lines.push_back(line);
  return lines;
}

}  // namespace

WorkFolder::WorkFolder(std::string path, std::string_view name, bool resume) : path_(std::move(path)) {
  try {
    open(name, resume);
  } catch (...) {
    if (journal_ >= 0) ::close(journal_);
    throw;
  }
}

void WorkFolder::open(std::string_view name, bool resume) {
  namespace fs = std::filesystem;
  std::error_code error;
  const std::string journal = file(kJournal), title = std::string(kMagic) + std::string(name);
  std::vector<std::string> lines;
  if (!fs::create_directory(path_, error)) {
    if (error) fail(path_, "cannot be made: " + error.message(), "name another --temp-dir");
    lines = readLines(journal);
    const bool is_ours = !lines.empty() && lines[0].starts_with(kMagic);
    if (!is_ours && !fs::is_empty(path_, error))
      fail(path_, "is there already and is not a folder of temporary files",
           "move it away, or name another --temp-dir");
    resumed_ = resume && is_ours;
    if (resumed_ && lines[0] != title)
      throw Error(FaultCode::kUsage, path_, "", "was left by a run with other options or another input",
                  "repeat its options, or leave --resume out to begin anew");
    if (resumed_) lines_.assign(lines.begin() + 1, lines.end());
  }
  journal_ = ::open(journal.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (journal_ < 0) fail(journal, std::string("cannot be opened: ") + std::strerror(errno), "");
  if (::flock(journal_, LOCK_EX | LOCK_NB) != 0)
    fail(path_, "another run works in it", "wait for it, or name another --temp-dir");
  if (resumed_) {
    std::size_t bytes = lines[0].size() + 1;  // without a last line that a kill cut off
    for (const std::string& line : lines_) bytes += line.size() + 1;
    if (::ftruncate(journal_, static_cast<off_t>(bytes)) != 0)
      fail(journal, std::string("cannot be cut off: ") + std::strerror(errno), "");
    return;
  }
  for (const auto& entry : fs::directory_iterator(path_, error))
    if (entry.path().filename() != kJournal) fs::remove_all(entry.path(), error);
  if (::ftruncate(journal_, 0) != 0) fail(journal, std::string("cannot be emptied: ") + std::strerror(errno), "");
  record(title);
}

WorkFolder::~WorkFolder() {
  std::error_code ignored;
  if (!kept_) std::filesystem::remove_all(path_, ignored);
  ::close(journal_);
}

bool WorkFolder::isDone(std::string_view line) const {
  return std::find(lines_.begin(), lines_.end(), line) != lines_.end();
}

void WorkFolder::record(std::string_view line) {
  const std::string text = std::string(line) + "\n";
  if (::write(journal_, text.data(), text.size()) == static_cast<ssize_t>(text.size())) return;
  const int error_number = errno;
  const bool full = error_number == ENOSPC || error_number == EDQUOT;
  throw Error(full ? FaultCode::kNoSpace : FaultCode::kIo, file(kJournal), "",
              std::string("cannot be written: ") + std::strerror(error_number),
              full ? "free some space, or name another --temp-dir" : "");
}

}  // namespace tet4d::outofcore

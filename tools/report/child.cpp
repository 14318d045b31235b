#include "tools/report/child.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "libpreprocess/error.h"
#include "libpreprocess/outofcore/progress.h"

namespace tet4d::report {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostText = 65536;

std::string textOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  text.resize(std::min(text.size(), kMostText));
  return text;
}

std::string lastLine(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.find_last_of('\n') + 1);
}

double secondsOf(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

// Waits for the child; asked to stop, it asks the child in turn.
int await(pid_t child, rusage& usage) {
  int status = 0;
  bool told = false;
  while (true) {
    const pid_t ended = ::wait4(child, &status, told ? 0 : WNOHANG, &usage);
    if (ended == child) return status;
    if (ended < 0 && errno != EINTR) return -1;
    if (!told && outofcore::interruptRequested()) {
      ::kill(child, SIGTERM);
      told = true;
    }
    if (!told) ::usleep(1000);
  }
}

// The system's error number, 0 if it runs.
int start(const std::string& path, std::vector<char*>& words, const std::string& folder, pid_t& child) {
  const std::string out = folder + "/stdout", err = folder + "/stderr";
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&actions, 2, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int error = ::posix_spawnp(&child, path.c_str(), &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

}  // namespace

std::string ownFolder() {
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error);
  return error ? "" : self.parent_path().string();
}

ChildRun Programs::run(const std::string& program, const std::vector<std::string>& arguments,
                       const std::string& stats) const {
  const std::string path = bin_.empty() ? program : (fs::path(bin_) / program).string();
  std::vector<std::string> words{path};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  std::error_code ignored;
  if (!stats.empty()) fs::remove(stats, ignored);

  ChildRun result;
  const auto begin = std::chrono::steady_clock::now();
  pid_t child = 0;
  if (const int error = start(path, pointers, work_, child); error != 0) {
    result.exit_code = 127;
    result.fault = path + ": " + std::strerror(error);
    return result;
  }
  rusage usage{};
  const int status = await(child, usage);
  result.seconds_wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  result.seconds_cpu = secondsOf(usage.ru_utime) + secondsOf(usage.ru_stime);
  result.peak_bytes = static_cast<std::uint64_t>(std::max(0L, usage.ru_maxrss)) * 1024;
  outofcore::Progress().step(0);  // throws if this program was asked to stop
  result.exit_code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  result.output = textOf(work_ + "/stdout");
  if (result.exit_code != 0) {
    const std::string said = lastLine(textOf(work_ + "/stderr"));
    result.fault = said.empty() ? program + ": ended with " + std::to_string(result.exit_code) : said;
    return result;
  }
  if (!stats.empty() && fs::exists(stats, ignored)) {
    try {
      result.record = measure::readRunRecord(stats);
    } catch (const Error& error) {
      result.exit_code = 1;
      result.fault = error.fault().file + ": " + error.fault().what;
    }
  }
  return result;
}

ChildRun Programs::median(const std::string& program, const std::vector<std::string>& arguments,
                          const std::string& stats, std::uint64_t repeat) const {
  std::vector<ChildRun> runs;
  for (std::uint64_t k = 0; k < std::max<std::uint64_t>(1, repeat); ++k) {
    runs.push_back(run(program, arguments, stats));
    if (runs.back().exit_code != 0) return runs.back();
  }
  const auto middle = runs.begin() + static_cast<std::ptrdiff_t>((runs.size() - 1) / 2);
  std::nth_element(runs.begin(), middle, runs.end(),
                   [](const ChildRun& a, const ChildRun& b) { return a.seconds_wall < b.seconds_wall; });
  return *middle;
}

}  // namespace tet4d::report

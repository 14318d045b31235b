#include "tools/common/files.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "libpreprocess/error.h"

namespace tet4d::cli {

namespace {

namespace fs = std::filesystem;

// A file as one option or positional names it.
struct Named {
  std::string shown, path;
  bool exists = false;
  struct stat info {};
};

Named named(const Option& option, const std::string& path) {
  Named one{option.positional ? option.flags : "--" + option.name(), path};
  one.exists = ::stat(path.c_str(), &one.info) == 0;
  return one;
}

// The texts of an option that names files; none for other kinds of option.
std::vector<std::string> textsOf(const Option& option) {
  if (const auto* one = std::get_if<std::string*>(&option.binding)) return {**one};
  if (const auto* many = std::get_if<std::vector<std::string>*>(&option.binding)) return **many;
  return {};
}

fs::path placeOf(const fs::path& path) {
  std::error_code ignored;
  return fs::weakly_canonical(fs::absolute(path, ignored), ignored);
}

bool isSameFile(const Named& a, const Named& b) {
  if (a.exists != b.exists) return false;
  if (!a.exists) return placeOf(a.path) == placeOf(b.path);
  return S_ISREG(a.info.st_mode) && a.info.st_dev == b.info.st_dev && a.info.st_ino == b.info.st_ino;
}

bool isIn(const Named& file, const fs::path& directory) {
  return placeOf(file.path).parent_path() == placeOf(directory / "x").parent_path();
}

// Whether `file` may be one of those that the pattern "dir/a_%04d.nrrd" stands for.
bool mayBeOneOf(const Named& file, const std::string& pattern) {
  const fs::path path(pattern);
  const std::string name = path.filename().string(), own = fs::path(file.path).filename().string();
  const std::size_t percent = name.find('%');
  return percent != std::string::npos && own.starts_with(name.substr(0, percent)) &&
         fs::path(own).extension() == path.extension() && isIn(file, path.parent_path());
}

bool hasVolumeSuffix(const std::string& path) {
  static constexpr std::array<std::string_view, 5> kSuffixes{".nrrd", ".nhdr", ".raw", ".gz", ".t4g"};
  return std::find(kSuffixes.begin(), kSuffixes.end(), fs::path(path).extension().string()) != kSuffixes.end();
}

[[noreturn]] void fail(const Named& output, const std::string& what) {
  throw Error(FaultCode::kUsage, {}, output.shown, fmt::format("'{}' {}", output.path, what), "name another file");
}

void refuseOverlap(const Named& output, const Named& input, bool force) {
  if (isSameFile(output, input)) {
    fail(output, fmt::format("is the same file as the input {} '{}', which would be lost", input.shown, input.path));
  }
  if (!output.exists || !S_ISREG(output.info.st_mode)) return;
  if (!input.exists && mayBeOneOf(output, input.path)) {
    fail(output, fmt::format("may be one of the inputs {} '{}'", input.shown, input.path));
  }
  const bool in_doubt = (force && output.shown == "--output") || hasVolumeSuffix(output.path);
  if (input.exists && S_ISDIR(input.info.st_mode) && in_doubt && isIn(output, input.path)) {
    fail(output, fmt::format("exists in the directory of inputs {} '{}'", input.shown, input.path));
  }
}

}  // namespace

void refuseOverlaps(const Command& command) {
  std::vector<Named> inputs, outputs;
  for (const Option& option : command.options()) {
    const bool is_output = (option.traits & kIsOutput) != 0;
    const bool is_input = option.positional || option.value_name == "FILE" || (option.traits & kIsInput) != 0;
    if (!is_output && !is_input) continue;
    for (const std::string& path : textsOf(option)) {
      if (!path.empty() && path != "-") (is_output ? outputs : inputs).push_back(named(option, path));
    }
  }
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (const Named& input : inputs) refuseOverlap(outputs[i], input, command.commonOptions().force);
    for (std::size_t k = 0; k < i; ++k) {
      if (isSameFile(outputs[i], outputs[k])) {
        fail(outputs[i], fmt::format("is the same file as {} '{}'", outputs[k].shown, outputs[k].path));
      }
    }
  }
}

void expectSuffix(const Session& session, std::string_view suffix, std::string_view remedy) {
  const std::string& output = session.options().output;
  if (output.empty() || output == "-" || fs::path(output).extension() == suffix) return;
  throw Error(FaultCode::kUsage, {}, "--output",
              fmt::format("'{}' does not end in {}, which is what {} writes", output, suffix, session.program()),
              std::string(remedy));
}

}  // namespace tet4d::cli

#include "libpreprocess/exchange/file_series.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <string_view>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/frame_file.h"
#include "libpreprocess/exchange/printf_pattern.h"

namespace tet4d::exchange {
namespace {

namespace fs = std::filesystem;

bool isDigit(char c) { return c >= '0' && c <= '9'; }

std::size_t digitsAt(std::string_view text, std::size_t begin) {
  std::size_t end = begin;
  while (end < text.size() && isDigit(text[end])) ++end;
  return end - begin;
}

std::vector<std::string> namesIn(const fs::path& directory) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(directory, error), end; !error && it != end; it.increment(error)) {
    names.push_back(it->path().filename().string());
  }
  if (error) {
    throw Error(FaultCode::kIo, directory.string(), "", "the directory cannot be read: " + error.message(),
                "check the name and the permission to read");
  }
  return names;
}

struct SplitName {
  std::string_view before, digits, after;
};

// The last number of a file's name and what stands around it; "frame_12.nrrd" → "frame_", "12", ".nrrd".
std::optional<SplitName> splitAtLastNumber(std::string_view name) {
  std::size_t end = name.size();
  const std::size_t slash = name.find_last_of('/');
  const std::size_t first = slash == std::string_view::npos ? 0 : slash + 1;
  const std::size_t dot = name.find_last_of('.');
  if (dot != std::string_view::npos && dot > first) end = dot;  // not the 4 of ".mp4"
  while (end > first && !isDigit(name[end - 1])) --end;
  std::size_t begin = end;
  while (begin > first && isDigit(name[begin - 1])) --begin;
  if (begin == end || end - begin > 18) return std::nullopt;
  return SplitName{name.substr(0, begin), name.substr(begin, end - begin), name.substr(end)};
}

// What a file is by its suffix; empty for what is no frame. Raw files count where raw ones are looked for: beside
// headers they are their data.
std::string_view kindOf(const std::string& name, bool raw) {
  for (const std::string_view suffix : {".raw", ".bin", ".dat"}) {
    if (raw && name.ends_with(suffix)) return suffix;
  }
  return frameFormatOf(name);
}

}  // namespace

bool naturalLess(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!isDigit(a[i]) || !isDigit(b[j])) {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i, ++j;
      continue;
    }
    std::string_view m = std::string_view(a).substr(i, digitsAt(a, i)),
                     n = std::string_view(b).substr(j, digitsAt(b, j));
    i += m.size();
    j += n.size();
    while (m.size() > 1 && m.front() == '0') m.remove_prefix(1);
    while (n.size() > 1 && n.front() == '0') n.remove_prefix(1);
    if (m.size() != n.size()) return m.size() < n.size();
    if (m != n) return m < n;
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;  // equal but for zeros in front
}

std::vector<std::string> filesOfDirectory(const std::string& directory, bool raw) {
  return filesOfDirectory(
      directory, [raw](const std::string& name) { return std::string(kindOf(name, raw)); },
      raw ? ".raw, .bin, .dat" : frameSuffixes());
}

std::vector<std::string> filesOfDirectory(const std::string& directory,
                                          const std::function<std::string(const std::string&)>& format_of,
                                          const std::string& suffixes) {
  std::vector<std::string> files;
  for (const std::string& name : namesIn(directory)) {
    if (!format_of(name).empty()) files.push_back((fs::path(directory) / name).string());
  }
  if (files.empty()) {
    throw Error(FaultCode::kBadInput, directory, "", "the directory holds no " + suffixes + " files",
                "name the frames' files");
  }
  std::sort(files.begin(), files.end(), naturalLess);
  for (const std::string& file : files) {
    if (format_of(file) == format_of(files.front())) continue;
    throw Error(FaultCode::kBadInput, directory, "",
                "holds files of two kinds, " + files.front() + " and " + file + " among them",
                "give a pattern of one of them, such as a_%04d" + fs::path(files.front()).extension().string());
  }
  return files;
}

std::vector<std::string> filesOfPattern(const std::string& pattern) {
  const fs::path path(pattern);
  const auto name_pattern = NumberPattern::parse(path.filename().string());
  if (!name_pattern) {
    throw Error(FaultCode::kUsage, pattern, "", "is neither a file nor a pattern with one %d in the file's name",
                "write a pattern such as alpha_%04d.nrrd");
  }
  std::vector<std::pair<std::int64_t, std::string>> found;
  for (const std::string& name : namesIn(path.has_parent_path() ? path.parent_path() : fs::path("."))) {
    if (const auto number = name_pattern->numberOf(name))
      found.emplace_back(*number, (path.parent_path() / name).string());
  }
  if (found.empty()) {
    throw Error(FaultCode::kBadInput, pattern, "", "no file has such a name",
                "check the pattern; " + name_pattern->name(0) + " would be its first");
  }
  std::sort(found.begin(), found.end());
  std::vector<std::string> files;
  for (auto& [number, file] : found) files.push_back(std::move(file));
  return files;
}

std::optional<std::vector<std::int64_t>> fileNumbers(const std::vector<std::string>& files) {
  std::vector<std::int64_t> numbers;
  const auto first = splitAtLastNumber(files.front());
  for (const std::string& file : files) {
    const auto split = splitAtLastNumber(file);
    if (!split || split->before != first->before || split->after != first->after) return std::nullopt;
    numbers.push_back(std::stoll(std::string(split->digits)));
  }
  return numbers;
}

bool hasCommonStep(const std::vector<std::int64_t>& numbers) {
  std::int64_t step = std::numeric_limits<std::int64_t>::max();
  for (std::size_t k = 1; k < numbers.size(); ++k) step = std::min(step, numbers[k] - numbers[k - 1]);
  if (numbers.size() < 2 || step <= 0) return false;
  for (std::size_t k = 1; k < numbers.size(); ++k) {
    if ((numbers[k] - numbers[k - 1]) % step != 0) return false;
  }
  return true;
}

void checkNumbering(const std::vector<std::string>& files, const std::vector<std::int64_t>& numbers, bool allow_gaps) {
  std::int64_t step = std::numeric_limits<std::int64_t>::max();
  for (std::size_t k = 1; k < numbers.size(); ++k) {
    if (numbers[k] <= numbers[k - 1]) {
      throw Error(FaultCode::kBadInput, files[k], "",
                  "frame number " + std::to_string(numbers[k]) + " comes after number " +
                      std::to_string(numbers[k - 1]) + " (" + files[k - 1] + "), and the files tell no times",
                  "give the frames in time order; a directory or a pattern with %d is put in order");
    }
    step = std::min(step, numbers[k] - numbers[k - 1]);
  }
  if (allow_gaps) return;
  for (std::size_t k = 1; k < numbers.size(); ++k) {
    const std::int64_t distance = numbers[k] - numbers[k - 1];
    if (distance == step) continue;
    const std::string around = files[k - 1] + " and " + files[k];
    if (distance % step == 0) {
      throw Error(FaultCode::kBadInput, around, "",
                  "frame number " + std::to_string(numbers[k - 1] + step) +
                      " is missing between them (the others are " + std::to_string(step) + " apart)",
                  "add the missing frame, or accept the hole with --allow-gaps");
    }
    throw Error(FaultCode::kBadInput, around, "",
                "their numbers are " + std::to_string(distance) + " apart, others are " + std::to_string(step) +
                    " apart: no common step",
                "give the files times (time:=T), or accept with --allow-gaps");
  }
}

}  // namespace tet4d::exchange

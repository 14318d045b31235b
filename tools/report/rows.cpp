#include "tools/report/rows.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <thread>

#include "libpreprocess/error.h"
#include "libpreprocess/outofcore/output_file.h"

namespace tet4d::report {
namespace {

using nlohmann::ordered_json;

constexpr auto kReplace = ordered_json::error_handler_t::replace;

std::string machineText() {
  std::ifstream file("/proc/cpuinfo");
  std::string name = "unknown processor";
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (!line.starts_with("model name") || colon == std::string::npos) continue;
    name = line.substr(colon + 2);
    break;
  }
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  return name + ", " + std::to_string(cores) + (cores == 1 ? " core" : " cores");
}

std::string csvField(const ordered_json& value) {
  if (value.is_null()) return "";
  const std::string text = value.is_string() ? value.get<std::string>() : value.dump(-1, ' ', false, kReplace);
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

constexpr const char* kKeys[] = {"sweep", "input", "digest", "program", "arguments", "case"};

bool sameRun(const Row& a, const Row& b) {
  return std::all_of(std::begin(kKeys), std::end(kKeys), [&](const char* key) {
    return a.contains(key) == b.contains(key) && (!a.contains(key) || a.at(key) == b.at(key));
  });
}

}  // namespace

double loadAverage() {
  std::ifstream file("/proc/loadavg");
  double load = 0;
  file >> load;
  return load;
}

Context contextOf(const std::string& commit, const std::string& bin, const Programs& programs) {
  Context context{commit, machineText()};
  if (!commit.empty()) return context;
  const Programs system("", programs.work());
  const ChildRun git = system.run("git", {"-C", bin.empty() ? "." : bin, "describe", "--always", "--dirty=+"});
  context.commit = git.exit_code == 0 ? git.output.substr(0, git.output.find('\n')) : "unknown";
  return context;
}

ordered_json number(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr); }

Row beginRow(const std::string& sweep, const std::string& input, const std::string& digest, const std::string& program,
             const std::vector<std::string>& arguments) {
  std::string line;
  for (const std::string& word : arguments) {
    if (!line.empty()) line += ' ';
    // No row tells where files are: a path is shown by its name.
    line += word.starts_with('/') ? std::filesystem::path(word).filename().string() : word;
  }
  return {{"sweep", sweep}, {"input", input}, {"digest", digest}, {"program", program}, {"arguments", line}};
}

void addRun(Row& row, const ChildRun& run) {
  row["exit"] = run.exit_code;
  row["fault"] = run.fault;
  row["seconds_wall"] = number(run.seconds_wall);
  row["seconds_cpu"] = number(run.seconds_cpu);
  // What the system says of a child counts this program too, until the child became its own.
  row["peak_bytes"] = run.record ? run.record->peak_bytes : run.peak_bytes;
  if (run.record) {
    row["threads"] = run.record->threads;
    row["anonymous_bytes"] = run.record->anonymous_bytes;
  }
  row["load"] = loadAverage();
}

Rows::Rows(std::string folder, Context context, bool resume)
    : folder_(std::move(folder)), context_(std::move(context)) {
  const std::string path = folder_ + "/runs.jsonl";
  bool whole = true;  // the last line is
  if (resume) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
      whole = !file.eof();
      Row row = Row::parse(line, nullptr, false);
      if (row.is_object()) earlier_.push_back(std::move(row));
    }
  }
  std::ofstream file(path, resume ? std::ios::app : std::ios::trunc);
  // What a stopped run left half written stays a line of its own.
  if (!whole) file << '\n';
  if (!file.flush())
    throw Error(FaultCode::kIo, path, "", "cannot be written", "name a folder you may write to: --folder report");
}

bool Rows::counts(const Row& row) const {
  return row.value("commit", "") == context_.commit && row.value("exit", 1) == 0 && !row.contains("absent");
}

bool Rows::take(const Row& begun) {
  const auto found = std::find_if(earlier_.begin(), earlier_.end(),
                                  [&](const Row& row) { return counts(row) && sameRun(row, begun); });
  if (found == earlier_.end()) return false;
  rows_.push_back(*found);
  return true;
}

void Rows::add(Row row) {
  row["commit"] = context_.commit;
  row["machine"] = context_.machine;
  std::ofstream file(folder_ + "/runs.jsonl", std::ios::app);
  file << row.dump(-1, ' ', false, kReplace) << '\n';
  if (!file.flush())
    throw Error(FaultCode::kNoSpace, folder_ + "/runs.jsonl", "", "cannot be written", "free some space");
  rows_.push_back(std::move(row));
}

void Rows::finish() const {
  writeLines();
  writeCsv();
}

void Rows::writeLines() const {
  outofcore::OutputFile file(folder_ + "/runs.jsonl", true);
  for (const Row& row : rows_) file.write(row.dump(-1, ' ', false, kReplace) + "\n");
  for (const Row& row : earlier_) {
    const auto again = [&](const Row& taken) { return sameRun(row, taken); };
    if (counts(row) && std::none_of(rows_.begin(), rows_.end(), again))
      file.write(row.dump(-1, ' ', false, kReplace) + "\n");
  }
  file.commit();
}

void Rows::writeCsv() const {
  std::vector<std::string> names;
  for (const Row& row : rows_) {
    for (const auto& [name, value] : row.items()) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  outofcore::OutputFile file(folder_ + "/runs.csv", true);
  const auto writeLine = [&](const auto& fieldOf) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (i > 0) file.write(",");
      file.write(fieldOf(names[i]));
    }
    file.write("\n");
  };
  writeLine([](const std::string& name) { return csvField(name); });
  for (const Row& row : rows_) {
    writeLine([&](const std::string& name) { return row.contains(name) ? csvField(row.at(name)) : std::string(); });
  }
  file.commit();
}

}  // namespace tet4d::report

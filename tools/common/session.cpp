#include "tools/common/session.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>

#include "formats/container.h"
#include "libpreprocess/error.h"
#include "libpreprocess/outofcore/output_file.h"
#include "tools/common/bindings.h"
#include "tools/common/cli.h"
#include "tools/common/console_progress.h"
#include "tools/common/memory_sampler.h"

namespace tet4d::cli {

namespace {

using nlohmann::ordered_json;

template <class T>
void set(std::vector<std::pair<std::string, T>>& list, const std::string& name, T value) {
  for (auto& [known, old] : list) {
    if (known == name) {
      old = value;
      return;
    }
  }
  list.emplace_back(name, value);
}

ConsoleProgress::Look lookOf(const CommonOptions& options) {
  if (options.quiet || options.progress == "none") return ConsoleProgress::Look::kNone;
  if (options.progress == "bar") return ConsoleProgress::Look::kBar;
  if (options.progress == "plain") return ConsoleProgress::Look::kPlain;
  if (options.progress == "json") return ConsoleProgress::Look::kJson;
  return ::isatty(STDERR_FILENO) != 0 ? ConsoleProgress::Look::kBar : ConsoleProgress::Look::kPlain;
}

std::string withoutDirectory(const std::string& path) { return path.substr(path.find_last_of('/') + 1); }

// A name in a Makefile rule.
std::string makeEscaped(const std::string& path) {
  std::string escaped;
  for (const char c : path) {
    if (c == ' ' || c == '#' || c == '\\') escaped += '\\';
    if (c == '$') escaped += '$';
    escaped += c;
  }
  return escaped;
}

// As JSON; a path in an option keeps its file name only, when `portable`.
ordered_json optionValue(const Option& option, bool portable) {
  ordered_json value = valueOf(option.binding);
  const bool is_path = option.value_name == "FILE" || option.value_name == "DIR";
  if (portable && is_path && value.is_string()) value = withoutDirectory(value.get<std::string>());
  if (portable && is_path && value.is_array()) {
    for (ordered_json& one : value) one = withoutDirectory(one.get<std::string>());
  }
  return value;
}

bool isUniversalQuestion(const Option& option) { return option.name() == "help" || option.name() == "version"; }

}  // namespace

void Stats::count(const std::string& name, std::uint64_t value) { set(counts_, name, value); }
void Stats::error(const std::string& name, double value) { set(errors_, name, value); }

struct Session::State {
  State(const Command& a_command)
      : command(a_command),
        progress(a_command.program(), lookOf(a_command.commonOptions())),
        memory(a_command.commonOptions().memory_bytes) {
    if (!a_command.commonOptions().stats.empty()) sampler.emplace();  // only --stats tells
  }

  const Command& command;
  std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();
  ConsoleProgress progress;
  outofcore::MemoryBudget memory;
  std::optional<MemorySampler> sampler;
  std::unique_ptr<outofcore::ThreadExecutor> executor;
  Stats stats;
  std::vector<std::string> dependencies;
};

Session::Session(const Command& command) : state_(std::make_unique<State>(command)) {}
Session::~Session() = default;

const std::string& Session::program() const { return state_->command.program(); }
const CommonOptions& Session::options() const { return state_->command.commonOptions(); }
outofcore::Progress& Session::progress() { return state_->progress; }
outofcore::MemoryBudget& Session::memory() { return state_->memory; }
Stats& Session::stats() { return state_->stats; }

outofcore::Executor& Session::executor() {
  if (!state_->executor) state_->executor = std::make_unique<outofcore::ThreadExecutor>(options().threads);
  return *state_->executor;
}

void Session::note(std::string_view text) {
  if (!options().quiet) warn(text);
}

void Session::detail(std::string_view text) {
  if (options().verbose) note(text);
}

void Session::warn(std::string_view text) {
  state_->progress.clearLine();
  fmt::print(stderr, "{}: {}\n", state_->command.program(), text);
}

void Session::dependsOn(const std::string& path) { state_->dependencies.push_back(path); }

std::string Session::provenance(std::span<const Input> inputs) const {
  ordered_json options = ordered_json::object();
  for (const Option& option : state_->command.options()) {
    if (option.positional || (option.traits & kKeepsResult) != 0) continue;
    options[option.name()] = optionValue(option, true);
  }
  ordered_json list = ordered_json::array();
  for (const Input& input : inputs) {
    list.push_back({{"name", withoutDirectory(input.path)}, {"digest", input.digest}});
  }
  const ordered_json all{{"program", state_->command.program()},
                         {"version", TET4D_VERSION},
                         {"options", std::move(options)},
                         {"inputs", std::move(list)}};
  return all.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

namespace {

ordered_json phasesJson(const ConsoleProgress& progress) {
  ordered_json phases = ordered_json::array();
  for (const PhaseTimes& phase : progress.phases()) {
    phases.push_back({{"name", phase.name}, {"seconds_wall", phase.seconds_wall}, {"seconds_cpu", phase.seconds_cpu}});
  }
  return phases;
}

ordered_json framesJson(const Stats& stats) {
  ordered_json frames = ordered_json::array();
  for (const Stats::Frame& frame : stats.frames()) {
    frames.push_back({{"time", frame.time},
                      {"ms", frame.ms},
                      {"drawn", frame.drawn},
                      {"processed", frame.processed},
                      {"bytes_touched", frame.bytes_touched},
                      {"prefetched", frame.prefetched},
                      {"absent", frame.absent},
                      {"load_ms", frame.load_ms},
                      {"choose_ms", frame.choose_ms},
                      {"draw_ms", frame.draw_ms},
                      {"samples", frame.samples}});
  }
  return frames;
}

template <class T>
ordered_json objectOf(const std::vector<std::pair<std::string, T>>& pairs) {
  ordered_json object = ordered_json::object();
  for (const auto& [name, value] : pairs) object[name] = value;
  return object;
}

}  // namespace

void Session::stopProgress() { state_->progress.finish(false); }

void Session::finish() {
  State& state = *state_;
  state.progress.finish(true);
  if (!options().depfile.empty()) {
    if (options().output.empty() || options().output == "-") {
      throw Error(FaultCode::kUsage, {}, "--depfile", "needs an output file to be the rule's target", "give --output");
    }
    outofcore::OutputFile depfile(options().depfile, true);
    depfile.write(fmt::format("{}:", makeEscaped(options().output)));
    for (const std::string& path : state.dependencies) depfile.write(fmt::format(" {}", makeEscaped(path)));
    depfile.write("\n");
    depfile.commit();
  }
  if (options().stats.empty()) return;

  ordered_json all = ordered_json::object();
  all["program"] = state.command.program();
  all["version"] = TET4D_VERSION;
  all["options"] = ordered_json::object();
  for (const Option& option : state.command.options()) {
    if (!isUniversalQuestion(option)) all["options"][option.name()] = optionValue(option, false);
  }
  all["counts"] = objectOf(state.stats.counts());
  all["seconds_wall"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - state.begin).count();
  all["seconds_cpu"] = processCpuSeconds();
  all["peak_bytes"] = processMemory("VmHWM");
  all["anonymous_bytes"] = state.sampler->peakBytes();
  all["threads"] = state.executor ? state.executor->threads() : std::size_t{1};
  all["phases"] = phasesJson(state.progress);
  all["error"] = objectOf(state.stats.errors());
  if (state.stats.hasFrames()) all["frames"] = framesJson(state.stats);

  outofcore::OutputFile file(options().stats, true);
  file.write(all.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n");
  file.commit();
}

std::string fileDigest(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat info {};
  const bool readable = descriptor >= 0 && ::fstat(descriptor, &info) == 0 && S_ISREG(info.st_mode);
  const int error_number = descriptor < 0 ? errno : EINVAL;
  const auto bytes = static_cast<std::size_t>(readable ? info.st_size : 0);
  void* mapped = bytes == 0 ? nullptr : ::mmap(nullptr, bytes, PROT_READ, MAP_PRIVATE, descriptor, 0);
  if (descriptor >= 0) ::close(descriptor);
  if (!readable || mapped == MAP_FAILED) {
    throw Error(FaultCode::kIo, path, {}, fmt::format("cannot be read: {}", std::strerror(error_number)),
                "give a regular file");
  }
  const std::uint64_t digest = container::xxh3({static_cast<const std::byte*>(mapped), bytes});
  if (mapped != nullptr) ::munmap(mapped, bytes);
  return fmt::format("{:016x}", digest);
}

}  // namespace tet4d::cli

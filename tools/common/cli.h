// The command line of every program: one option table makes the parser and --help, and run() is the project's one
// catch.
//
//   int main(int argc, char** argv) {
//     using namespace tet4d;
//     double iso = 0;
//     std::string input, split = "hull";
//     cli::Command command("tet4d-mc", "Extracts a hypermesh from frames of a grid.");
//     command.example("tet4d-mc frame_*.nrrd --iso 0.5 -o drop.t4h", "the surface where the field is 0.5")
//         .positional("FILE", "frames in time order", &input)
//         .option("--iso", "V", "isovalue", &iso, cli::kMustBeGiven)
//         .option("--split", "WAY", "how a hypercube is cut", cli::Choice{&split, {"hull", "kuhn"}})
//         .common({cli::kOutput, cli::kThreads, cli::kMemory, cli::kForce, cli::kStats});
//     return cli::run(argc, argv, command, [&](cli::Session& session) {
//       …
//       session.stats().count("tets", tets);
//       return 0;
//     });
//   }
//
// -h/--help, --version, -q, -v, --progress and --config belong to every program.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "tools/common/session.h"

namespace tet4d::cli {

// Common options beyond those every program has.
enum Common {
  kOutput,          // -o/--output FILE, may be left out
  kOutputRequired,  // the same, must be given
  kThreads,         // -j/--threads N
  kMemory,          // --memory SIZE
  kTempDir,         // --temp-dir DIR
  kForce,           // -f/--force
  kDryRun,          // -n/--dry-run
  kResume,          // --resume
  kSeed,            // --seed N
  kStats,           // --stats FILE
  kDepfile,         // --depfile FILE
};

// Values that are more than a number or a word.
struct Size {  // bytes: "512M", "2GiB", "1.5G"; K, M, G, T count in 1024s, as do KiB … ; KB, MB, … in 1000s
  std::uint64_t* value;
};
struct Choice {  // one of a list of words; another word is a usage error that names the nearest
  std::string* value;
  std::vector<std::string> words;
};
struct Times {  // "T", "T,T,T" or "A:B:STEP" (both ends included; an end within STEP/1e6 of B counts as B)
  std::vector<double>* value;
};
struct Extent {  // "WxH", both at least 1
  std::array<std::uint32_t, 2>* value;
};

// Where a value goes. The value bound before parsing is the default; --help shows it unless it is empty, false or
// absent. A vector<string> takes the option any number of times; a vector<double> takes "a,b,c".
using Binding =
    std::variant<bool*, std::string*, double*, std::optional<double>*, std::uint64_t*, std::optional<std::uint64_t>*,
                 std::vector<std::string>*, std::vector<double>*, Size, Choice, Times, Extent>;

// Traits of an option, or-ed together.
inline constexpr unsigned kMustBeGiven = 1;
inline constexpr unsigned kKeepsResult = 2;  // cannot change the bytes of the result: left out of provenance
inline constexpr unsigned kNotInHelp = 4;
// What names a file to write; run() refuses one that is also an input or another output. -o, --stats and --depfile have
// it.
inline constexpr unsigned kIsOutput = 8;
// What may name a file to read; positionals and options whose value is called FILE need not say so.
inline constexpr unsigned kIsInput = 16;
inline constexpr unsigned kMayBeInfinite = 32;  // a number may also be an infinity or NaN

struct Option {
  std::string flags;       // "-o,--output"; a positional has its name here
  std::string value_name;  // "FILE"; empty for a flag
  std::string help;        // one sentence, no full stop
  Binding binding;
  unsigned traits = 0;
  std::string heading;  // of the group it stands under in --help
  bool positional = false;

  std::string name() const;  // "output": the long flag without dashes, or the positional's name
};

struct Example {
  std::string command, meaning;
};

class Command {
 public:
  Command(std::string program, std::string summary);
  Command(const Command&) = delete;  // its options point into it
  Command& operator=(const Command&) = delete;

  // Shown first in --help, in this order.
  Command& example(std::string command, std::string meaning);
  // A positional argument, required; a vector takes all that are left, at least one. `optional` allows none.
  Command& positional(std::string name, std::string help, std::string* value, bool optional = false);
  Command& positional(std::string name, std::string help, std::vector<std::string>* values, bool optional = false);
  // Options added after heading() stand under it in --help; the first ones under "Options".
  Command& heading(std::string text);
  Command& option(std::string flags, std::string value_name, std::string help, Binding binding, unsigned traits = 0);
  Command& flag(std::string flags, std::string help, bool* value, unsigned traits = 0);
  Command& common(std::initializer_list<Common> which);
  // A line shown at the end of --help.
  Command& note(std::string text);
  // What the user writes behind the program's name to mean this command of several.
  Command& subcommand(std::string word);

  const std::string& program() const { return program_; }
  const std::string& summary() const { return summary_; }
  const std::string& word() const { return word_; }  // empty for the program's only command
  const std::vector<Example>& examples() const { return examples_; }
  const std::vector<Option>& options() const { return options_; }  // positionals among them, in order
  const std::vector<std::string>& notes() const { return notes_; }
  CommonOptions& commonOptions() { return common_; }
  const CommonOptions& commonOptions() const { return common_; }

  // Adds what every program has; parse() and helpText() need it, and run() calls it.
  void addUniversal();
  bool wantsHelp() const { return wants_help_; }
  bool wantsVersion() const { return wants_version_; }

 private:
  std::string program_, word_, summary_, heading_ = "Options";
  std::vector<Example> examples_;
  std::vector<Option> options_;
  std::vector<std::string> notes_;
  CommonOptions common_;
  bool has_universal_ = false, wants_help_ = false, wants_version_ = false;
};

// What parse() found to do.
enum class Parsed { kRun, kHelp, kVersion };

// Parses into the bindings, adding the universal options first. Throws Error{kUsage} with the nearest option or word in
// the remedy; Error{kIo} for a
// --config file that cannot be read.
Parsed parse(int argc, const char* const* argv, Command& command);

// The text of --help. Made from the option table as it stands before parsing: defaults are read from the bindings.
std::string helpText(const Command& command);

// The whole of main(): parses, runs `body` and returns its exit code (0, or 5 when a validation found faults), or
// prints
//   program: file: place: what
//   program: remedy
// to stderr and returns the fault's exit code. Outputs that are inputs are refused first. SIGINT, SIGTERM and SIGHUP
// ask the body to stop at the next progress step, a second one kills. Writes --stats and --depfile after a body that
// returned 0 or 5.
int run(int argc, char** argv, Command& command, const std::function<int(Session&)>& body);

// A program of several commands, each with options of its own: `program word …`.
struct Suite {
  struct Part {
    Command* command = nullptr;  // with a word()
    std::function<int(Session&)> body;
  };
  std::string program, summary;
  std::vector<Part> parts;
};

// As above, for the command that the first argument names. Without arguments it is a usage error; --help lists the
// commands, and `program word --help` is that of one.
int run(int argc, char** argv, Suite& suite);

// Throws Error{kUsage} if -o names a file that does not end in `suffix` (".t4h"); `remedy` says what to do instead.
void expectSuffix(const Session& session, std::string_view suffix, std::string_view remedy);

// The one of `words` nearest to `word` (Damerau-Levenshtein), empty if none is near enough to be meant.
std::string nearest(std::string_view word, const std::vector<std::string>& words);

}  // namespace tet4d::cli

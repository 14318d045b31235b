#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "tools/common/bindings.h"
#include "tools/common/cli.h"

namespace tet4d::cli {

std::string Option::name() const {
  const std::size_t dashes = flags.find("--");
  if (dashes != std::string::npos) return flags.substr(dashes + 2, flags.find(',', dashes) - dashes - 2);
  return flags.substr(flags.find_first_not_of('-'));
}

Command::Command(std::string program, std::string summary)
    : program_(std::move(program)), summary_(std::move(summary)) {}

Command& Command::example(std::string command, std::string meaning) {
  examples_.push_back({std::move(command), std::move(meaning)});
  return *this;
}

Command& Command::positional(std::string name, std::string help, std::string* value, bool optional) {
  options_.push_back({std::move(name), "", std::move(help), value, optional ? 0 : kMustBeGiven, "", true});
  return *this;
}

Command& Command::positional(std::string name, std::string help, std::vector<std::string>* values, bool optional) {
  options_.push_back({std::move(name), "", std::move(help), values, optional ? 0 : kMustBeGiven, "", true});
  return *this;
}

Command& Command::heading(std::string text) {
  heading_ = std::move(text);
  return *this;
}

Command& Command::option(std::string flags, std::string value_name, std::string help, Binding binding,
                         unsigned traits) {
  options_.push_back(
      {std::move(flags), std::move(value_name), std::move(help), std::move(binding), traits, heading_, false});
  return *this;
}

Command& Command::flag(std::string flags, std::string help, bool* value, unsigned traits) {
  return option(std::move(flags), "", std::move(help), value, traits);
}

Command& Command::note(std::string text) {
  notes_.push_back(std::move(text));
  return *this;
}

Command& Command::subcommand(std::string word) {
  word_ = std::move(word);
  return *this;
}

Command& Command::common(std::initializer_list<Common> which) {
  heading("Common options");
  for (const Common one : which) {
    switch (one) {
      case kOutput:
      case kOutputRequired:
        option("-o,--output", "FILE", "where to write", &common_.output,
               kKeepsResult | kIsOutput | (one == kOutputRequired ? kMustBeGiven : 0));
        break;
      case kThreads:
        option("-j,--threads", "N", "threads to use; 0 = one per core; the output does not depend on it",
               &common_.threads, kKeepsResult);
        break;
      case kMemory:
        option("--memory", "SIZE", "most memory to use, such as 512M or 2GiB; mapped input is not counted",
               Size{&common_.memory_bytes}, kKeepsResult);
        break;
      case kTempDir:
        option("--temp-dir", "DIR", "where temporary files go", &common_.temp_dir, kKeepsResult);
        break;
      case kForce:
        flag("-f,--force", "replace existing files", &common_.force, kKeepsResult);
        break;
      case kDryRun:
        flag("-n,--dry-run", "say what would be done: passes, memory, temporary and output bytes", &common_.dry_run,
             kKeepsResult);
        break;
      case kResume:
        flag("--resume",
             "go on where an interrupted run with the same input and options stopped: finished cells are not made "
             "again; "
             "what is simplified in core, or left nothing, begins anew and says so",
             &common_.resume, kKeepsResult);
        break;
      case kSeed:
        option("--seed", "N", "seed of every random choice", &common_.seed);
        break;
      case kStats:
        option("--stats", "FILE", "write times, memory and counts as JSON", &common_.stats, kKeepsResult | kIsOutput);
        break;
      case kDepfile:
        option("--depfile", "FILE", "write the output's inputs as a Makefile rule", &common_.depfile,
               kKeepsResult | kIsOutput);
        break;
    }
  }
  return *this;
}

void Command::addUniversal() {
  if (has_universal_) return;
  has_universal_ = true;
  heading("Common options");
  flag("-q,--quiet", "say nothing but errors", &common_.quiet, kKeepsResult);
  flag("-v,--verbose", "say more", &common_.verbose, kKeepsResult);
  option("--progress", "HOW", "how to show progress on stderr",
         Choice{&common_.progress, {"auto", "bar", "plain", "json", "none"}}, kKeepsResult);
  option("--config", "FILE", "read options from a file of 'name = value' lines", &common_.config, kKeepsResult);
  flag("--version", "print the version", &wants_version_, kKeepsResult);
  flag("-h,--help", "print this help", &wants_help_, kKeepsResult);
}

namespace {

// "  -o, --output FILE" and so on.
std::string leftColumn(const Option& option) {
  const std::string& flags = option.flags;
  if (option.positional) return fmt::format("  {}", flags);
  const std::size_t comma = flags.find(',');
  std::string left = comma != std::string::npos
                         ? fmt::format("  {}, {}", flags.substr(0, comma), flags.substr(comma + 1))
                     : flags.starts_with("--") ? fmt::format("      {}", flags)
                                               : fmt::format("  {}", flags);
  const std::string choices = choicesText(option.binding);
  if (!option.value_name.empty()) left.append(" ").append(choices.empty() ? option.value_name : choices);
  return left;
}

// The help text, wrapped to 100 columns beside the left column.
std::string entry(const Option& option) {
  constexpr std::size_t kIndent = 30, kWidth = 100;
  std::string help = option.help;
  if ((option.traits & kMustBeGiven) != 0 && !option.positional) help += " (required)";
  const std::string shown = defaultText(option.binding);
  if (!shown.empty() && !option.positional && (option.traits & kMustBeGiven) == 0) help += fmt::format(" [{}]", shown);

  std::string line = leftColumn(option), text;
  if (line.size() + 2 > kIndent) text = std::exchange(line, {}) + "\n";
  line.resize(kIndent, ' ');
  for (std::size_t begin = 0; begin < help.size();) {
    const std::size_t end = std::min(help.find(' ', begin), help.size());
    if (line.size() > kIndent && line.size() + end - begin > kWidth) text += line + "\n", line.assign(kIndent, ' ');
    line.append(help, begin, end - begin).push_back(' ');
    begin = end + 1;
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return text + line + "\n";
}

std::string titleOf(const Command& command) {
  return command.word().empty() ? command.program() : command.program() + " " + command.word();
}

std::string usageLine(const Command& command) {
  std::string usage = "usage: " + titleOf(command);
  for (const Option& option : command.options()) {
    if (!option.positional) continue;
    const std::string name = option.flags + (takesMany(option.binding) ? "..." : "");
    usage += (option.traits & kMustBeGiven) != 0 ? fmt::format(" {}", name) : fmt::format(" [{}]", name);
  }
  for (const Option& option : command.options()) {
    if (option.positional || (option.traits & kMustBeGiven) == 0) continue;
    usage += fmt::format(" {} {}", option.flags.substr(0, option.flags.find(',')), option.value_name);
  }
  return usage + " [OPTION...]\n";
}

}  // namespace

std::string helpText(const Command& command) {
  std::string text = titleOf(command) + " - " + command.summary() + "\n\n";
  if (!command.examples().empty()) {
    text += "Examples:\n";
    for (const Example& example : command.examples()) {
      text += fmt::format("  {}\n      {}\n", example.command, example.meaning);
    }
    text += "\n";
  }
  text += usageLine(command) + "\n";
  bool has_positionals = false;
  for (const Option& option : command.options()) {
    if (option.positional) text += entry(option), has_positionals = true;
  }
  if (has_positionals) text += "\n";

  std::vector<std::string> headings;
  for (const Option& option : command.options()) {
    if (!option.positional && std::find(headings.begin(), headings.end(), option.heading) == headings.end()) {
      headings.push_back(option.heading);
    }
  }
  for (const std::string& heading : headings) {
    text += heading + ":\n";
    for (const Option& option : command.options()) {
      if (!option.positional && option.heading == heading && (option.traits & kNotInHelp) == 0) text += entry(option);
    }
    text += "\n";
  }
  for (const std::string& note : command.notes()) text += note + "\n";
  if (command.notes().empty()) text.pop_back();
  return text;
}

}  // namespace tet4d::cli

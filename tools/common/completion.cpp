#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "tools/common/manual.h"

namespace tet4d::cli {
namespace {

// "--output", "-o" of "-o,--output".
std::vector<std::string> spellingsOf(const Option& option) {
  std::vector<std::string> all;
  for (std::size_t begin = 0; begin < option.flags.size();) {
    const std::size_t end = std::min(option.flags.find(',', begin), option.flags.size());
    all.push_back(option.flags.substr(begin, end - begin));
    begin = end + 1;
  }
  return all;
}

std::string joined(const std::vector<std::string>& words, const char* between) {
  return fmt::format("{}", fmt::join(words, between));
}

// The line of bash that completes an option's value.
std::string valueAction(const Option& option) {
  if (const auto* choice = std::get_if<Choice>(&option.binding)) {
    return fmt::format("mapfile -t COMPREPLY < <(compgen -W '{}' -- \"$cur\")", joined(choice->words, " "));
  }
  const std::string& value = option.value_name;
  if (value == "DIR") return "mapfile -t COMPREPLY < <(compgen -d -- \"$cur\")";
  const bool is_file = value.find("FILE") != std::string::npos || (option.traits & (kIsInput | kIsOutput)) != 0;
  return is_file ? "mapfile -t COMPREPLY < <(compgen -f -- \"$cur\")" : ":";
}

std::string functionName(const std::string& program, const std::string& word) {
  std::string name = fmt::format("_{}{}{}", program, word.empty() ? "" : "_", word);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

// Sets COMPREPLY for $cur behind $prev.
std::string functionOf(const Command& command) {
  std::string cases, flags;
  for (const Option& option : command.options()) {
    if (option.positional || (option.traits & kNotInHelp) != 0) continue;
    const std::vector<std::string> spellings = spellingsOf(option);
    flags += fmt::format("{}{}", flags.empty() ? "" : " ", fmt::join(spellings, " "));
    if (!option.value_name.empty()) {
      cases += fmt::format("    {}) {}; return ;;\n", joined(spellings, "|"), valueAction(option));
    }
  }
  return fmt::format(
      "{}() {{\n"
      "  case $prev in\n{}  esac\n"
      "  if [[ $cur == -* ]]; then\n"
      "    mapfile -t COMPREPLY < <(compgen -W '{}' -- \"$cur\")\n"
      "  else\n"
      "    mapfile -t COMPREPLY < <(compgen -f -- \"$cur\")\n"
      "  fi\n"
      "}}\n\n",
      functionName(command.program(), command.word()), cases, flags);
}

}  // namespace

std::string completionText(const Manual& manual) {
  std::string text = fmt::format("# Completion of {} for bash, made from its table of options.\n\n", manual.program);
  std::vector<std::string> words;
  std::string calls;
  for (const Command* command : manual.commands) {
    text += functionOf(*command);
    if (command->word().empty()) continue;
    words.push_back(command->word());
    calls += fmt::format("    {}) {} ;;\n", command->word(), functionName(manual.program, command->word()));
  }
  const std::string entry = functionName(manual.program, "complete");
  // The shell takes "--name=value" apart at "=".
  text += fmt::format(
      "{}() {{\n"
      "  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD - 1]}}\n"
      "  COMPREPLY=()\n"
      "  if [[ $cur == = ]]; then\n"
      "    cur=\n"
      "  elif [[ $prev == = ]]; then\n"
      "    prev=${{COMP_WORDS[COMP_CWORD - 2]}}\n"
      "  fi\n",
      entry);
  if (words.empty()) {
    text += fmt::format("  {}\n", functionName(manual.program, ""));
  } else {
    text += fmt::format(
        "  if ((COMP_CWORD == 1)); then\n"
        "    mapfile -t COMPREPLY < <(compgen -W '{} --help --version' -- \"$cur\")\n"
        "    return\n"
        "  fi\n"
        "  case ${{COMP_WORDS[1]}} in\n{}  esac\n",
        joined(words, " "), calls);
  }
  return text + fmt::format("}}\ncomplete -o filenames -F {} {}\n", entry, manual.program);
}

}  // namespace tet4d::cli

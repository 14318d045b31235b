#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "tools/common/bindings.h"
#include "tools/common/manual.h"

namespace tet4d::cli {
namespace {

// Text as roff shows it: backslashes and dashes literally, no line that begins like a request.
std::string plain(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (out.empty() && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c == '\n' ? ' ' : c;
    }
  }
  return out;
}

std::string bold(const std::string& text) { return fmt::format("\\fB{}\\fR", plain(text)); }
std::string italic(const std::string& text) { return fmt::format("\\fI{}\\fR", plain(text)); }

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

std::string valueText(const Option& option) {
  if (option.value_name.empty()) return "";
  const std::string choices = choicesText(option.binding);
  return fmt::format(" {}", choices.empty() ? italic(option.value_name) : bold(choices));
}

std::string flagsText(const Option& option) {
  if (option.positional) return italic(option.flags);
  const std::size_t comma = option.flags.find(',');
  if (comma == std::string::npos) return bold(option.flags) + valueText(option);
  return bold(option.flags.substr(0, comma)) + ", " + bold(option.flags.substr(comma + 1)) + valueText(option);
}

std::string entry(const Option& option) {
  std::string help = option.help;
  const bool required = (option.traits & kMustBeGiven) != 0;
  if (required && !option.positional) help += " (required)";
  const std::string shown = defaultText(option.binding);
  if (!shown.empty() && !option.positional && !required) help += " [" + shown + "]";
  return fmt::format(".TP\n{}\n{}\n", flagsText(option), plain(help));
}

std::string titleOf(const Command& command) {
  return command.word().empty() ? command.program() : command.program() + " " + command.word();
}

std::string synopsis(const Command& command) {
  std::string line = bold(titleOf(command));
  for (const Option& option : command.options()) {
    const bool required = (option.traits & kMustBeGiven) != 0;
    if (option.positional) {
      const std::string name = italic(option.flags) + (takesMany(option.binding) ? "..." : "");
      line += required ? fmt::format(" {}", name) : fmt::format(" [{}]", name);
    } else if (required) {
      line += fmt::format(" {}{}", bold(option.flags.substr(0, option.flags.find(','))), valueText(option));
    }
  }
  return fmt::format("{} [{}...]\n", line, italic("OPTION"));
}

// subsections: headings are sections of their own, not lines within one.
std::string optionsText(const Command& command, bool subsections) {
  std::string text;
  std::vector<std::string> headings;
  for (const Option& option : command.options()) {
    if (option.positional) text += entry(option);
    const bool known = std::find(headings.begin(), headings.end(), option.heading) != headings.end();
    if (!option.positional && !known) headings.push_back(option.heading);
  }
  for (const std::string& heading : headings) {
    text += subsections ? fmt::format(".SS {}\n", plain(heading)) : fmt::format(".PP\n{}\n", bold(heading));
    for (const Option& option : command.options()) {
      const bool shown = !option.positional && option.heading == heading && (option.traits & kNotInHelp) == 0;
      if (shown) text += entry(option);
    }
  }
  return text;
}

}  // namespace

std::string manText(const Manual& manual) {
  std::string text =
      fmt::format(".TH {} 1 \"\" \"tet4d {}\" \"tet4d\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n",
                  plain(upper(manual.program)), manual.version, plain(manual.program), plain(manual.summary));
  for (std::size_t i = 0; i < manual.commands.size(); ++i) {
    text += fmt::format("{}{}", i > 0 ? ".br\n" : "", synopsis(*manual.commands[i]));
  }
  const bool several = manual.commands.size() > 1;
  if (!several) text += fmt::format(".SH OPTIONS\n{}", optionsText(*manual.commands.front(), true));
  if (several) {
    text += ".SH COMMANDS\n";
    for (const Command* command : manual.commands) {
      text += fmt::format(".SS {}\n{}\n{}", plain(titleOf(*command)), plain(command->summary()),
                          optionsText(*command, false));
    }
  }
  text += ".SH EXAMPLES\n";
  for (const Command* command : manual.commands) {
    for (const Example& example : command->examples()) {
      text += fmt::format(".TP\n{}\n{}\n", bold(example.command), plain(example.meaning));
    }
  }
  std::string notes;
  for (const Command* command : manual.commands) {
    for (const std::string& note : command->notes())
      notes += fmt::format("{}{}\n", notes.empty() ? "" : ".PP\n", plain(note));
  }
  if (!notes.empty()) text += ".SH NOTES\n" + notes;
  return text +
         ".SH EXIT STATUS\n0 done, 1 failure, 2 usage, 3 bad input, 4 out of memory, disk or quota, 5 faults found\n";
}

}  // namespace tet4d::cli

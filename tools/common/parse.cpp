#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <fstream>

#include "libpreprocess/error.h"
#include "tools/common/bindings.h"
#include "tools/common/cli.h"

namespace tet4d::cli {

namespace {

[[noreturn]] void fail(std::string place, std::string what, std::string remedy = "see --help") {
  throw Error(FaultCode::kUsage, {}, std::move(place), std::move(what), std::move(remedy));
}

// How messages name an option: "--iso", or the positional's own name.
std::string shownName(const Option& option) { return option.positional ? option.flags : "--" + option.name(); }

// Declares the table to CLI11. Texts are only collected: conversion is ours, so that messages name what was meant.
std::vector<CLI::Option*> declare(CLI::App& app, const Command& command) {
  std::vector<CLI::Option*> declared;
  for (const Option& option : command.options()) {
    if (option.value_name.empty() && !option.positional) {
      declared.push_back(app.add_flag(option.flags));
      continue;
    }
    if (option.flags == "--config") {
      declared.push_back(app.set_config(option.flags)->type_name(option.value_name));
      continue;
    }
    const auto collect = [](const CLI::results_t&) { return true; };
    CLI::Option* one = app.add_option(option.flags, collect)->type_name(option.value_name);
    if (!takesMany(option.binding) && option.positional) {
      one->expected(1);
    } else if (option.positional) {
      one->expected(1, CLI::detail::expected_max_vector_size)->allow_extra_args();
    } else {  // one given twice is refused by refuseTwice(), in our words
      one->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)->allow_extra_args(false);
    }
    if (option.positional) one->configurable(false);
    declared.push_back(one);
  }
  return declared;
}

// Every long option, with its dashes.
std::vector<std::string> spellings(const Command& command) {
  std::vector<std::string> all;
  for (const Option& option : command.options()) {
    if (!option.positional) all.push_back("--" + option.name());
  }
  return all;
}

// A long option that lost a dash ("-json") would be read as short ones ("-j son").
void refuseLostDash(int argc, const char* const* argv, const Command& command) {
  const std::vector<std::string> known = spellings(command);
  for (int i = 1; i < argc && std::string_view(argv[i]) != "--"; ++i) {
    const std::string word(argv[i]), mended = fmt::format("-{}", word.substr(0, word.find('=')));
    if (word.size() > 2 && word[1] != '-' && std::find(known.begin(), known.end(), mended) != known.end()) {
      fail(word, "there is no such option", fmt::format("did you mean {}?", mended));
    }
  }
}

[[noreturn]] void failUnknown(const Command& command, const std::string& argument) {
  if (!argument.starts_with('-') || argument == "-") fail(fmt::format("'{}'", argument), "is one argument too many");
  const std::string word = argument.substr(0, argument.find('='));
  const std::string meant = nearest(word, spellings(command));
  fail(word, "there is no such option", meant.empty() ? "see --help" : fmt::format("did you mean {}?", meant));
}

void refuseTwice(const Option& option, const std::vector<std::string>& texts) {
  if (texts.size() <= 1 || option.value_name.empty() || takesMany(option.binding)) return;
  fail(shownName(option), fmt::format("is given {} times", texts.size()), "give it once");
}

void requireReadable(const std::string& config) {
  if (config.empty()) return;
  if (!std::ifstream(config))
    throw Error(FaultCode::kIo, config, {}, "cannot be read", "check the name given to --config");
}

// A line of a file of options that makes no sense; CLI11's message is "… parse NAME" or "NAME: … not allowed …".
[[noreturn]] void failConfig(const Command& command, const std::string& file, const std::string& message) {
  const std::size_t colon = message.find(": ");
  const std::string word =
      colon != std::string::npos ? message.substr(0, colon) : message.substr(message.find_last_of(' ') + 1);
  const std::string meant = colon != std::string::npos ? std::string() : nearest("--" + word, spellings(command));
  throw Error(
      FaultCode::kUsage, file, "--config",
      fmt::format("'{}' is no option that a file can give; wanted are lines 'name = value'", word),
      meant.empty() ? "name options as --help does, without dashes" : fmt::format("did you mean {}?", meant.substr(2)));
}

void parseInto(CLI::App& app, CLI::Option* config, int argc, const char* const* argv, const Command& command) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::FileError&) {
    requireReadable(config->empty() ? std::string() : config->results().back());
    fail("--config", "is not a readable file");
  } catch (const CLI::ConfigError& error) {
    failConfig(command, config->empty() ? std::string() : config->results().back(), error.what());
  } catch (const CLI::ArgumentMismatch& error) {
    // "--iso: 1 required TEXT missing": repeated options are ours, so that a value is missing is all that is left; and
    // "--json was given a disallowed flag override".
    const std::string text = error.what(), name = text.substr(0, text.find_first_of(": "));
    const bool is_flag = text.find("flag override") != std::string::npos;
    fail(name, is_flag ? "takes no value" : "needs a value");
  } catch (const CLI::ParseError& error) {
    fail({}, error.what());
  }
}

}  // namespace

Parsed parse(int argc, const char* const* argv, Command& command) {
  command.addUniversal();
  CLI::App app;
  app.set_help_flag();
  app.allow_extras();
  app.allow_config_extras(CLI::config_extras_mode::error);
  const std::vector<CLI::Option*> declared = declare(app, command);

  const std::vector<Option>& options = command.options();
  CLI::Option* config = nullptr;
  for (std::size_t i = 0; i < options.size(); ++i) {
    if (options[i].flags == "--config") config = declared[i];
    if (options[i].name() == "help" || options[i].name() == "version") declared[i]->configurable(false);
  }
  refuseLostDash(argc, argv, command);
  parseInto(app, config, argc, argv, command);

  const auto given = [&](std::string_view name) {
    for (std::size_t i = 0; i < options.size(); ++i) {
      if (!options[i].positional && options[i].name() == name) return !declared[i]->empty();
    }
    return false;
  };
  if (given("help")) return Parsed::kHelp;
  if (given("version")) return Parsed::kVersion;

  const std::vector<std::string> extras = app.remaining();
  for (const std::string& extra : extras) {
    if (extra.starts_with('-') && extra != "-") failUnknown(command, extra);
  }
  if (!extras.empty()) failUnknown(command, extras.front());

  for (std::size_t i = 0; i < options.size(); ++i) {
    const std::vector<std::string> texts = declared[i]->results();
    refuseTwice(options[i], texts);
    if (!texts.empty()) {
      assign(options[i], shownName(options[i]), texts);
    } else if ((options[i].traits & kMustBeGiven) != 0) {
      fail(shownName(options[i]), options[i].positional ? "is missing: " + options[i].help : "must be given");
    }
  }
  return Parsed::kRun;
}

}  // namespace tet4d::cli

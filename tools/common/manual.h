// The man page and the completion of bash, made from the table of options like the parser and --help. Every program
// prints them (--print-man, --print-completion, not in --help); the build does and installs what it gets.
#pragma once

#include <string>
#include <vector>

#include "tools/common/cli.h"

namespace tet4d::cli {

// A program with one command, or with several: then each has a word() and options of its own.
struct Manual {
  std::string program, summary, version;
  std::vector<const Command*> commands;  // their universal options added
};

// man(7) source, section 1: name, synopsis, options by heading, examples, notes. Options with kNotInHelp are left out.
std::string manText(const Manual& manual);

// A script for share/bash-completion: words of commands, options, the words of a choice, files and directories where
// an option takes one, nothing where it takes a number.
std::string completionText(const Manual& manual);

}  // namespace tet4d::cli

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include "libpreprocess/error.h"
#include "libpreprocess/outofcore/output_file.h"
#include "tools/common/cli.h"
#include "tools/common/exit_codes.h"
#include "tools/common/files.h"
#include "tools/common/manual.h"

namespace tet4d::cli {

namespace {

// The first signal asks; the second one gets the system's own answer.
void onSignal(int signal) {
  if (outofcore::interruptRequested()) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
  outofcore::requestInterrupt();
}

void installSignals() {
  std::signal(SIGINT, onSignal);
  std::signal(SIGTERM, onSignal);
  // Under nohup it stays ignored.
  if (std::signal(SIGHUP, onSignal) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
  // A closed pipe and a file at its size limit are errors of the write, reported like any other.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

int report(const std::string& program, const Fault& fault) {
  std::string line = program + ": ";
  for (const std::string* part : {&fault.file, &fault.place}) {
    if (!part->empty()) line += *part + ": ";
  }
  line += fault.what + "\n";
  if (!fault.remedy.empty()) line += program + ": " + fault.remedy + "\n";
  std::fputs(line.c_str(), stderr);
  return exitCode(fault.code);
}

// Data on stdout counts as written only when the system has taken it.
void flushStandardOutput() {
  errno = 0;
  std::cout.flush();
  const bool cout_failed = std::cout.fail();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && !cout_failed) return;
  const bool full = errno == ENOSPC || errno == EDQUOT || errno == EFBIG;
  throw Error(full ? FaultCode::kNoSpace : FaultCode::kIo, "standard output", {},
              "cannot be written: " + std::generic_category().message(errno != 0 ? errno : EIO),
              full ? "free some space, or write to another disk" : "");
}

int runSession(Command& command, const std::function<int(Session&)>& body) {
  Session session(command);
  try {
    const CommonOptions& options = session.options();
    if (!options.output.empty() && !options.dry_run && !options.resume) {
      outofcore::refuseExisting(options.output, options.force);
    }
    const int code = body(session);
    flushStandardOutput();
    session.finish();
    return code;
  } catch (...) {
    session.stopProgress();
    throw;
  }
}

int parseAndRun(int argc, char** argv, Command& command, const std::function<int(Session&)>& body) {
  switch (parse(argc, argv, command)) {
    case Parsed::kHelp:
      std::fputs(helpText(command).c_str(), stdout);
      break;
    case Parsed::kVersion:
      std::puts((command.program() + " " TET4D_VERSION).c_str());
      break;
    case Parsed::kRun:
      refuseOverlaps(command);
      return runSession(command, body);
  }
  flushStandardOutput();
  return kExitDone;
}

// What the build installs beside the program. True if that was asked for.
bool printManual(int argc, char** argv, const std::string& program, const std::string& summary,
                 const std::vector<Command*>& commands) {
  const std::string wish = argc == 2 ? argv[1] : "";
  if (wish != "--print-man" && wish != "--print-completion") return false;
  Manual manual{program, summary, TET4D_VERSION, {}};
  for (Command* command : commands) {
    command->addUniversal();
    manual.commands.push_back(command);
  }
  std::fputs((wish == "--print-man" ? manText(manual) : completionText(manual)).c_str(), stdout);
  flushStandardOutput();
  return true;
}

std::string suiteHelp(const Suite& suite) {
  std::string text = suite.program + " - " + suite.summary + "\n\nExamples:\n";
  for (const Suite::Part& part : suite.parts) {
    for (const Example& example : part.command->examples()) {
      text += "  " + example.command + "\n      " + example.meaning + "\n";
    }
  }
  text += "\nusage: " + suite.program + " COMMAND [ARGUMENT...]\n\nCommands:\n";
  for (const Suite::Part& part : suite.parts) {
    std::string line = "  " + part.command->word();
    line.resize(std::max<std::size_t>(line.size() + 2, 16), ' ');
    text += line + part.command->summary() + "\n";
  }
  return text + "\n" + suite.program + " COMMAND --help has the options of each.\n";
}

int runSuite(int argc, char** argv, Suite& suite) {
  std::vector<Command*> commands;
  std::vector<std::string> words;
  for (const Suite::Part& part : suite.parts) {
    commands.push_back(part.command);
    words.push_back(part.command->word());
  }
  if (printManual(argc, argv, suite.program, suite.summary, commands)) return kExitDone;
  const std::string word = argc > 1 ? argv[1] : "";
  if (word == "--help" || word == "-h" || word == "--version") {
    const std::string text = word == "--version" ? suite.program + " " TET4D_VERSION "\n" : suiteHelp(suite);
    std::fputs(text.c_str(), stdout);
    flushStandardOutput();
    return kExitDone;
  }
  for (const Suite::Part& part : suite.parts) {
    if (part.command->word() == word) return parseAndRun(argc - 1, argv + 1, *part.command, part.body);
  }
  std::string list;
  for (const std::string& one : words) list += (list.empty() ? "" : ", ") + one;
  const std::string meant = nearest(word, words);
  throw Error(FaultCode::kUsage, "", word.empty() ? "" : "'" + word + "'",
              word.empty() ? "no command is given; there are " + list : "is no command; there are " + list,
              meant.empty() ? "see --help" : "did you mean " + meant + "?");
}

// The project's one catch.
int catchAll(const std::string& program, const std::function<std::uint64_t()>& memory,
             const std::function<int()>& work) {
  installSignals();
  try {
    return work();
  } catch (const Error& error) {
    return report(program, error.fault());
  } catch (const std::bad_alloc&) {
    const std::uint64_t limit = memory();
    return report(program,
                  {FaultCode::kOutOfMemory, "", "", "the machine has no more memory to give",
                   limit != 0 ? "--memory bounds what is planned, not what the machine has to give: it must have room "
                                "for the plan and the program itself, or give fewer --threads"
                              : "use a machine with more memory, or fewer threads"});
  } catch (const std::system_error& error) {
    const bool full = error.code() == std::errc::no_space_on_device;
    return report(program, {full ? FaultCode::kNoSpace : FaultCode::kIo, "", "", error.what(), ""});
  } catch (const std::exception& error) {
    return report(program, {FaultCode::kIo, "", "", error.what(), ""});
  }
}

}  // namespace

int run(int argc, char** argv, Command& command, const std::function<int(Session&)>& body) {
  const auto memory = [&] { return command.commonOptions().memory_bytes; };
  return catchAll(command.program(), memory, [&] {
    if (printManual(argc, argv, command.program(), command.summary(), {&command})) return kExitDone;
    return parseAndRun(argc, argv, command, body);
  });
}

int run(int argc, char** argv, Suite& suite) {
  const auto memory = [&] {
    std::uint64_t most = 0;
    for (const Suite::Part& part : suite.parts) most = std::max(most, part.command->commonOptions().memory_bytes);
    return most;
  };
  return catchAll(suite.program, memory, [&] { return runSuite(argc, argv, suite); });
}

}  // namespace tet4d::cli

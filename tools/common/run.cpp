#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <system_error>

#include "libpreprocess/error.h"
#include "libpreprocess/outofcore/output_file.h"
#include "tools/common/cli.h"
#include "tools/common/exit_codes.h"
#include "tools/common/files.h"

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

}  // namespace

int run(int argc, char** argv, Command& command, const std::function<int(Session&)>& body) {
  installSignals();
  const std::string& program = command.program();
  try {
    return parseAndRun(argc, argv, command, body);
  } catch (const Error& error) {
    return report(program, error.fault());
  } catch (const std::bad_alloc&) {
    const std::uint64_t limit = command.commonOptions().memory_bytes;
    return report(program, {FaultCode::kOutOfMemory, "", "", "the machine has no more memory to give",
                            limit != 0 ? "give a smaller --memory or fewer --threads"
                                       : "use a machine with more memory, or fewer threads"});
  } catch (const std::system_error& error) {
    const bool full = error.code() == std::errc::no_space_on_device;
    return report(program, {full ? FaultCode::kNoSpace : FaultCode::kIo, "", "", error.what(), ""});
  } catch (const std::exception& error) {
    return report(program, {FaultCode::kIo, "", "", error.what(), ""});
  }
}

}  // namespace tet4d::cli

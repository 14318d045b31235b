// A program that does nothing but what all programs have in common: its cases hold for every other one.
#include <chrono>
#include <cstdio>
#include <new>
#include <stdexcept>
#include <thread>
#include <vector>

#include "libpreprocess/error.h"
#include "libpreprocess/outofcore/output_file.h"
#include "tools/common/cli.h"

namespace {

using namespace tet4d;

struct Options {
  std::string input, split = "hull", fail = "no";
  double iso = 0.5;
  std::optional<double> error;
  std::vector<double> times;
  std::array<std::uint32_t, 2> size{640, 480};
  std::uint64_t steps = 4, step_ms = 0, hold_bytes = 0;
};

void failAs(const std::string& how) {
  const auto as = [](FaultCode code) { throw Error(code, "in.nrrd", "frame 3", "is odd", "mend it"); };
  if (how == "usage") as(FaultCode::kUsage);
  if (how == "input") as(FaultCode::kBadInput);
  if (how == "io") as(FaultCode::kIo);
  if (how == "memory") as(FaultCode::kOutOfMemory);
  if (how == "space") as(FaultCode::kNoSpace);
  if (how == "not-built") as(FaultCode::kNotBuilt);
  if (how == "bad-alloc") throw std::bad_alloc();
  if (how == "allocation") std::vector<char>(std::size_t{1} << 30, 'x').at(12) = 'y';
  if (how == "other") throw std::runtime_error("unforeseen");
}

int body(const Options& options, cli::Session& session) {
  const auto held = session.memory().reserve(options.hold_bytes, "the held block");
  for (const char* phase : {"read", "write"}) {
    session.progress().phase(phase, options.steps);
    for (std::uint64_t step = 0; step < options.steps; ++step) {
      session.executor().run(
          2, [&](std::size_t) { std::this_thread::sleep_for(std::chrono::milliseconds(options.step_ms)); });
      session.progress().step(step + 1);
    }
  }
  failAs(options.fail);
  session.stats().count("points", options.steps);
  session.stats().error("distance", 0.25);
  session.note("a note");
  session.detail("a detail");

  std::vector<cli::Input> inputs;
  if (!options.input.empty()) {
    session.dependsOn(options.input);
    inputs.push_back({options.input, cli::fileDigest(options.input)});
  }
  if (!session.options().output.empty() && !session.options().dry_run) {
    outofcore::OutputFile out(session.options().output, session.options().force);
    out.write(session.provenance(inputs));
    out.write(std::string_view("\n"));
    out.commit();
  }
  for (const double time : options.times) std::printf("%g\n", time);
  return options.fail == "validation" ? (session.warn("a fault was found"), 5) : 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  cli::Command command("cli-probe", "Does what all programs have in common.");
  command.example("cli-probe in.nrrd -o out.txt", "an example")
      .positional("FILE", "an input", &options.input, true)
      .option("--iso", "V", "isovalue", &options.iso)
      .option("--error", "E", "most error", &options.error)
      .option("--split", "WAY", "how to split", cli::Choice{&options.split, {"hull", "kuhn"}})
      .option("--times", "A:B:STEP", "times to print", cli::Times{&options.times})
      .option("--size", "WxH", "of a picture", cli::Extent{&options.size})
      .heading("Testing")
      .option("--fail", "HOW", "how to fail",
              cli::Choice{&options.fail,
                          {"no", "usage", "input", "io", "memory", "space", "not-built", "bad-alloc", "allocation",
                           "other", "validation"}},
              cli::kKeepsResult)
      .option("--steps", "N", "steps of a phase", &options.steps, cli::kKeepsResult)
      .option("--step-ms", "N", "length of a step", &options.step_ms, cli::kKeepsResult)
      .option("--hold", "SIZE", "memory to reserve", cli::Size{&options.hold_bytes}, cli::kKeepsResult)
      .common({cli::kOutput, cli::kThreads, cli::kMemory, cli::kForce, cli::kDryRun, cli::kSeed, cli::kStats,
               cli::kDepfile});
  return cli::run(argc, argv, command, [&](cli::Session& session) { return body(options, session); });
}

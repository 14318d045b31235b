// tet4d-mc: frames of a volume → hypermesh. Ponchio & Hormann 2008, sec. 4.
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/frame_source.h"
#include "libpreprocess/hypermesh/marching_hypercubes.h"
#include "tools/common/cli.h"
#include "tools/frames/frame_options.h"

namespace {

using namespace tet4d;

struct Arguments {
  std::vector<std::string> frames;
  double iso = 0;
  std::string split = "hull", nan = "outside", codec = "raw";
  frames::FrameOptions frame_options;
};

std::string hex(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

std::string number(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

hypermesh::Options optionsOf(const Arguments& arguments) {
  hypermesh::Options options;
  options.iso = arguments.iso;
  options.split = arguments.split == "kuhn" ? hypermesh::Split::kKuhn : hypermesh::Split::kHull;
  options.nan = arguments.nan == "mask"    ? hypermesh::NanRule::kMask
                : arguments.nan == "error" ? hypermesh::NanRule::kError
                                           : hypermesh::NanRule::kOutside;
  options.page_codec = arguments.codec == "zstd" ? paged::Codec::kZstd : paged::Codec::kRaw;
  return options;
}

void printPlan(exchange::FrameSource& source, const hypermesh::Options& options) {
  const hypermesh::Plan plan = hypermesh::plan(source, options);
  const auto line = [](const char* name, std::uint64_t value) {
    std::printf("%s %llu\n", name, static_cast<unsigned long long>(value));
  };
  line("passes", plan.passes);
  line("fixed_memory_bytes", plan.fixed_bytes);
  line("peak_memory_bytes", plan.fixed_bytes + plan.most_page_bytes);
  line("temporary_bytes", 0);
  line("output_bytes_at_least", plan.least_output_bytes);
  line("output_bytes_at_most", plan.most_output_bytes);
}

void report(const Arguments& arguments, const hypermesh::Stats& stats, cli::Session& session) {
  session.stats().count("vertices", stats.vertices);
  session.stats().count("tets", stats.tets);
  session.stats().count("active_cells", stats.active_cells);
  session.stats().count("masked_cells", stats.masked_cells);
  session.stats().count("nan_samples", stats.nan_samples);
  session.stats().count("frames", stats.frames);
  session.stats().count("voxels", stats.voxels);
  if (stats.min_value > stats.max_value) {
    session.warn("no sample is a number: the hypermesh is empty");
  } else if (stats.tets == 0) {
    session.warn("the hypermesh is empty: isovalue " + number(arguments.iso) + ", samples from " +
                 number(stats.min_value) + " to " + number(stats.max_value));
  }
  if (stats.nan_samples != 0) {
    session.warn(std::to_string(stats.nan_samples) + " samples are NaN: " +
                 (arguments.nan == "mask" ? std::to_string(stats.masked_cells) + " hypercubes that touch one left out"
                                          : "taken as outside (--nan mask leaves their hypercubes out)"));
  }
  session.note(std::to_string(stats.frames) + " frames -> " + std::to_string(stats.tets) + " tetrahedra, " +
               std::to_string(stats.vertices) + " vertices, " + std::to_string(stats.active_cells) +
               " hypercubes crossed");
}

int extract(cli::Session& session, const Arguments& arguments) {
  if (session.options().output == "-") {
    throw Error(FaultCode::kUsage, "", "option --output", "a hypermesh cannot be written to a pipe",
                "name a file: -o X.t4h");
  }
  cli::expectSuffix(session, ".t4h", "name it X.t4h; tet4d-convert makes .vtu, .ply and others of a .t4h");
  const std::unique_ptr<exchange::FrameSource> source =
      frames::openFrames(arguments.frames, arguments.frame_options, session);
  const hypermesh::Options options = optionsOf(arguments);
  if (session.options().dry_run) {
    if (source->isStream()) {
      throw Error(FaultCode::kUsage, "", "option --dry-run", "how many frames a stream has is known at its end only",
                  "give files");
    }
    printPlan(*source, options);
    return 0;
  }
  hypermesh::Writer writer =
      hypermesh::createWriter(session.options().output, *source, options, session.options().force);
  const hypermesh::Stats stats =
      hypermesh::buildHypermesh(*source, writer, options, session.executor(), session.memory(), session.progress());
  // One digest over all samples: files, one file of many frames and a stream then leave the same provenance.
  const cli::Input input{"frames", hex(stats.samples_xxh3)};
  unwrap(writer.close(session.provenance({&input, 1})));
  report(arguments, stats, session);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  cli::Command command("tet4d-mc", "Extracts the isosurface of a sequence of volumes as one mesh in space-time.");
  command.example("tet4d-mc frames/*.nrrd --iso 0.5 -o drop.t4h", "the surface where the field is 0.5, at all times")
      .example("tet4d-mc volume4d.nrrd --iso 128 --nan mask -o scan.t4h", "samples that are NaN leave holes")
      .example("tet4d-mc alpha_%04d.nrrd --iso 0.5 --times times.txt -o dam.t4h", "frames at times of your own")
      .example("tet4d-mc run.raw --size 64,64,64 --type f32 --iso 0.5 -o run.t4h", "raw frames behind each other")
      .example("simulate | tet4d-mc - --iso 0.5 -o run.t4h", "NRRDs as they come, while the simulation runs")
      .positional("FRAMES", frames::kFramesHelp, &arguments.frames)
      .option("--iso", "V", "isovalue: samples at or above it are inside", &arguments.iso, cli::kMustBeGiven)
      .option("--split", "WAY",
              "how a hypercube is cut: by convex hulls, or into 24 pentatopes (5 times the tetrahedra)",
              cli::Choice{&arguments.split, {"hull", "kuhn"}})
      .option("--nan", "RULE", "what a NaN is: outside, a hole (mask), or an error",
              cli::Choice{&arguments.nan, {"outside", "mask", "error"}})
      .option("--page-codec", "CODEC", "how pages are stored", cli::Choice{&arguments.codec, {"raw", "zstd"}});
  frames::addFrameOptions(command, arguments.frame_options);
  command.common(
      {cli::kOutputRequired, cli::kThreads, cli::kMemory, cli::kForce, cli::kDryRun, cli::kStats, cli::kDepfile});
  return cli::run(argc, argv, command, [&](cli::Session& session) { return extract(session, arguments); });
}

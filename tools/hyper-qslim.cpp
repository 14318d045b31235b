// hyper-qslim: a hypermesh → a smaller one. Ponchio & Hormann 2008, sec. 5.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>

#include "formats/hypermesh.h"
#include "libpreprocess/error.h"
#include "libpreprocess/measure/slice_distance.h"
#include "libpreprocess/qslim4d/mesh_file.h"
#include "libpreprocess/qslim4d/simplify.h"
#include "tools/common/cli.h"

namespace {

using namespace tet4d;

struct Options {
  std::string input, metric = "slice", order = "passes", codec = "raw";
  std::optional<double> ratio, error, align_time;
  std::optional<std::uint64_t> tets;
  std::uint64_t choices = 8, most_star = 80, measure_times = 7;
};

void checkOptions(const Options& options) {
  const auto refuse = [](const std::string& place, const std::string& what, const std::string& remedy) {
    throw Error(FaultCode::kUsage, "", place, what, remedy);
  };
  if (!options.ratio && !options.tets && !options.error)
    refuse("", "no stop is given", "give --ratio 0.1, --tets 100000 or --error 0.5");
  if (options.ratio && options.tets) refuse("", "--ratio and --tets are both given", "give one of the two");
  if (options.ratio && !(*options.ratio > 0 && *options.ratio <= 1))
    refuse("--ratio", "expected a number above 0 and at most 1", "give --ratio 0.1");
  if (options.error && !(*options.error >= 0)) refuse("--error", "expected a length of 0 or more", "give --error 0.5");
  if (options.align_time && !(*options.align_time >= 0))
    refuse("--align-time", "expected a number of 0 or more", "give --align-time 0.25");
  if (options.choices == 0) refuse("--choices", "expected at least 1", "give --choices 8");
  if (options.most_star < 8 || options.most_star > 100'000)
    refuse("--max-star", "expected 8 to 100000", "give --max-star 80");
}

qslim4d::Options slimOptions(const Options& options, const cli::Session& session, std::uint64_t tets) {
  qslim4d::Options slim;
  slim.order = options.order == "heap"          ? qslim4d::Order::kHeap
               : options.order == "multichoice" ? qslim4d::Order::kMultichoice
                                                : qslim4d::Order::kPasses;
  if (options.tets) slim.target_tets = *options.tets;
  if (options.ratio)
    slim.target_tets = static_cast<std::uint64_t>(std::floor(*options.ratio * static_cast<double>(tets)));
  if (options.error) slim.most_error = *options.error;
  slim.choices = options.choices;
  slim.seed = session.options().seed;
  if (options.align_time) slim.rules.align = *options.align_time;
  slim.rules.most_star = static_cast<std::uint32_t>(options.most_star);
  return slim;
}

void warnOfLoss(cli::Session& session, const hypermesh::File& mesh) {
  if (mesh.columns().empty()) return;
  std::string names;
  for (const ColumnEntry& column : mesh.columns()) names += (names.empty() ? "" : ", ") + std::string(column.name);
  session.warn(mesh.reader().path() + ": columns are not carried over: " + names);
}

// What the slices really lost, by a pass that knows nothing of quadrics.
void measure(cli::Session& session, const hypermesh::File& reference, std::uint64_t times) {
  const hypermesh::File result = unwrap(hypermesh::File::open(session.options().output));
  const auto frames = measure::sampleFrames(reference, times);
  measure::DistanceOptions options;
  const measure::SliceDistance distance =
      measure::compareSlices(result, reference, frames, options, session.executor(), session.progress());
  session.stats().error("slice_rms_world", distance.rms);
  session.stats().error("slice_p99_world", distance.p99);
  session.stats().error("slice_max_world", distance.max);
  session.stats().error("slice_volume_relative", distance.volume_error);
  char text[160];
  std::snprintf(text, sizeof text, "measured at %zu times: rms %.3g, 99 %% within %.3g, largest %.3g world units",
                frames.size(), distance.rms, distance.p99, distance.max);
  session.note(text);
}

void tell(cli::Session& session, const qslim4d::SlimMesh& mesh, const qslim4d::Stats& stats, std::uint64_t tets_in) {
  cli::Stats& record = session.stats();
  record.count("tets", mesh.live_tets);
  record.count("vertices", mesh.live_vertices);
  record.count("collapses", stats.collapses);
  record.count("aligned_collapses", stats.aligned);
  static constexpr std::array<const char*, 6> kVerdicts{"allowed",       "refused_walls",     "refused_links",
                                                        "refused_flips", "refused_flat_time", "refused_stars"};
  for (std::size_t i = 1; i < kVerdicts.size(); ++i) record.count(kVerdicts[i], stats.verdicts[i]);
  record.count("rounds", stats.rounds);
  record.error("quadric_world", stats.largest_error);
  char text[160];
  std::snprintf(
      text, sizeof text, "%llu -> %llu tets, %llu collapses (%.0f %% aligned in time), quadric error %.3g",
      static_cast<unsigned long long>(tets_in), static_cast<unsigned long long>(mesh.live_tets),
      static_cast<unsigned long long>(stats.collapses),
      stats.collapses == 0 ? 0.0 : 100.0 * static_cast<double>(stats.aligned) / static_cast<double>(stats.collapses),
      stats.largest_error);
  session.note(text);
}

int slim(cli::Session& session, const Options& options) {
  checkOptions(options);
  cli::expectSuffix(session, ".t4h", "name it X.t4h");
  const hypermesh::File file = unwrap(hypermesh::File::open(options.input));
  session.dependsOn(options.input);
  warnOfLoss(session, file);
  const std::uint64_t bound = qslim4d::boundMemory(file);
  if (session.options().dry_run) {
    std::printf("passes 1\npeak_memory_bytes %llu\ntemporary_bytes 0\noutput_bytes_at_most %llu\n",
                static_cast<unsigned long long>(bound),
                static_cast<unsigned long long>(file.header().tets * 16 + file.header().vertices * 32 + 65536));
    return 0;
  }
  const auto reserved = session.memory().reserve(bound, "the mesh, which is simplified in core");
  hypermesh::Writer writer = [&] {
    hypermesh::MeshHeader header{};
    header.flags = file.header().flags;
    header.index_to_world = file.header().index_to_world;
    header.domain = file.header().domain;
    header.isovalue = file.header().isovalue;
    return unwrap(hypermesh::Writer::create(session.options().output, header, file.times(), {},
                                            options.codec == "zstd" ? paged::Codec::kZstd : paged::Codec::kRaw,
                                            session.options().force));
  }();
  const auto metric = options.metric == "paper" ? qslim4d::Metric::kPaper : qslim4d::Metric::kSlice;
  qslim4d::SlimMesh mesh = qslim4d::readMesh(file, metric, session.progress());
  const std::uint64_t tets_in = mesh.live_tets;
  const qslim4d::Options slim_options = slimOptions(options, session, tets_in);
  const qslim4d::Stats stats = qslim4d::simplify(mesh, slim_options, session.executor(), session.progress());
  if (stats.stalled && !options.error) {
    session.warn("no collapse is left that keeps the mesh a manifold without flips: " + std::to_string(mesh.live_tets) +
                 " tets remain");
  }
  qslim4d::writeMesh(mesh, stats.largest_error, writer, session.progress());
  char digest[17];
  std::snprintf(digest, sizeof digest, "%016llx", static_cast<unsigned long long>(unwrap(file.contentDigest())));
  const cli::Input provenance{"hypermesh", digest};
  unwrap(writer.close(session.provenance({&provenance, 1})));
  tell(session, mesh, stats, tets_in);
  if (options.measure_times > 0 && mesh.live_tets > 0) measure(session, file, options.measure_times);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options o;
  cli::Command command("hyper-qslim", "Simplifies a hypermesh by edge collapses under a quadric error in space-time.");
  command.example("hyper-qslim dam.t4h --ratio 0.1 -o dam-10.t4h", "a tenth of the tetrahedra")
      .example("hyper-qslim dam.t4h --error 0.02 -o dam-fine.t4h", "as few as an error of 0.02 world units allows")
      .positional("FILE", "hypermesh (.t4h)", &o.input)
      .heading("Stops")
      .option("--ratio", "R", "stop at R times the tetrahedra", &o.ratio)
      .option("--tets", "N", "stop at N tetrahedra", &o.tets)
      .option("--error", "E", "make no collapse whose quadric error is above E, world units; an estimate", &o.error)
      .heading("Simplification")
      .option("--metric", "WHICH", "slice: spatial distance at fixed time; paper: raw 4D normals",
              cli::Choice{&o.metric, {"slice", "paper"}})
      .option("--order", "WHICH",
              "passes: parallel rounds; multichoice: best of random edges; heap: exact, the slowest",
              cli::Choice{&o.order, {"passes", "multichoice", "heap"}})
      .option("--choices", "N", "random edges that multichoice compares", &o.choices)
      .option("--align-time", "A",
              "a vertex goes to the time of an end or a frame if that costs up to 1 + A times the least; default 0.25",
              &o.align_time)
      .option("--max-star", "N", "most tetrahedra at a vertex that a collapse may leave", &o.most_star)
      .heading("Output")
      .option("--measure", "N", "compare slices at N times with the input's and print the distance; 0: do not",
              &o.measure_times, cli::kKeepsResult)
      .option("--page-codec", "CODEC", "how pages are stored", cli::Choice{&o.codec, {"raw", "zstd"}})
      .heading("General")
      .common({cli::kOutputRequired, cli::kThreads, cli::kMemory, cli::kForce, cli::kDryRun, cli::kSeed, cli::kStats,
               cli::kDepfile});
  return cli::run(argc, argv, command, [&](cli::Session& session) { return slim(session, o); });
}

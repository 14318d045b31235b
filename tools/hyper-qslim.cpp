// hyper-qslim: a hypermesh → a smaller one. Ponchio & Hormann 2008, sec. 5.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>

#include "formats/hypermesh.h"
#include "libpreprocess/error.h"
#include "libpreprocess/measure/slice_distance.h"
#include "libpreprocess/qslim4d/cells.h"
#include "libpreprocess/qslim4d/mesh_file.h"
#include "libpreprocess/qslim4d/simplify.h"
#include "tools/common/cli.h"

namespace {

using namespace tet4d;

struct Options {
  std::string input, metric = "slice", order = "passes", codec = "raw";
  std::optional<double> ratio, error, align_time;
  std::optional<std::uint64_t> tets;
  std::uint64_t choices = 8, most_star = 80, measure_times = 7, cell_tets = qslim4d::kCellTets;
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
  if (options.cell_tets < 1000) refuse("--cell-tets", "expected at least 1000", "leave it at its default");
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

// What was simplified, however it was done.
struct Outcome {
  std::uint64_t vertices = 0, tets = 0;
  qslim4d::Stats stats;
};

void tell(cli::Session& session, const Outcome& outcome, std::uint64_t tets_in) {
  cli::Stats& record = session.stats();
  const qslim4d::Stats& stats = outcome.stats;
  record.count("tets", outcome.tets);
  record.count("vertices", outcome.vertices);
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
      static_cast<unsigned long long>(tets_in), static_cast<unsigned long long>(outcome.tets),
      static_cast<unsigned long long>(stats.collapses),
      stats.collapses == 0 ? 0.0 : 100.0 * static_cast<double>(stats.aligned) / static_cast<double>(stats.collapses),
      stats.largest_error);
  session.note(text);
}

qslim4d::Metric metricOf(const Options& options) {
  return options.metric == "paper" ? qslim4d::Metric::kPaper : qslim4d::Metric::kSlice;
}

// The heap has one order for the whole mesh.
bool isCut(const Options& options, const hypermesh::File& file) {
  return options.order != "heap" && file.header().tets > options.cell_tets;
}

Outcome slimInCore(cli::Session& session, const Options& options, const hypermesh::File& file,
                   hypermesh::Writer& writer) {
  const auto reserved = session.memory().reserve(qslim4d::boundMemory(file), "the mesh, which is simplified in core");
  qslim4d::SlimMesh mesh = qslim4d::readMesh(file, metricOf(options), session.progress());
  const qslim4d::Options slim_options = slimOptions(options, session, mesh.live_tets);
  const qslim4d::Stats stats = qslim4d::simplify(mesh, slim_options, session.executor(), session.progress());
  qslim4d::writeMesh(mesh, stats.largest_error, writer, session.progress());
  return {mesh.live_vertices, mesh.live_tets, stats};
}

std::string cellFolder(const cli::Session& session) {
  const std::filesystem::path output = session.options().output, dir = session.options().temp_dir;
  return ((dir.empty() ? output.parent_path() : dir) / output.filename()).string() + ".cells";
}

Outcome slimInCells(cli::Session& session, const Options& options, const hypermesh::File& file,
                    const std::string& provenance, hypermesh::Writer& writer) {
  qslim4d::CellOptions cells;
  cells.cell_tets = options.cell_tets;
  cells.folder = cellFolder(session);
  cells.run_name = provenance;
  cells.resume = session.options().resume;
  const qslim4d::CellReport report =
      qslim4d::simplifyInCells(file, metricOf(options), slimOptions(options, session, file.header().tets), cells,
                               writer, session.executor(), session.memory(), session.progress());
  std::string cut;
  for (std::size_t i = 0; i < report.sweeps.size(); ++i) {
    const qslim4d::SweepReport& sweep = report.sweeps[i];
    session.stats().count("cells_of_sweep_" + std::to_string(i + 1), sweep.cells);
    cut += (i == 0 ? "" : ", then ") + std::to_string(sweep.cells) + (sweep.cells == 1 ? " cell" : " cells") + " to " +
           std::to_string(sweep.tets_out) + " tets";
  }
  session.stats().count("cells_in_flight", report.most_in_flight);
  session.note(cut);
  return {report.vertices, report.tets, report.stats};
}

void printPlan(const Options& options, const hypermesh::File& file) {
  const bool is_cut = isCut(options, file);
  const std::uint64_t memory = is_cut ? qslim4d::boundCellMemory(file, options.cell_tets) : qslim4d::boundMemory(file);
  std::printf("passes %d\npeak_memory_bytes %llu\ntemporary_bytes %llu\noutput_bytes_at_most %llu\n", is_cut ? 3 : 1,
              static_cast<unsigned long long>(memory),
              static_cast<unsigned long long>(is_cut ? qslim4d::boundTemporaryBytes(file) : 0),
              static_cast<unsigned long long>(file.header().tets * 16 + file.header().vertices * 32 + 65536));
}

int slim(cli::Session& session, const Options& options) {
  checkOptions(options);
  cli::expectSuffix(session, ".t4h", "name it X.t4h");
  const hypermesh::File file = unwrap(hypermesh::File::open(options.input));
  session.dependsOn(options.input);
  warnOfLoss(session, file);
  if (session.options().dry_run) {
    printPlan(options, file);
    return 0;
  }
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
  char digest[17];
  std::snprintf(digest, sizeof digest, "%016llx", static_cast<unsigned long long>(unwrap(file.contentDigest())));
  const cli::Input input{"hypermesh", digest};
  const std::string provenance = session.provenance({&input, 1});
  const Outcome outcome = isCut(options, file) ? slimInCells(session, options, file, provenance, writer)
                                               : slimInCore(session, options, file, writer);
  if (outcome.stats.stalled && !options.error) {
    session.warn("no collapse is left that keeps the mesh a manifold without flips: " + std::to_string(outcome.tets) +
                 " tets remain");
  }
  unwrap(writer.close(provenance));
  tell(session, outcome, file.header().tets);
  if (options.measure_times > 0 && outcome.tets > 0) measure(session, file, options.measure_times);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options o;
  cli::Command command("hyper-qslim", "Simplifies a hypermesh by edge collapses under a quadric error in space-time.");
  command.example("hyper-qslim dam.t4h --ratio 0.1 -o dam-10.t4h", "a tenth of the tetrahedra")
      .example("hyper-qslim dam.t4h --error 0.02 -o dam-fine.t4h", "as few as an error of 0.02 world units allows")
      .example("hyper-qslim huge.t4h --ratio 0.01 --memory 4G --temp-dir /scratch -o small.t4h",
               "a mesh larger than memory, cell by cell; --resume goes on after an interrupt")
      .positional("FILE", "hypermesh (.t4h)", &o.input)
      .heading("Stops")
      .option("--ratio", "R", "stop at R times the tetrahedra", &o.ratio)
      .option("--tets", "N", "stop at N tetrahedra", &o.tets)
      .option("--error", "E", "make no collapse whose quadric error is above E, world units; an estimate", &o.error)
      .heading("Simplification")
      .option("--metric", "WHICH", "slice: spatial distance at fixed time; paper: raw 4D normals",
              cli::Choice{&o.metric, {"slice", "paper"}})
      .option("--order", "WHICH",
              "passes: parallel rounds; multichoice: best of random edges; heap: exact, the slowest, always in core",
              cli::Choice{&o.order, {"passes", "multichoice", "heap"}})
      .option("--choices", "N", "random edges that multichoice compares", &o.choices)
      .option("--align-time", "A",
              "a vertex goes to the time of an end or a frame if that costs up to 1 + A times the least; default 0.25",
              &o.align_time)
      .option("--max-star", "N", "most tetrahedra at a vertex that a collapse may leave", &o.most_star)
      .option("--cell-tets", "N",
              "a mesh of more tetrahedra is simplified in cells of at most so many, out of core; not with --order heap",
              &o.cell_tets)
      .heading("Output")
      .option("--measure", "N", "compare slices at N times with the input's and print the distance; 0: do not",
              &o.measure_times, cli::kKeepsResult)
      .option("--page-codec", "CODEC", "how pages are stored", cli::Choice{&o.codec, {"raw", "zstd"}})
      .heading("General")
      .common({cli::kOutputRequired, cli::kThreads, cli::kMemory, cli::kTempDir, cli::kForce, cli::kDryRun,
               cli::kResume, cli::kSeed, cli::kStats, cli::kDepfile});
  return cli::run(argc, argv, command, [&](cli::Session& session) { return slim(session, o); });
}

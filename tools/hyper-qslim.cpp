// hyper-qslim: a hypermesh → a smaller one. Ponchio & Hormann 2008, sec. 5.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/column_list.h"
#include "libpreprocess/error.h"
#include "libpreprocess/measure/column_distance.h"
#include "libpreprocess/measure/slice_distance.h"
#include "tools/common/cli.h"
#include "tools/common/exit_codes.h"
#include "tools/qslim/options.h"
#include "tools/qslim/simplify_parts.h"

namespace {

using namespace tet4d;
using qslim::Options;
using qslim::SimplifiedPart;

void tellColumns(cli::Session& session, const hypermesh::File& result, const hypermesh::File& reference,
                 const std::vector<double>& frames) {
  for (const measure::ColumnDistance& column : measure::compareColumns(result, reference, frames, session.progress())) {
    session.stats().error("column_" + column.name + "_rms", column.rms);
    session.stats().error("column_" + column.name + "_max", column.max);
    char text[120];
    std::snprintf(text, sizeof text, "column %s: rms %.3g, largest %.3g of its unit", column.name.c_str(), column.rms,
                  column.max);
    session.note(text);
  }
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
  tellColumns(session, result, reference, frames);
}

// Over all parts.
struct Sum {
  qslim4d::Stats stats;
  std::uint64_t tets = 0, vertices = 0, tets_in = 0, tries = 0, stalled_tets = 0;
  qslim4d::NonManifold non_manifold;
  double bound = 0, estimate = std::numeric_limits<double>::infinity();
};

Sum sumOf(const std::vector<SimplifiedPart>& parts) {
  Sum sum;
  for (const SimplifiedPart& part : parts) {
    sum.stats.collapses += part.stats.collapses;
    sum.stats.aligned += part.stats.aligned;
    sum.stats.rounds += part.stats.rounds;
    sum.stats.largest_error = std::max(sum.stats.largest_error, part.stats.largest_error);
    for (std::size_t i = 0; i < sum.stats.verdicts.size(); ++i) sum.stats.verdicts[i] += part.stats.verdicts[i];
    sum.tets += part.mesh.tets.size();
    sum.vertices += part.mesh.vertices.size();
    sum.tets_in += part.tets_in;
    sum.tries += part.tries;
    if (part.stats.stalled) sum.stalled_tets += part.mesh.tets.size();
    sum.non_manifold.triangles += part.non_manifold.triangles;
    sum.non_manifold.vertices += part.non_manifold.vertices;
    sum.bound = std::max(sum.bound, part.measured);
    sum.estimate = std::min(sum.estimate, part.estimate);
  }
  return sum;
}

void tell(cli::Session& session, const Options& options, const Sum& sum) {
  cli::Stats& record = session.stats();
  const qslim4d::Stats& stats = sum.stats;
  record.count("tets", sum.tets);
  record.count("vertices", sum.vertices);
  record.count("collapses", stats.collapses);
  record.count("aligned_collapses", stats.aligned);
  static constexpr std::array<const char*, 6> kVerdicts{"allowed",       "refused_walls",     "refused_links",
                                                        "refused_flips", "refused_flat_time", "refused_stars"};
  for (std::size_t i = 1; i < kVerdicts.size(); ++i) record.count(kVerdicts[i], stats.verdicts[i]);
  record.count("rounds", stats.rounds);
  record.error("quadric_world", stats.largest_error);
  char text[200];
  std::snprintf(
      text, sizeof text, "%llu -> %llu tets, %llu collapses (%.0f %% aligned in time), quadric error %.3g",
      static_cast<unsigned long long>(sum.tets_in), static_cast<unsigned long long>(sum.tets),
      static_cast<unsigned long long>(stats.collapses),
      stats.collapses == 0 ? 0.0 : 100.0 * static_cast<double>(stats.aligned) / static_cast<double>(stats.collapses),
      stats.largest_error);
  session.note(text);
  if (options.non_manifold == "keep") {
    record.count("non_manifold_triangles", sum.non_manifold.triangles);
    record.count("non_manifold_vertices", sum.non_manifold.vertices);
    std::snprintf(text, sizeof text,
                  "left as they are: %llu triangles in more than two tetrahedra, %llu vertices that are no manifold",
                  static_cast<unsigned long long>(sum.non_manifold.triangles),
                  static_cast<unsigned long long>(sum.non_manifold.vertices));
    session.note(text);
  }
  if (options.max_error) {
    record.count("tries", sum.tries);
    record.error("promised_world", *options.max_error);
    record.error("confirmed_bound_world", sum.bound);
    record.error("estimate_world", sum.estimate);
  }
}

// What --max-error came to where it could not be kept; nothing has been written.
int tellFailure(cli::Session& session, const Options& options, const SimplifiedPart& part) {
  session.stats().count("tries", part.tries);
  session.stats().error("promised_world", *options.max_error);
  session.stats().error("least_measured_world", part.measured);
  session.stats().error("estimate_world", part.estimate);
  char text[200];
  std::snprintf(text, sizeof text,
                "--max-error: %llu tries did not come to %.3g world units: the least that was measured is %.3g, "
                "under an estimate of %.3g",
                static_cast<unsigned long long>(part.tries), *options.max_error, part.measured, part.estimate);
  session.warn(text);
  session.warn("nothing is written; promise more, or give more --tries");
  return cli::kExitFailure;
}

hypermesh::Writer createWriter(const cli::Session& session, const hypermesh::File& file, const Options& options,
                               const std::vector<qslim4d::ColumnWish>& wishes) {
  hypermesh::MeshHeader header{};
  header.flags = file.header().flags;
  header.index_to_world = file.header().index_to_world;
  header.domain = file.header().domain;
  header.isovalue = file.header().isovalue;
  std::vector<Column> columns;
  for (const qslim4d::ColumnWish& wish : wishes)
    columns.push_back({columnName(file.columns()[wish.column]), file.columns()[wish.column].components});
  std::vector<double> isovalues;
  for (const PartEntry& part : file.parts()) isovalues.push_back(part.isovalue);
  return unwrap(hypermesh::Writer::create(session.options().output, header, file.times(), columns,
                                          options.codec == "zstd" ? paged::Codec::kZstd : paged::Codec::kRaw,
                                          session.options().force, isovalues));
}

void write(cli::Session& session, const hypermesh::File& file, std::vector<SimplifiedPart> parts,
           hypermesh::Writer writer) {
  std::vector<qslim4d::PackedMesh> meshes;
  for (SimplifiedPart& part : parts) meshes.push_back(std::move(part.mesh));
  qslim4d::writeMeshes(meshes, writer, session.progress());
  char digest[17];
  std::snprintf(digest, sizeof digest, "%016llx", static_cast<unsigned long long>(unwrap(file.contentDigest())));
  const cli::Input provenance{"hypermesh", digest};
  unwrap(writer.close(session.provenance({&provenance, 1})));
}

int slim(cli::Session& session, const Options& options) {
  checkOptions(options);
  cli::expectSuffix(session, ".t4h", "name it X.t4h");
  const hypermesh::File file = unwrap(hypermesh::File::open(options.input));
  session.dependsOn(options.input);
  const std::vector<qslim4d::ColumnWish> wishes = columnWishes(options, file);
  const std::uint64_t bound = qslim::boundMemory(file, options, wishes);
  if (session.options().dry_run) {
    std::uint64_t vertex_bytes = 32;
    for (const qslim4d::ColumnWish& wish : wishes) vertex_bytes += 4 * file.columns()[wish.column].components;
    std::printf("passes %llu\npeak_memory_bytes %llu\ntemporary_bytes 0\noutput_bytes_at_most %llu\n",
                static_cast<unsigned long long>(options.max_error ? options.tries : 1),
                static_cast<unsigned long long>(bound),
                static_cast<unsigned long long>(file.header().tets * 16 + file.header().vertices * vertex_bytes +
                                                (1 + wishes.size()) * (file.geometryPages() + 1) * 512 + 65536));
    return 0;
  }
  const auto reserved = session.memory().reserve(bound, "the mesh, which is simplified in core");
  hypermesh::Writer writer = createWriter(session, file, options, wishes);
  std::vector<SimplifiedPart> parts =
      qslim::simplifyParts(session, file, options, qslim4d::planColumns(file, wishes, session.progress()));
  if (!parts.empty() && !parts.back().is_kept) return tellFailure(session, options, parts.back());
  const Sum sum = sumOf(parts);
  if (sum.stalled_tets > 0 && !options.error && !options.max_error) {
    session.warn("no collapse is left that keeps the mesh a manifold without flips: " +
                 std::to_string(sum.stalled_tets) + " tets remain");
  }
  write(session, file, std::move(parts), std::move(writer));
  tell(session, options, sum);
  if (options.max_error) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "promised %.3g world units: slices at every frame and between stay within %.3g; %llu tries, "
                  "estimate %.3g",
                  *options.max_error, sum.bound, static_cast<unsigned long long>(sum.tries), sum.estimate);
    session.note(text);
  }
  if (options.measure_times > 0 && sum.tets > 0) measure(session, file, options.measure_times);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  qslim::Options o;
  cli::Command command("hyper-qslim", "Simplifies a hypermesh by edge collapses under a quadric error in space-time.");
  command.example("hyper-qslim dam.t4h --ratio 0.1 -o dam-10.t4h", "a tenth of the tetrahedra")
      .example("hyper-qslim dam.t4h --error 0.02 -o dam-fine.t4h", "as few as an error of 0.02 world units allows")
      .example("hyper-qslim dam.t4h --max-error 0.5 -o dam-sure.t4h", "no slice farther off than half a world unit")
      .positional("FILE", "hypermesh (.t4h)", &o.input)
      .heading("Stops")
      .option("--ratio", "R", "stop at R times the tetrahedra", &o.ratio)
      .option("--tets", "N", "stop at N tetrahedra", &o.tets)
      .option("--error", "E", "make no collapse whose quadric error is above E, world units; an estimate", &o.error)
      .option(
          "--max-error", "E",
          "no slice is farther than E from the input's, world units: a promise, proven at every frame's time and once "
          "between frames, or the program fails",
          &o.max_error)
      .option("--tries", "N", "how often --max-error may begin again from the input", &o.tries)
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
      .option(
          "--non-manifold", "WHAT",
          "where more than two tetrahedra meet in a triangle: refuse the mesh, or keep such places, and vertices whose "
          "surroundings are no ball, as they are",
          cli::Choice{&o.non_manifold, {"refuse", "keep"}})
      .option("--columns", "LIST", "columns to carry over, beside those of --attributes: names, all or none", &o.columns)
      .option("--attributes", "LIST",
              "columns whose change counts as an error: NAME[:WEIGHT],…, all or none; a change by one counts as WEIGHT "
              "world "
              "units, without it the column's whole range counts as ten cells",
              &o.attributes)
      .heading("Output")
      .option("--measure", "N", "compare slices at N times with the input's and print the distance; 0: do not",
              &o.measure_times, cli::kKeepsResult)
      .option("--page-codec", "CODEC", "how pages are stored", cli::Choice{&o.codec, {"raw", "zstd"}})
      .heading("General")
      .common({cli::kOutputRequired, cli::kThreads, cli::kMemory, cli::kForce, cli::kDryRun, cli::kSeed, cli::kStats,
               cli::kDepfile});
  return cli::run(argc, argv, command, [&](cli::Session& session) { return slim(session, o); });
}

// hyper-qslim: a hypermesh → a smaller one. Ponchio & Hormann 2008, sec. 5.
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/column_list.h"
#include "libpreprocess/error.h"
#include "tools/common/cli.h"
#include "tools/common/exit_codes.h"
#include "tools/qslim/options.h"
#include "tools/qslim/simplify_cells.h"
#include "tools/qslim/simplify_parts.h"
#include "tools/qslim/tell.h"

namespace {

using namespace tet4d;
using qslim::Options;
using qslim::SimplifiedPart;

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

std::string provenanceOf(const cli::Session& session, const hypermesh::File& file) {
  char digest[17];
  std::snprintf(digest, sizeof digest, "%016llx", static_cast<unsigned long long>(unwrap(file.contentDigest())));
  const cli::Input input{"hypermesh", digest};
  return session.provenance({&input, 1});
}

void printPlan(const hypermesh::File& file, const Options& options, const std::vector<qslim4d::ColumnWish>& wishes,
               bool in_cells) {
  std::uint64_t vertex_bytes = 32;
  for (const qslim4d::ColumnWish& wish : wishes) vertex_bytes += 4 * file.columns()[wish.column].components;
  const std::uint64_t tries = options.max_error ? options.tries.value_or(qslim::kTries) : 1;
  const std::uint64_t passes = in_cells ? 3 * tries : tries;
  const std::uint64_t memory =
      in_cells ? qslim::boundCellMemory(file, options, wishes) : qslim::boundMemory(file, options, wishes);
  const std::uint64_t disk =
      in_cells ? qslim4d::boundTemporaryBytes(file, wishes, options.max_error.has_value()) : std::uint64_t{0};
  std::printf("passes %llu\npeak_memory_bytes %llu\ntemporary_bytes %llu\noutput_bytes_at_most %llu\n",
              static_cast<unsigned long long>(passes), static_cast<unsigned long long>(memory),
              static_cast<unsigned long long>(disk),
              static_cast<unsigned long long>(file.header().tets * 16 + file.header().vertices * vertex_bytes +
                                              (1 + wishes.size()) * (file.geometryPages() + 1) * 512 + 65536));
}

// Into `writer`; nothing if a promise could not be kept, of which the user has been told then.
std::optional<qslim::Sum> simplifyInCore(cli::Session& session, const hypermesh::File& file, const Options& options,
                                         const std::vector<qslim4d::ColumnWish>& wishes, hypermesh::Writer& writer) {
  const auto reserved =
      session.memory().reserve(qslim::boundMemory(file, options, wishes), "the mesh, which is simplified in core");
  std::vector<SimplifiedPart> parts =
      qslim::simplifyParts(session, file, options, qslim4d::planColumns(file, wishes, session.progress()));
  if (!parts.empty() && !parts.back().is_kept) {
    const SimplifiedPart& part = parts.back();
    qslim::tellFailure(session, options, part.tries, part.measured, part.estimate);
    return std::nullopt;
  }
  const qslim::Sum sum = qslim::sumOf(parts);
  std::vector<qslim4d::PackedMesh> meshes;
  for (SimplifiedPart& part : parts) meshes.push_back(std::move(part.mesh));
  qslim4d::writeMeshes(meshes, writer, session.progress());
  return sum;
}

int slim(cli::Session& session, const Options& options) {
  checkOptions(options);
  cli::expectSuffix(session, ".t4h", "name it X.t4h");
  const hypermesh::File file = unwrap(hypermesh::File::open(options.input));
  session.dependsOn(options.input);
  const std::vector<qslim4d::ColumnWish> wishes = columnWishes(options, file);
  const std::string why_in_core = qslim::whyInCore(options);
  const bool in_cells = qslim::isLarge(options, file) && why_in_core.empty();
  if (session.options().dry_run) {
    printPlan(file, options, wishes, in_cells);
    return 0;
  }
  if (qslim::isLarge(options, file) && !in_cells)
    session.note("more than --cell-tets, and yet in core: " + why_in_core);
  if (!in_cells && session.options().resume)
    session.note("--resume: what is simplified in core begins anew; only a run in cells can go on");
  if (!in_cells && !session.options().temp_dir.empty())
    session.note("--temp-dir: what is simplified in core has no temporary files");
  hypermesh::Writer writer = createWriter(session, file, options, wishes);
  const std::string provenance = provenanceOf(session, file);
  const std::optional<qslim::Sum> sum = in_cells
                                            ? qslim::simplifyCells(session, file, options, wishes, provenance, writer)
                                            : simplifyInCore(session, file, options, wishes, writer);
  if (!sum) return cli::kExitFailure;
  if (sum->stalled_tets > 0 && !options.error && !options.max_error) {
    session.warn("no collapse is left that keeps the mesh a manifold without flips: " +
                 std::to_string(sum->stalled_tets) + " tets remain");
  }
  unwrap(writer.close(provenance));
  qslim::tell(session, options, *sum);
  if (options.measure_times > 0 && sum->tets > 0) qslim::measure(session, file, options.measure_times);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  qslim::Options o;
  cli::Command command("hyper-qslim", "Simplifies a hypermesh by edge collapses under a quadric error in space-time.");
  command.example("hyper-qslim dam.t4h --ratio 0.1 -o dam-10.t4h", "a tenth of the tetrahedra")
      .example("hyper-qslim dam.t4h --error 0.02 -o dam-fine.t4h", "as few as an error of 0.02 world units allows")
      .example("hyper-qslim dam.t4h --max-error 0.5 -o dam-sure.t4h", "no slice farther off than half a world unit")
      .example("hyper-qslim huge.t4h --ratio 0.01 --memory 4G --temp-dir /scratch -o small.t4h",
               "a mesh larger than memory, cell by cell; --resume goes on after an interrupt")
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
      .option("--tries", "N", "how often --max-error may begin again from the input; default 8", &o.tries)
      .heading("Simplification")
      .option("--metric", "WHICH", "slice: spatial distance at fixed time; paper: raw 4D normals",
              cli::Choice{&o.metric, {"slice", "paper"}})
      .option("--order", "WHICH",
              "passes: parallel rounds; multichoice: best of random edges; heap: exact, the slowest, always in core",
              cli::Choice{&o.order, {"passes", "multichoice", "heap"}})
      .option("--choices", "N", "random edges that multichoice compares; default 8", &o.choices)
      .option("--align-time", "A",
              "a vertex goes to the time of an end or a frame if that costs up to 1 + A times the least; default 0.25",
              &o.align_time)
      .option("--max-star", "N", "most tetrahedra at a vertex that a collapse may leave", &o.most_star)
      .option("--cell-tets", "N",
              "a mesh of more tetrahedra is simplified in cells of at most so many, out of core; with --order heap in "
              "core for all that",
              &o.cell_tets)
      .option(
          "--non-manifold", "WHAT",
          "where more than two tetrahedra meet in a triangle: refuse the mesh, or keep such places, and vertices whose "
          "surroundings are no ball, as they are",
          cli::Choice{&o.non_manifold, {"refuse", "keep"}})
      .option("--columns", "LIST", "columns to carry over, beside those of --attributes: names, all or none",
              &o.columns)
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
      .common({cli::kOutputRequired, cli::kThreads, cli::kMemory, cli::kTempDir, cli::kForce, cli::kDryRun,
               cli::kResume, cli::kSeed, cli::kStats, cli::kDepfile});
  return cli::run(argc, argv, command, [&](cli::Session& session) { return slim(session, o); });
}

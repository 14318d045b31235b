// hyper-qslim: a hypermesh → a smaller one. Ponchio & Hormann 2008, sec. 5.
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/column_list.h"
#include "libpreprocess/error.h"
#include "tools/common/cli.h"
#include "tools/qslim/options.h"
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
  if (!parts.empty() && !parts.back().is_kept) return qslim::tellFailure(session, options, parts.back());
  const qslim::Sum sum = qslim::sumOf(parts);
  if (sum.stalled_tets > 0 && !options.error && !options.max_error) {
    session.warn("no collapse is left that keeps the mesh a manifold without flips: " +
                 std::to_string(sum.stalled_tets) + " tets remain");
  }
  write(session, file, std::move(parts), std::move(writer));
  qslim::tell(session, options, sum);
  if (options.measure_times > 0 && sum.tets > 0) qslim::measure(session, file, options.measure_times);
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
      .common({cli::kOutputRequired, cli::kThreads, cli::kMemory, cli::kForce, cli::kDryRun, cli::kSeed, cli::kStats,
               cli::kDepfile});
  return cli::run(argc, argv, command, [&](cli::Session& session) { return slim(session, o); });
}

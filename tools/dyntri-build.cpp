// dyntri-build: a hypermesh → playable dynamic triangles. Ponchio & Hormann 2008, sec. 7.1.
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "libpreprocess/column_list.h"
#include "libpreprocess/dyntri/dynamic_triangles_builder.h"
#include "libpreprocess/error.h"
#include "tools/common/cli.h"

namespace {

using namespace tet4d;

std::string hex(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

struct Options {
  std::string input, codec = "raw", columns = "all";
  std::uint64_t bands = dyntri::kDefaultBands;
};

// What --dry-run prints: the passes, the memory and the most bytes the output can have.
void printPlan(const hypermesh::File& mesh, const dyntri::BuildOptions& options, std::size_t threads) {
  const std::uint64_t triangles = dyntri::boundTriangles(mesh.header().tets);
  std::uint64_t vertex_bytes = sizeof(Vec4f);
  for (const std::size_t c : options.columns) vertex_bytes += mesh.columns()[c].components * sizeof(float);
  const std::uint64_t most = 3 * triangles * 8 + triangles * 20 + 4 * mesh.header().tets +
                             2 * mesh.header().vertices * vertex_bytes +
                             (1 + options.columns.size()) * mesh.geometryPages() * 2 * container::kPageAlignment + 8192;
  std::printf("passes 1\npeak_memory_bytes %llu\ntemporary_bytes 0\noutput_bytes_at_most %llu\n",
              static_cast<unsigned long long>(dyntri::boundBuildMemory(mesh, threads, options)),
              static_cast<unsigned long long>(most));
}

dyntri::Writer createWriter(const cli::Session& session, const hypermesh::File& mesh,
                            const dyntri::BuildOptions& options, const std::string& codec) {
  dyntri::Header header{};
  header.index_to_world = mesh.header().index_to_world;
  header.last_time = mesh.header().domain.max.t;
  std::vector<Column> columns;
  for (const std::size_t c : options.columns)
    columns.push_back({columnName(mesh.columns()[c]), mesh.columns()[c].components});
  std::vector<double> isovalues;
  for (const PartEntry& part : mesh.parts()) isovalues.push_back(part.isovalue);
  const paged::Codec page_codec = codec == "zstd" ? paged::Codec::kZstd : paged::Codec::kRaw;
  return unwrap(dyntri::Writer::create(session.options().output, header, mesh.times(), page_codec,
                                       session.options().force, columns, isovalues));
}

int build(cli::Session& session, const Options& chosen) {
  cli::expectSuffix(session, ".t4d", "name it X.t4d");
  if (chosen.bands < 1 || chosen.bands > dyntri::kMostBands) {
    throw Error(FaultCode::kUsage, "", "--bands", std::to_string(chosen.bands) + " is not 1 to 16", "leave it out");
  }
  const hypermesh::File mesh = unwrap(hypermesh::File::open(chosen.input));
  session.dependsOn(chosen.input);
  session.stats().count("tets", mesh.header().tets);
  session.stats().count("frames", mesh.header().frames);
  const dyntri::BuildOptions options{static_cast<std::uint32_t>(chosen.bands),
                                     namedColumns(mesh.columns(), chosen.columns, chosen.input)};
  if (session.options().dry_run) {
    printPlan(mesh, options, session.executor().threads());
    return 0;
  }
  dyntri::Writer writer = createWriter(session, mesh, options, chosen.codec);
  const dyntri::BuildStats stats =
      dyntri::buildDynamicTriangles(mesh, options, writer, session.executor(), session.memory(), session.progress());
  // Neither the file's name nor its codec changes what comes out.
  const cli::Input provenance{"hypermesh", hex(unwrap(mesh.contentDigest()))};
  unwrap(writer.close(session.provenance({&provenance, 1})));
  session.stats().count("vertices", stats.vertices);
  session.stats().count("edges", stats.edges);
  session.stats().count("triangles", stats.triangles);
  session.stats().count("empty_triangles", stats.empty);
  session.stats().count("pages", stats.pages);
  session.stats().count("band_bytes", stats.band_bytes);
  session.note(std::to_string(stats.tets) + " tets -> " + std::to_string(stats.triangles) + " dynamic triangles (" +
               std::to_string(stats.empty) + " with an empty lifespan left out), " + std::to_string(stats.edges) +
               " edges");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options chosen;
  cli::Command command("dyntri-build", "Turns a hypermesh into dynamic triangles, ready to play.");
  command.example("dyntri-build dam.t4h -o dam.t4d", "every tetrahedron's triangles with their lifespans")
      .example("dyntri-build dam.t4h -o dam.t4d --page-codec zstd", "smaller, decoded when a page comes in")
      .example("dyntri-build dam.t4h -o dam.t4d --columns pressure", "one of the hypermesh's columns, to colour by")
      .positional("FILE", "hypermesh (.t4h)", &chosen.input)
      .option("--columns", "LIST", "columns of the hypermesh to carry: names, all or none", &chosen.columns)
      .option("--bands", "N", "bands of lifespans about as long, at most, 1 to 16", &chosen.bands)
      .option("--page-codec", "CODEC", "how pages are stored", cli::Choice{&chosen.codec, {"raw", "zstd"}})
      .common(
          {cli::kOutputRequired, cli::kThreads, cli::kMemory, cli::kForce, cli::kDryRun, cli::kStats, cli::kDepfile});
  return cli::run(argc, argv, command, [&](cli::Session& session) { return build(session, chosen); });
}

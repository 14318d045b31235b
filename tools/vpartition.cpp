// vpartition: a hypermesh → a patch DAG, the mesh at every resolution. Ponchio & Hormann 2008, sec. 6.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string>

#include "libpreprocess/error.h"
#include "libpreprocess/vpartition/dag_builder.h"
#include "tools/common/cli.h"

namespace {

using namespace tet4d;

struct Options {
  std::string input, partition = "voronoi", codec = "raw";
  vpartition::Options build;
};

void printPlan(const hypermesh::File& mesh, const vpartition::Options& options, std::size_t threads) {
  // Levels sum to three times the finest at most, as far as cells can be halved; of a patch's vertices few are its own.
  const std::uint64_t tets = 3 * mesh.header().tets;
  const std::uint64_t patches = 4 * tets / options.patch_tets + 64;
  std::printf("passes 1\npeak_memory_bytes %llu\ntemporary_bytes 0\noutput_bytes_at_most %llu\n",
              static_cast<unsigned long long>(vpartition::boundMemory(mesh, options, threads)),
              static_cast<unsigned long long>(tets * (8 + 16) + patches * (container::kPageAlignment + 256) + 65536));
}

patch_dag::Writer createWriter(const cli::Session& session, const hypermesh::File& mesh, const vpartition::Dag& dag,
                               const Options& options) {
  patch_dag::Header header{};
  header.flags = mesh.header().flags;
  header.index_to_world = mesh.header().index_to_world;
  header.domain = mesh.header().domain;
  header.isovalue = mesh.header().isovalue;
  header.time_scale = options.build.time_scale;
  return unwrap(patch_dag::Writer::create(session.options().output, header, mesh.times(), dag.nodes, {},
                                          options.codec == "zstd" ? paged::Codec::kZstd : paged::Codec::kRaw,
                                          session.options().force));
}

double percent(std::uint64_t part, std::uint64_t whole) {
  return 100 * static_cast<double>(part) / static_cast<double>(std::max<std::uint64_t>(1, whole));
}

void tell(cli::Session& session, const hypermesh::File& mesh, const vpartition::Dag& dag) {
  std::uint64_t cells = 0, stuck = 0, locked = 0, vertices = 0, orphans = 0, tets = 0, most = 0;
  for (std::size_t i = 0; i < dag.levels.size(); ++i) {
    const vpartition::LevelReport& level = dag.levels[i];
    char line[200];
    std::snprintf(line, sizeof line,
                  "level %zu: %llu tets -> %llu in %llu cells (%llu stuck), %.1f %% of vertices locked, error %.3g",
                  i + 1, static_cast<unsigned long long>(level.tets_in),
                  static_cast<unsigned long long>(level.tets_out), static_cast<unsigned long long>(level.cells),
                  static_cast<unsigned long long>(level.stuck), percent(level.locked, level.vertices),
                  level.error_world);
    session.detail(line);
    cells += level.cells, stuck += level.stuck, locked += level.locked, vertices += level.vertices;
    orphans += level.orphans;
  }
  for (const vpartition::StoredPatch& patch : dag.patches) {
    tets += patch.tets.size();
    most = std::max<std::uint64_t>(most, patch.tets.size());
  }
  cli::Stats& stats = session.stats();
  stats.count("tets_in", mesh.header().tets);
  stats.count("tets", tets);
  stats.count("nodes", dag.nodes.size());
  stats.count("patches", dag.patches.size());
  stats.count("largest_patch", most);
  stats.count("levels", dag.levels.size());
  stats.count("cells", cells);
  stats.count("stuck_cells", stuck);
  stats.count("pruned_nodes", dag.pruned_nodes);
  stats.count("merged_pieces", orphans);
  stats.count("cell_vertices", vertices);
  stats.count("locked_vertices", locked);
  stats.count("root_tets", dag.root_tets);
  stats.count("root_patches", dag.root_patches);
  if (!dag.nodes.empty()) stats.error("estimated_world", dag.nodes.front().error_estimated);
  char line[240];
  std::snprintf(
      line, sizeof line,
      "%llu tets -> %zu levels, %zu nodes (%llu without error left out), %zu patches, %llu tets; root of %llu tets "
      "in %llu patches; %.1f %% of the cells' vertices locked",
      static_cast<unsigned long long>(mesh.header().tets), dag.levels.size(), dag.nodes.size(),
      static_cast<unsigned long long>(dag.pruned_nodes), dag.patches.size(), static_cast<unsigned long long>(tets),
      static_cast<unsigned long long>(dag.root_tets), static_cast<unsigned long long>(dag.root_patches),
      percent(locked, vertices));
  session.note(line);
  if (dag.root_patches > 1)
    session.warn("the coarsest cut has " + std::to_string(dag.root_patches) +
                 " patches, not one: nothing more could be taken away");
}

int build(cli::Session& session, Options& options) {
  cli::expectSuffix(session, ".t4p", "name it X.t4p");
  options.build.partition = options.partition == "kd" ? vpartition::Kind::kKd : vpartition::Kind::kVoronoi;
  options.build.seed = session.options().seed;
  vpartition::checkOptions(options.build);
  const hypermesh::File mesh = unwrap(hypermesh::File::open(options.input));
  session.dependsOn(options.input);
  if (session.options().dry_run) {
    printPlan(mesh, options.build, session.executor().threads());
    return 0;
  }
  const vpartition::Dag dag =
      vpartition::buildDag(mesh, options.build, session.executor(), session.memory(), session.progress());
  patch_dag::Writer writer = createWriter(session, mesh, dag, options);
  vpartition::writeDag(dag, writer, session.progress());
  char digest[17];
  std::snprintf(digest, sizeof digest, "%016llx", static_cast<unsigned long long>(unwrap(mesh.contentDigest())));
  const cli::Input provenance{"hypermesh", digest};
  unwrap(writer.close(session.provenance({&provenance, 1})));
  tell(session, mesh, dag);
  if (!mesh.columns().empty()) session.note("the hypermesh's columns are not carried over");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options o;
  cli::Command command("vpartition",
                       "Builds a hypermesh at every resolution: patches whose every choice fits without cracks.");
  command.example("vpartition dam.t4h -o dam.t4p", "levels from the whole mesh down to one patch")
      .example("vpartition dam.t4h -o dam.t4p --time-scale 0.5",
               "a frame counts as half a cell where distances are measured")
      .example("vpartition dam.t4h -o dam.t4p --partition kd -v", "cells by planes, and what each level came to")
      .positional("FILE", "hypermesh (.t4h)", &o.input)
      .option("--partition", "WHICH",
              "cells: voronoi, relaxed, with a norm of its own each; kd, by planes across the longest extent",
              cli::Choice{&o.partition, {"voronoi", "kd"}})
      .option("--cell-tets", "N", "tetrahedra of a cell that is simplified, on average", &o.build.cell_tets)
      .option("--patch-tets", "N", "tetrahedra of a patch, at most; up to 16383", &o.build.patch_tets)
      .option("--time-scale", "S", "cells that a frame counts as, for cells and for players; stored",
              &o.build.time_scale)
      .option("--page-codec", "CODEC", "how pages are stored", cli::Choice{&o.codec, {"raw", "zstd"}})
      .common({cli::kOutputRequired, cli::kThreads, cli::kMemory, cli::kForce, cli::kDryRun, cli::kSeed, cli::kStats,
               cli::kDepfile});
  return cli::run(argc, argv, command, [&](cli::Session& session) { return build(session, o); });
}

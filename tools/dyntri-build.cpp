// dyntri-build: a hypermesh → playable dynamic triangles. Ponchio & Hormann 2008, sec. 7.1.
#include <cstdint>
#include <cstdio>
#include <string>

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

// What --dry-run prints: the passes, the memory and the most bytes the output can have.
void printPlan(const hypermesh::File& mesh, std::size_t threads) {
  const std::uint64_t triangles = dyntri::boundTriangles(mesh.header().tets);
  const std::uint64_t most = 3 * triangles * 8 + triangles * 20 + 2 * mesh.header().vertices * sizeof(Vec4f) +
                             mesh.geometryPages() * container::kPageAlignment + 8192;
  std::printf("passes 1\npeak_memory_bytes %llu\ntemporary_bytes 0\noutput_bytes_at_most %llu\n",
              static_cast<unsigned long long>(dyntri::boundBuildMemory(mesh, threads)),
              static_cast<unsigned long long>(most));
}

int build(cli::Session& session, const std::string& input, const std::string& codec) {
  cli::expectSuffix(session, ".t4d", "name it X.t4d");
  const hypermesh::File mesh = unwrap(hypermesh::File::open(input));
  session.dependsOn(input);
  session.stats().count("tets", mesh.header().tets);
  session.stats().count("frames", mesh.header().frames);
  if (session.options().dry_run) {
    printPlan(mesh, session.executor().threads());
    return 0;
  }
  dyntri::Header header{};
  header.index_to_world = mesh.header().index_to_world;
  header.last_time = mesh.header().domain.max.t;
  const paged::Codec page_codec = codec == "zstd" ? paged::Codec::kZstd : paged::Codec::kRaw;
  dyntri::Writer writer = unwrap(
      dyntri::Writer::create(session.options().output, header, mesh.times(), page_codec, session.options().force));
  const dyntri::BuildStats stats =
      dyntri::buildDynamicTriangles(mesh, writer, session.executor(), session.memory(), session.progress());
  // Neither the file's name nor its codec changes what comes out.
  const cli::Input provenance{"hypermesh", hex(unwrap(mesh.contentDigest()))};
  unwrap(writer.close(session.provenance({&provenance, 1})));
  session.stats().count("vertices", stats.vertices);
  session.stats().count("edges", stats.edges);
  session.stats().count("triangles", stats.triangles);
  session.stats().count("empty_triangles", stats.empty);
  session.stats().count("pages", stats.pages);
  session.note(std::to_string(stats.tets) + " tets -> " + std::to_string(stats.triangles) + " dynamic triangles (" +
               std::to_string(stats.empty) + " with an empty lifespan left out), " + std::to_string(stats.edges) +
               " edges");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::string input, codec = "raw";
  cli::Command command("dyntri-build", "Turns a hypermesh into dynamic triangles, ready to play.");
  command.example("dyntri-build dam.t4h -o dam.t4d", "every tetrahedron's triangles with their lifespans")
      .example("dyntri-build dam.t4h -o dam.t4d --page-codec zstd", "smaller, decoded when a page comes in")
      .positional("FILE", "hypermesh (.t4h)", &input)
      .option("--page-codec", "CODEC", "how pages are stored", cli::Choice{&codec, {"raw", "zstd"}})
      .common(
          {cli::kOutputRequired, cli::kThreads, cli::kMemory, cli::kForce, cli::kDryRun, cli::kStats, cli::kDepfile});
  return cli::run(argc, argv, command, [&](cli::Session& session) { return build(session, input, codec); });
}

#include "tools/mc/mesh_sequence.h"

#include <charconv>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/surface_source.h"
#include "libpreprocess/prisms/prisms.h"

namespace tet4d::mc {
namespace {

std::string shortText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

prisms::Options optionsOf(const MeshOptions& given, bool compressed) {
  prisms::Options options;
  options.page_codec = compressed ? paged::Codec::kZstd : paged::Codec::kRaw;
  if (given.window) options.linear_window = *given.window;
  if (given.tolerance.empty()) return options;
  std::string_view text = given.tolerance;
  if (text.ends_with('%')) {
    options.relative = true;
    text.remove_suffix(1);
  }
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), options.linear_tolerance);
  if (error != std::errc{} || end != text.data() + text.size()) {
    throw Error(FaultCode::kUsage, "", "option --linear-tolerance", "\"" + given.tolerance + "\" is no length",
                "give a length, such as 0.01, or a part of the mesh's diagonal, such as 0.1%");
  }
  if (options.relative) options.linear_tolerance /= 100;
  return options;
}

void printPlan(const exchange::SurfaceSource& source, const prisms::Options& options) {
  const prisms::Plan plan = prisms::plan(source, options);
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

// What the surface has that a hypermesh should not.
void warnOfSurface(const exchange::SurfaceInfo& info, const prisms::Stats& stats, cli::Session& session) {
  if (info.polygons_cut != 0)
    session.note(std::to_string(info.polygons_cut) + " polygons are cut into triangles from their first corner");
  if (info.collapsed != 0)
    session.note(std::to_string(info.collapsed) + " facets have no surface in any frame: left out");
  if (stats.unused_vertices != 0)
    session.note(std::to_string(stats.unused_vertices) + " vertices are in no triangle: left out");
  if (stats.edges_over_two != 0) {
    session.warn(std::to_string(stats.edges_over_two) +
                 " edges are in three triangles or more: no manifold there, and none in the hypermesh");
  }
  if (stats.misoriented_edges != 0) {
    session.warn(
        std::to_string(stats.misoriented_edges) +
        " edges have triangles on both sides that are wound against each other: inside and outside swap there");
  }
}

// `tolerant`: a tolerance was given, so what it saved is told even where that is nothing.
void report(const exchange::SurfaceInfo& info, const prisms::Stats& stats, bool tolerant, cli::Session& session) {
  session.stats().count("vertices", stats.vertices);
  session.stats().count("tets", stats.tets);
  session.stats().count("tets_expanded", stats.tets_expanded);
  session.stats().count("frames", stats.frames);
  session.stats().count("triangles", stats.triangles);
  session.stats().count("unused_vertices", stats.unused_vertices);
  session.stats().count("open_edges", stats.open_edges);
  session.stats().count("edges_over_two", stats.edges_over_two);
  session.stats().count("misoriented_edges", stats.misoriented_edges);
  session.stats().error("linear_tolerance", stats.tolerance);
  session.stats().error("linear_measured", stats.error_measured);
  warnOfSurface(info, stats, session);
  std::string line = std::to_string(stats.frames) + " frames of " + std::to_string(stats.triangles) + " triangles -> " +
                     std::to_string(stats.tets) + " tetrahedra, " + std::to_string(stats.vertices) + " vertices";
  if (tolerant || stats.tets < stats.tets_expanded) {
    line += "; " + std::to_string(stats.tets_expanded) + " if every frame were kept; tolerance " +
            shortText(stats.tolerance) + ", error at frames " + shortText(stats.error_measured) + " (measured)";
  }
  session.note(line);
}

void nameDependencies(const std::vector<std::string>& inputs, const exchange::SurfaceSource& source,
                      cli::Session& session) {
  std::error_code ignored;
  for (const std::string& input : inputs)
    if (std::filesystem::is_regular_file(input, ignored)) session.dependsOn(input);
  // A directory or a pattern stands for the files its frames are called after.
  if (inputs.size() != 1 || std::filesystem::is_regular_file(inputs[0], ignored)) return;
  for (std::size_t k = 0; k < source.info().times.size(); ++k)
    if (std::filesystem::is_regular_file(source.frameName(k), ignored)) session.dependsOn(source.frameName(k));
}

}  // namespace

void MeshOptions::declare(cli::Command& command) {
  command.heading("Mesh sequences")
      .option(
          "--linear-tolerance", "E",
          "how far slices at frames may be from the meshes: a length, or as 0.1% a part of the first mesh's diagonal; "
          "where motion is that straight frames are left out (0: straight as far as float32 tells)",
          &tolerance)
      .option("--linear-window", "N", "most steps looked at, and held, as one (16); 1 keeps every frame", &window);
}

int buildMeshSequence(cli::Session& session, const std::vector<std::string>& inputs, const std::vector<double>& times,
                      bool allow_gaps, bool compressed, const MeshOptions& given) {
  const prisms::Options options = optionsOf(given, compressed);
  const std::unique_ptr<exchange::SurfaceSource> source = exchange::openSurfaces(inputs, {allow_gaps, times});
  nameDependencies(inputs, *source, session);
  if (session.options().dry_run) {
    printPlan(*source, options);
    return 0;
  }
  prisms::checkSource(*source, options);
  hypermesh::Writer writer =
      unwrap(hypermesh::Writer::create(session.options().output, prisms::meshHeader(*source), source->info().times, {},
                                       options.page_codec, session.options().force));
  const prisms::Stats stats =
      prisms::buildPrisms(*source, writer, options, session.executor(), session.memory(), session.progress());
  char digest[17];
  std::snprintf(digest, sizeof digest, "%016llx", static_cast<unsigned long long>(stats.input_xxh3));
  const cli::Input input{"surfaces", digest};  // whatever the files are called
  unwrap(writer.close(session.provenance({&input, 1})));
  report(source->info(), stats, !given.tolerance.empty(), session);
  return 0;
}

}  // namespace tet4d::mc

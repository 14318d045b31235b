#include "tools/mc/extract_volume.h"

#include <charconv>
#include <cstdint>
#include <cstdio>
#include <memory>

#include "libpreprocess/error.h"
#include "libpreprocess/hypermesh/marching_hypercubes.h"

namespace tet4d::mc {
namespace {

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

std::string numbers(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + number(value);
  return text;
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

void report(const ExtractOptions& given, const hypermesh::Stats& stats, cli::Session& session) {
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
    session.warn("the hypermesh is empty: isovalue " + numbers(given.isovalues) + ", samples from " +
                 number(stats.min_value) + " to " + number(stats.max_value));
  }
  if (stats.nan_samples != 0) {
    session.warn(std::to_string(stats.nan_samples) + " samples are NaN: " +
                 (given.nan == "mask" ? std::to_string(stats.masked_cells) + " hypercubes that touch one left out"
                                      : "taken as outside (--nan mask leaves their hypercubes out)"));
  }
  session.note(std::to_string(stats.frames) + " frames -> " + std::to_string(stats.tets) + " tetrahedra, " +
               std::to_string(stats.vertices) + " vertices, " + std::to_string(stats.active_cells) +
               " hypercubes crossed");
  if (stats.parts.size() == 1) return;
  session.stats().count("parts", stats.parts.size());
  for (std::size_t p = 0; p < stats.parts.size(); ++p) {
    session.note("part " + std::to_string(p) + ", isovalue " + number(stats.parts[p].isovalue) + ": " +
                 std::to_string(stats.parts[p].tets) + " tetrahedra");
  }
}

}  // namespace

int extractVolume(cli::Session& session, const std::vector<std::string>& inputs,
                  const frames::FrameOptions& frame_options, const ExtractOptions& given) {
  const std::unique_ptr<exchange::FrameSource> source = frames::openFrames(inputs, frame_options, session);
  const Extraction extraction = extractionOf(given, frame_options, session);
  const hypermesh::Options& options = extraction.options;
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
  std::vector<cli::Input> digests{{"frames", hex(stats.samples_xxh3)}};
  for (std::size_t f = 0; f < options.fields.size(); ++f)
    digests.push_back({options.fields[f].name, hex(stats.fields_xxh3[f])});
  unwrap(writer.close(session.provenance(digests)));
  report(given, stats, session);
  return 0;
}

}  // namespace tet4d::mc

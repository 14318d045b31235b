#include "tools/convert/slices.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "formats/core/time_spec.h"
#include "libpreprocess/exchange/printf_pattern.h"
#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/exchange/write_mesh.h"

namespace tet4d::convert {
namespace {

// Writes slices one after the other and counts what is in them.
class SliceWriter {
 public:
  SliceWriter(cli::Session& session, const hypermesh::File& mesh, bool normals)
      : session_(session),
        mesh_(mesh),
        normals_(normals),
        as_double_(exchange::needsDouble(mesh.header().index_to_world, mesh.header().domain)) {}

  void write(const std::string& path, const SliceTime& at) {
    const SliceMesh slice = exchange::sliceHypermesh(mesh_, at.frame);
    const auto world = exchange::worldMesh(slice, mesh_.header().index_to_world, normals_);
    vertices_ += world.points.size();
    triangles_ += world.triangles.size();
    const bool force = session_.options().force;
    if (suffixOf(path) == ".ply") {
      exchange::writePly(path, world, as_double_, force);
    } else {
      exchange::writeVtp(path, world, at.time, as_double_, force);
    }
  }
  std::uint64_t vertices() const { return vertices_; }
  std::uint64_t triangles() const { return triangles_; }

 private:
  cli::Session& session_;
  const hypermesh::File& mesh_;
  bool normals_, as_double_;
  std::uint64_t vertices_ = 0, triangles_ = 0;
};

// The name of slice k: from a pattern, or beside a .pvd.
std::string sliceName(const std::string& output, std::size_t k) {
  const auto number = static_cast<std::int64_t>(k);
  if (suffixOf(output) != ".pvd") return exchange::NumberPattern::parse(output)->name(number);
  const exchange::NumberPattern beside{std::filesystem::path(output).replace_extension().string() + "_", ".vtp", 4,
                                       true};
  return beside.name(number);
}

void checkSliceOutput(const Options& options, const std::string& output) {
  const std::string suffix = suffixOf(output);
  if (!options.at.empty() && !options.times.empty())
    failUsage("--at and --times are both given", "leave one of them out");
  if (!options.at.empty() && suffix != ".ply" && suffix != ".vtp") {
    failUsage("a slice (--at) cannot be written as \"" + output + "\"");
  }
  if (options.times.empty() || suffix == ".pvd") return;
  const bool suffix_fits = suffix == ".ply" || suffix == ".vtp";
  if (!suffix_fits || !exchange::NumberPattern::parse(output)) {
    failUsage("slices (--times) cannot be written as \"" + output + "\"");
  }
}

}  // namespace

void writeSlices(cli::Session& session, const hypermesh::File& mesh, const Options& options) {
  const std::string& output = session.options().output;
  checkSliceOutput(options, output);
  SliceWriter writer(session, mesh, options.normals);
  std::vector<SliceTime> at;
  if (!options.at.empty()) {
    at.push_back(unwrap(parseTime(options.at, mesh.times())));
  } else {
    at = unwrap(parseTimes(options.times, mesh.times()));
    const auto directory = std::filesystem::path(output).parent_path();
    std::error_code ignored;  // opening the first slice tells
    if (!directory.empty()) std::filesystem::create_directories(directory, ignored);
  }
  std::vector<std::pair<double, std::string>> steps;
  session.progress().phase("slice", at.size());
  for (std::size_t k = 0; k < at.size(); ++k) {
    const std::string path = options.at.empty() ? sliceName(output, k) : output;
    writer.write(path, at[k]);
    steps.emplace_back(at[k].time, std::filesystem::path(path).filename().string());
    session.progress().step(k + 1);
  }
  if (suffixOf(output) == ".pvd") exchange::writePvd(output, steps, session.options().force);
  session.stats().count("vertices", writer.vertices());
  session.stats().count("triangles", writer.triangles());
  session.stats().count("slices", at.size());
  session.note(std::to_string(at.size()) + (at.size() == 1 ? " slice, " : " slices, ") +
               std::to_string(writer.vertices()) + " vertices, " + std::to_string(writer.triangles()) + " triangles");
}

}  // namespace tet4d::convert

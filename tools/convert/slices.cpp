#include "tools/convert/slices.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "formats/core/time_spec.h"
#include "libpreprocess/column_list.h"
#include "libpreprocess/exchange/printf_pattern.h"
#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/exchange/write_mesh.h"

namespace tet4d::convert {
namespace {

// What a slice carries, as the options and the mesh's columns say.
struct Contents {
  exchange::SliceWants wants;
  bool slice_normals = false;         // area-weighted, of the slice
  std::optional<std::size_t> normal;  // among wants.columns: the one that becomes the file's normals
};

// The column of three components with a meaning of its own, if the mesh has it.
std::optional<std::size_t> findVectors(const hypermesh::File& mesh, const char* name) {
  const auto found = findColumn(mesh.columns(), name);
  return found && mesh.columns()[*found].components == 3 ? found : std::nullopt;
}

// The rank of column c among those wanted; wants it if it is not.
std::size_t rankOf(std::vector<std::size_t>& columns, std::size_t c) {
  const auto found = std::find(columns.begin(), columns.end(), c);
  if (found != columns.end()) return static_cast<std::size_t>(found - columns.begin());
  columns.push_back(c);
  return columns.size() - 1;
}

const char* remedyOf(const std::string& name) {
  return name == exchange::kVelocity ? "--velocity computes it" : nullptr;
}

Contents contentsOf(const hypermesh::File& mesh, const Options& options) {
  Contents contents;
  contents.wants.columns = namedColumns(mesh.columns(), options.columns, mesh.reader().path(), remedyOf);
  if (options.velocity) {
    if (const auto column = findVectors(mesh, exchange::kVelocity)) {
      rankOf(contents.wants.columns, *column);
    } else {
      contents.wants.velocity = true;
    }
  }
  if (options.part) {
    const std::uint64_t parts = std::max<std::uint64_t>(1, mesh.parts().size());
    if (*options.part >= parts) {
      throw Error(FaultCode::kUsage, mesh.reader().path(), "--part",
                  "there is no part " + std::to_string(*options.part) + "; it has " +
                      (parts == 1 ? "one, 0" : "parts 0 to " + std::to_string(parts - 1)),
                  "tet4d-info lists them with their isovalues");
    }
    if (parts > 1) contents.wants.part = options.part;
  }
  const auto normal = findVectors(mesh, exchange::kNormal);
  if (options.normals_from == "column") {
    if (!normal) {
      throw Error(FaultCode::kUsage, mesh.reader().path(), "--normals-from",
                  "there is no column \"normal\" of three components; " + columnsThere(mesh.columns()),
                  "make the hypermesh with --normals, or leave this out: --normals takes those of the slice");
    }
    contents.normal = rankOf(contents.wants.columns, *normal);
  } else if (options.normals) {
    contents.slice_normals = true;
  } else if (normal && std::count(contents.wants.columns.begin(), contents.wants.columns.end(), *normal) != 0) {
    contents.normal = rankOf(contents.wants.columns, *normal);  // named as a column: it is what the file's normals are
  }
  return contents;
}

// Refuses, before anything is written, what the output's format does not hold.
void checkFormat(const std::string& name, const Contents& contents) {
  const exchange::MeshFormat& format = *exchange::meshFormatOf(name);
  const std::string suffix(format.suffix);
  if (!format.normals && (contents.slice_normals || contents.normal)) {
    failUsage(suffix + " holds no normals at vertices", "leave the normals out, or write .ply, .vtp, .off, .obj, .glb");
  }
  const bool any = contents.wants.velocity || contents.wants.columns.size() > (contents.normal ? 1 : 0);
  if (!format.columns && any) failUsage(suffix + " holds no columns", "leave them out, or write .ply, .vtp, .glb");
}

// Writes slices one after the other and counts what is in them.
class SliceWriter {
 public:
  SliceWriter(cli::Session& session, const hypermesh::File& mesh, const Options& options, Contents contents)
      : session_(session), mesh_(mesh), contents_(std::move(contents)) {
    file_.as_double = exchange::needsDouble(mesh.header().index_to_world, mesh.header().domain);
    file_.origin = mesh.header().index_to_world.origin;
    file_.force = session.options().force;
    if (options.draco_bits) file_.draco_bits = static_cast<unsigned>(*options.draco_bits);
  }

  void write(const std::string& path, const SliceTime& at) {
    exchange::Slice slice = exchange::sliceHypermesh(mesh_, at.frame, contents_.wants);
    auto world = exchange::worldMesh(slice.mesh, mesh_.header().index_to_world, contents_.slice_normals);
    world.columns = std::move(slice.columns);
    if (contents_.normal) exchange::takeNormals(world, *contents_.normal);
    vertices_ += world.points.size();
    triangles_ += world.triangles.size();
    file_.time = at.time;
    const exchange::WriteLoss loss = exchange::writeSlice(path, world, file_);
    if (loss.position_world > loss_.position_world) loss_.position_world = loss.position_world, worst_ = path;
    loss_.normal_degrees = std::max(loss_.normal_degrees, loss.normal_degrees);
    loss_.columns.resize(loss.columns.size());
    for (std::size_t c = 0; c < loss.columns.size(); ++c) {
      loss_.columns[c] = {loss.columns[c].first, std::max(loss_.columns[c].second, loss.columns[c].second)};
    }
  }

  // Tells once, after the last slice, what was lost.
  void report(std::size_t slices) {
    session_.stats().count("vertices", vertices_);
    session_.stats().count("triangles", triangles_);
    session_.stats().count("slices", slices);
    session_.stats().error("position_world", loss_.position_world);
    if (loss_.normal_degrees > 0) session_.stats().error("normal_degrees", loss_.normal_degrees);
    for (const auto& [name, loss] : loss_.columns) session_.stats().error("column_" + name, loss);
    session_.note(std::to_string(slices) + (slices == 1 ? " slice, " : " slices, ") + std::to_string(vertices_) +
                  " vertices, " + std::to_string(triangles_) + " triangles");
    if (worst_.empty()) return;
    const exchange::MeshFormat& format = *exchange::meshFormatOf(worst_);
    if (format.suffix == ".drc") {
      std::string text = "quantized: positions within " + shortText(loss_.position_world) + " world units";
      if (loss_.normal_degrees > 0) text += ", normals within " + shortText(loss_.normal_degrees) + " degrees";
      for (const auto& [name, loss] : loss_.columns) text += ", " + name + " within " + shortText(loss);
      session_.note(text);
    } else if (file_.as_double && !format.doubles && format.suffix != ".glb") {
      session_.warn(worst_ + ": its format has float32 only, and the origin is far away: positions are off by up to " +
                    shortText(loss_.position_world) + " world units; .ply, .vtp, .off, .obj and .glb keep them");
    }
  }

 private:
  static std::string shortText(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
  }

  cli::Session& session_;
  const hypermesh::File& mesh_;
  Contents contents_;
  exchange::MeshFileOptions file_;
  std::uint64_t vertices_ = 0, triangles_ = 0;
  exchange::WriteLoss loss_;  // the largest of each
  std::string worst_;         // the file with the largest loss of position
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
  if (!options.at.empty() && !options.times.empty())
    failUsage("--at and --times are both given", "leave one of them out");
  const bool suffix_fits = exchange::meshFormatOf(output) != nullptr;
  if (!options.at.empty() && !suffix_fits) failUsage("a slice (--at) cannot be written as \"" + output + "\"");
  if (options.times.empty() || suffixOf(output) == ".pvd") return;
  if (!suffix_fits || !exchange::NumberPattern::parse(output)) {
    failUsage("slices (--times) cannot be written as \"" + output + "\"");
  }
}

}  // namespace

void writeSlices(cli::Session& session, const hypermesh::File& mesh, const Options& options) {
  const std::string& output = session.options().output;
  checkSliceOutput(options, output);
  if (options.draco_bits && suffixOf(output) != ".drc")
    failUsage("--draco-bits is for slices written as .drc", "leave it out, or write X.drc");
  if (options.draco_bits && (*options.draco_bits < 1 || *options.draco_bits > 30)) {
    failUsage("--draco-bits: " + std::to_string(*options.draco_bits) + " is not from 1 to 30", "14 is usual");
  }
  Contents contents = contentsOf(mesh, options);
  checkFormat(suffixOf(output) == ".pvd" ? "x.vtp" : output, contents);
  SliceWriter writer(session, mesh, options, std::move(contents));
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
  writer.report(at.size());
}

}  // namespace tet4d::convert

// tet4d-convert: slices of a hypermesh, whole hypermeshes and sequences of frames into other formats.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "formats/core/time_spec.h"
#include "libpreprocess/error.h"
#include "libpreprocess/exchange/printf_pattern.h"
#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/exchange/write_frames.h"
#include "libpreprocess/exchange/write_mesh.h"
#include "libpreprocess/outofcore/output_file.h"
#include "tools/common/cli.h"

namespace {

using namespace tet4d;

struct Options {
  std::vector<std::string> inputs;
  std::string at, times, codec = "raw";
  bool normals = false, allow_gaps = false;
  std::vector<double> frame_times;
};

constexpr const char* kPossible =
    "possible are: .t4h to .vtu, .hyper; .t4h with --at to .ply, .vtp; .t4h with --times to a pattern such as %04d.ply "
    "or "
    "to .pvd; frames (.nrrd, .nhdr, .t4g, a directory, a pattern) to .t4g, .nrrd";

[[noreturn]] void failUsage(const std::string& what, const std::string& remedy = kPossible) {
  throw Error(FaultCode::kUsage, "", "", what, remedy);
}

std::string suffixOf(const std::string& path) { return std::filesystem::path(path).extension().string(); }

std::string hex(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

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

void writeWhole(cli::Session& session, const hypermesh::File& mesh) {
  const std::string& output = session.options().output;
  const std::string suffix = suffixOf(output);
  const bool force = session.options().force;
  session.progress().phase("write", 1);
  if (suffix == ".vtu") {
    exchange::writeVtu(output, mesh, force);
  } else if (suffix == ".hyper") {
    exchange::writeHyper(output, mesh, force);
  } else {
    failUsage("a whole hypermesh (no --at, no --times) cannot be written as \"" + output + "\"");
  }
  session.progress().step(1);
  session.stats().count("vertices", mesh.header().vertices);
  session.note(std::to_string(mesh.header().vertices) + " vertices, " + std::to_string(mesh.header().tets) + " tets");
}

void convertHypermesh(cli::Session& session, const Options& options) {
  if (options.inputs.size() > 1)
    failUsage("several inputs, but a hypermesh is converted alone", "give one .t4h at a time");
  const hypermesh::File mesh = unwrap(hypermesh::File::open(options.inputs.front()));
  if (options.at.empty() && options.times.empty()) {
    if (options.normals) failUsage("--normals is for slices", "give --at or --times");
    writeWhole(session, mesh);
  } else {
    writeSlices(session, mesh, options);
  }
  session.stats().count("tets", mesh.header().tets);
  session.stats().count("frames", mesh.header().frames);
}

void convertFrames(cli::Session& session, const Options& options) {
  const std::string& output = session.options().output;
  const std::string suffix = suffixOf(output);
  if (suffix != ".t4g" && suffix != ".nrrd") failUsage("frames cannot be written as \"" + output + "\"");
  if (!options.at.empty() || !options.times.empty() || options.normals) {
    failUsage("--at, --times and --normals are for slices of a hypermesh",
              "make one first: tet4d-mc FRAMES --iso V -o X.t4h");
  }
  const auto frames = exchange::openFrames(options.inputs, {options.allow_gaps, options.frame_times});
  if (suffix == ".t4g") {
    const paged::Codec codec = options.codec == "zstd" ? paged::Codec::kZstd : paged::Codec::kRaw;
    const auto provenance = [&](std::uint64_t digest) {
      const cli::Input input{"frames", hex(digest)};  // whatever the files are called
      return session.provenance({&input, 1});
    };
    exchange::writeGrid4(output, *frames, codec, session.options().force, provenance, session.progress());
  } else {
    exchange::writeNrrd(output, *frames, session.options().force, session.progress());
  }
  session.stats().count("frames", frames->times().size());
  session.stats().count("voxels", frames->grid().voxels());
  session.note(std::to_string(frames->times().size()) + " frames of " + std::to_string(frames->grid().voxels()) +
               " voxels");
}

int convert(cli::Session& session, const Options& options) {
  for (const std::string& input : options.inputs) session.dependsOn(input);
  const bool is_hypermesh = suffixOf(options.inputs.front()) == ".t4h";
  const std::string suffix = suffixOf(options.inputs.front());
  if (!is_hypermesh && suffix != ".t4g" && suffix.starts_with(".t4")) {
    failUsage("\"" + options.inputs.front() + "\" is not converted");
  }
  if (is_hypermesh) {
    convertHypermesh(session, options);
  } else {
    convertFrames(session, options);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  cli::Command command("tet4d-convert", "Converts hypermeshes, slices of them, and sequences of frames.");
  command.example("tet4d-convert dam.t4h --at 0.35 -o dam.ply", "the surface at world time 0.35")
      .example("tet4d-convert dam.t4h --times 0f:75f:0.5f -o dam.pvd", "two slices a frame, for ParaView")
      .example("tet4d-convert dam.t4h --times 0:1:0.01 -o 'slices/%04d.ply'", "a hundred and one numbered files")
      .example("tet4d-convert dam.t4h -o dam.vtu", "the whole hypermesh, tetrahedra with a point array t")
      .example("tet4d-convert alpha_*.nrrd -o alpha.t4g", "frames into one file")
      .positional("FILE", "a hypermesh (.t4h), or frames in time order", &options.inputs)
      .heading("Slices")
      .option("--at", "T", "slice at a world time, or at a frame with the suffix f", &options.at)
      .option("--times", "A:B:STEP", "slices from A to B, both included; f as in --at", &options.times)
      .flag("--normals", "write vertex normals, area-weighted", &options.normals)
      .heading("Frames")
      .flag("--allow-gaps", "accept holes in the files' numbering", &options.allow_gaps)
      .option("--frame-times", "T,T,...", "world times of the frames, instead of the files'", &options.frame_times)
      .option("--page-codec", "CODEC", "how a .t4g's frames are stored", cli::Choice{&options.codec, {"raw", "zstd"}})
      .heading("Options")
      .common({cli::kOutputRequired, cli::kForce, cli::kStats, cli::kDepfile});
  return cli::run(argc, argv, command, [&](cli::Session& session) { return convert(session, options); });
}

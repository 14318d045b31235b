// tet4d-convert: slices of a hypermesh, whole hypermeshes and sequences of frames into other formats.
#include <string>

#include "libpreprocess/exchange/read_tet_mesh.h"
#include "libpreprocess/exchange/slice_columns.h"
#include "libpreprocess/exchange/surface_source.h"
#include "libpreprocess/exchange/write_mesh.h"
#include "tools/common/cli.h"
#include "tools/convert/frames.h"
#include "tools/convert/options.h"
#include "tools/convert/scalar_as_time.h"
#include "tools/convert/slices.h"
#include "tools/convert/surfaces.h"

namespace {

using namespace tet4d;
using namespace tet4d::convert;

// What the formats of whole hypermeshes do not hold.
void noteLeftOut(cli::Session& session, const hypermesh::File& mesh) {
  std::string names;
  for (const auto& column : mesh.columns()) names += (names.empty() ? "columns " : ", ") + exchange::columnName(column);
  if (mesh.parts().size() > 1) names += names.empty() ? "parts" : " and parts";
  if (names.empty()) return;
  session.note(names + " are not written to " + suffixOf(session.options().output) +
               ": they are in slices (--at, --times)");
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
  noteLeftOut(session, mesh);
}

void convertHypermesh(cli::Session& session, const Options& options) {
  if (options.inputs.size() > 1)
    failUsage("several inputs, but a hypermesh is converted alone", "give one .t4h at a time");
  const hypermesh::File mesh = unwrap(hypermesh::File::open(options.inputs.front()));
  if (!options.wantsSlices()) {
    if (!options.sliceOption().empty()) failUsage(options.sliceOption() + " is for slices", "give --at or --times");
    writeWhole(session, mesh);
  } else {
    writeSlices(session, mesh, options);
  }
  session.stats().count("tets", mesh.header().tets);
  session.stats().count("frames", mesh.header().frames);
}

int body(cli::Session& session, const Options& options) {
  for (const std::string& input : options.inputs) session.dependsOn(input);
  const bool is_hypermesh = suffixOf(options.inputs.front()) == ".t4h";
  const std::string suffix = suffixOf(options.inputs.front());
  if (!is_hypermesh && suffix != ".t4g" && suffix != ".t4q" && suffix.starts_with(".t4")) {
    failUsage("\"" + options.inputs.front() + "\" is not converted");
  }
  const bool is_mesh = exchange::isTetMeshName(options.inputs.front());
  if (is_mesh && options.scalar_as_time.empty()) {
    failUsage("\"" + options.inputs.front() + "\" is a mesh of tetrahedra",
              "say which scalar is time: --scalar-as-time NAME");
  }
  if (!options.scalar_as_time.empty()) {
    convertScalarAsTime(session, options);
  } else if (is_hypermesh) {
    convertHypermesh(session, options);
  } else if (exchange::areSurfaces(options.inputs)) {
    convertSurfaces(session, options);
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
      .example("tet4d-convert dam.t4h --at 20f --normals --velocity -o dam.glb", "with normals and how fast it moves")
      .example("tet4d-convert dam.t4h -o dam.vtu", "the whole hypermesh, tetrahedra with a point array t")
      .example("tet4d-convert blast.vtu --scalar-as-time p -o p.t4h", "every isosurface of p, swept as if it were time")
      .example("tet4d-convert alpha_*.nrrd -o alpha.t4g", "frames into one file")
      .example("tet4d-convert scan.mha --crop 0:255,0:255,20:80 --time-stride 2 -o part.nrrd", "a part of a sequence")
      .example("tet4d-convert cloth-*.obj -o cloth.t4q", "a mesh whose vertices move into one file")
      .positional("FILE", "a hypermesh (.t4h), or frames of a volume or meshes in time order, as tet4d-mc takes them",
                  &options.inputs)
      .heading("Slices")
      .option("--at", "T", "slice at a world time, or at a frame with the suffix f", &options.at)
      .option("--times", "A:B:STEP", "slices from A to B, both included; f as in --at", &options.times)
      .flag("--normals", "write normals at vertices", &options.normals)
      .option("--normals-from", "WHAT", "area-weighted from the slice, or the hypermesh's column normal",
              cli::Choice{&options.normals_from, {"slice", "column"}})
      .option("--columns", "NAME,...", "columns of the hypermesh to interpolate: names, all or none", &options.columns)
      .flag("--velocity", "write the velocity along the normal: the column, else computed from the tetrahedra",
            &options.velocity)
      .option("--part", "N", "only part N, counted from 0, of a hypermesh of several isovalues", &options.part)
      .option("--draco-bits", "N", "of a .drc's positions and columns, 1 to 30 (14); normals have four fewer",
              &options.draco_bits)
      .heading("Meshes of tetrahedra")
      .option("--scalar-as-time", "NAME", "a hypermesh whose slice at v is the isosurface of v: an array, or x, y, z",
              &options.scalar_as_time)
      .option("--sweep-frames", "N", "frames that the scalar's range is divided into, both ends included",
              &options.sweep_frames)
      .flag("--tets-only", "leave out cells that are no tetrahedra", &options.tets_only)
      .heading("Options")
      .option("--page-codec", "CODEC", "how a .t4g's or .t4q's frames are stored",
              cli::Choice{&options.codec, {"raw", "zstd"}})
      .common({cli::kOutputRequired, cli::kForce, cli::kStats, cli::kDepfile});
  frames::addFrameOptions(command, options.frames, "--frame-times");
  return cli::run(argc, argv, command, [&](cli::Session& session) { return body(session, options); });
}

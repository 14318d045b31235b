// tet4d-mc: frames of a volume, or a mesh whose vertices move → hypermesh. Ponchio & Hormann 2008, sec. 4.
#include <string>
#include <vector>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/surface_source.h"
#include "tools/common/cli.h"
#include "tools/frames/frame_options.h"
#include "tools/mc/extract_options.h"
#include "tools/mc/extract_volume.h"
#include "tools/mc/mesh_sequence.h"

namespace {

using namespace tet4d;

struct Arguments {
  std::vector<std::string> inputs;
  frames::FrameOptions frames;
  mc::ExtractOptions extract;
  mc::MeshOptions mesh;
};

void addExamples(cli::Command& command) {
  command.example("tet4d-mc frames/*.nrrd --iso 0.5 -o drop.t4h", "the surface where the field is 0.5, at all times")
      .example("tet4d-mc volume4d.nrrd --iso 128 --nan mask -o scan.t4h", "samples that are NaN leave holes")
      .example("tet4d-mc alpha_%04d.nrrd --iso 0.5 --times times.txt -o dam.t4h", "frames at times of your own")
      .example("tet4d-mc run.raw --size 64,64,64 --type f32 --iso 0.5 -o run.t4h", "raw frames behind each other")
      .example("tet4d-mc alpha_%04d.nrrd --iso 0.1,0.5,0.9 --cap -o dam.t4h", "three surfaces, closed at the walls")
      .example("tet4d-mc rho_%04d.nrrd --iso 1 --normals tets --velocity --field T=temp_%04d.nrrd -o shock.t4h",
               "with normals, velocity and another field as columns")
      .example("simulate | tet4d-mc - --iso 0.5 -o run.t4h", "NRRDs as they come, while the simulation runs")
      .example("tet4d-mc cloth-*.obj --linear-tolerance 0.1% -o cloth.t4h", "a mesh whose vertices move");
}

int buildMeshes(cli::Session& session, const Arguments& arguments) {
  std::string option = mc::extractOption(arguments.extract);
  if (option.empty()) option = frames::volumeOption(arguments.frames);
  if (!option.empty()) {
    throw Error(FaultCode::kUsage, arguments.inputs.front(), "option " + option, "is for volumes, and this is a mesh",
                "leave it out");
  }
  return mc::buildMeshSequence(session, arguments.inputs,
                               frames::givenTimes(arguments.frames.times, "--times", session),
                               arguments.frames.allow_gaps, arguments.extract.codec == "zstd", arguments.mesh);
}

int run(cli::Session& session, const Arguments& arguments) {
  if (session.options().output == "-") {
    throw Error(FaultCode::kUsage, "", "option --output", "a hypermesh cannot be written to a pipe",
                "name a file: -o X.t4h");
  }
  cli::expectSuffix(session, ".t4h", "name it X.t4h; tet4d-convert makes .vtu, .ply and others of a .t4h");
  if (exchange::areSurfaces(arguments.inputs)) return buildMeshes(session, arguments);
  if (arguments.extract.isovalues.empty()) {
    throw Error(FaultCode::kUsage, "", "option --iso", "must be given for volumes", "give an isovalue: --iso 0.5");
  }
  if (arguments.mesh.given()) {
    throw Error(FaultCode::kUsage, "", "option --linear-tolerance", "and --linear-window are for mesh sequences",
                "leave them out");
  }
  return mc::extractVolume(session, arguments.inputs, arguments.frames, arguments.extract);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  cli::Command command("tet4d-mc", "Makes one mesh in space-time of a sequence: the isosurface of volumes, or meshes.");
  addExamples(command);
  command.positional("FRAMES",
                     std::string(frames::kFramesHelp) +
                         "; or meshes with the same faces (.obj, .off, .ply, .stl, sequence.json, .t4q)",
                     &arguments.inputs);
  mc::addExtractOptions(command, arguments.extract);
  frames::addFrameOptions(command, arguments.frames);
  arguments.mesh.declare(command);
  command.heading("Options").common(
      {cli::kOutputRequired, cli::kThreads, cli::kMemory, cli::kForce, cli::kDryRun, cli::kStats, cli::kDepfile});
  return cli::run(argc, argv, command, [&](cli::Session& session) { return run(session, arguments); });
}

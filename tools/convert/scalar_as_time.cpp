#include "tools/convert/scalar_as_time.h"

#include <string>
#include <utility>

#include "libpreprocess/exchange/read_tet_mesh.h"
#include "libpreprocess/hypermesh/scalar_time.h"

namespace tet4d::convert {
namespace {

// What is odd about the mesh, told once it is written.
void report(cli::Session& session, const hypermesh::ScalarSweep& sweep, std::uint64_t other_cells) {
  const hypermesh::Orientation& found = sweep.orientation();
  if (other_cells > 0) session.warn(std::to_string(other_cells) + " cells are no tetrahedra and left out");
  if (found.negative > 0) {
    session.warn(std::to_string(found.negative) + " tetrahedra had negative volume and were turned");
  }
  if (found.degenerate > 0) session.note(std::to_string(found.degenerate) + " tetrahedra have no volume");
  if (found.inverted > 0) {
    session.warn(std::to_string(found.inverted) +
                 " tetrahedra lie inverted between their neighbours: the mesh is folded there");
  }
  if (sweep.sharedFrames() > 0) {
    session.note(std::to_string(sweep.sharedFrames()) + " neighbouring values are too close for float32 frame numbers");
  }
  session.stats().count("vertices", sweep.vertices());
  session.stats().count("tets", sweep.tets());
  session.stats().count("frames", sweep.times().size());
  session.stats().count("turned_tets", found.negative);
  session.stats().count("inverted_tets", found.inverted);
  session.stats().count("degenerate_tets", found.degenerate);
  session.note(std::to_string(sweep.vertices()) + " vertices, " + std::to_string(sweep.tets()) + " tets, " +
               std::to_string(sweep.times().size()) + " frames");
}

}  // namespace

void convertScalarAsTime(cli::Session& session, const Options& options) {
  cli::expectSuffix(session, ".t4h", "name it X.t4h; slices of it become .vtp, .ply and others");
  if (options.inputs.size() != 1) failUsage("--scalar-as-time is for one mesh", "give one .vtu, .mesh, .msh or .node");
  if (options.wantsSlices() || !options.sliceOption().empty()) {
    failUsage("--scalar-as-time makes a hypermesh, slices come after it", "leave --at, --times and theirs out");
  }
  session.progress().phase("read", 1);
  exchange::TetMesh mesh = exchange::readTetMesh(options.inputs.front(), {options.scalar_as_time, options.tets_only});
  session.progress().step(1);
  const std::uint64_t other_cells = mesh.other_cells;
  hypermesh::ScalarSweep sweep(std::move(mesh), options.sweep_frames, session.memory());
  const paged::Codec codec = options.codec == "zstd" ? paged::Codec::kZstd : paged::Codec::kRaw;
  hypermesh::Writer writer = unwrap(hypermesh::Writer::create(session.options().output, sweep.header(), sweep.times(),
                                                              {}, codec, session.options().force));
  sweep.write(writer, session.progress());
  const cli::Input input{"mesh", cli::fileDigest(options.inputs.front())};  // whatever the file is called
  unwrap(writer.close(session.provenance({&input, 1})));
  report(session, sweep, other_cells);
}

}  // namespace tet4d::convert

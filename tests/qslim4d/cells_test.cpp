// Out of core: cells of a mesh, cut in sweeps, against the whole mesh in core.
#include "libpreprocess/qslim4d/cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "libpreprocess/error.h"
#include "libpreprocess/measure/slice_distance.h"
#include "libpreprocess/outofcore/work_folder.h"
#include "libpreprocess/qslim4d/cell_files.h"
#include "libpreprocess/qslim4d/cell_tree.h"
#include "libpreprocess/qslim4d/mesh_file.h"
#include "libpreprocess/qslim4d/stream_writer.h"
#include "libpreprocess/topology/check_hypermesh.h"
#include "libpreprocess/topology/links.h"
#include "tests/hypermesh/extracted_mesh.h"
#include "tests/hypermesh/memory_frames.h"
#include "tests/measure/sphere.h"

namespace tet4d::qslim4d {
namespace {

using hypermesh::Tet;
namespace marching = hypermesh::testing;

constexpr testing::MovingBall kBall{{9.2, 9.5, 9}, {0.4, -0.1, 0.2}, 5.4, 0.3};

// `hole`: samples are missing, so that there is a free boundary inside.
marching::ExtractedMesh ball(const std::string& path, bool hole = false) {
  marching::MemoryFrames<float> frames({24, 22, 22}, 9, [&](auto x, auto y, auto z, auto k) {
    if (hole && x > 10 && x < 15 && y > 12 && k > 2 && k < 6) return std::nanf("");
    return static_cast<float>(
        kBall.fieldAt(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z), static_cast<double>(k)));
  });
  hypermesh::Options options;
  options.iso = 0;
  if (hole) options.nan = hypermesh::NanRule::kMask;
  return marching::extractTo(path, frames, options);
}

hypermesh::File open(const std::string& path) { return unwrap(hypermesh::File::open(path)); }

std::string bytesOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

hypermesh::Writer writerFor(const std::string& path, const hypermesh::File& file) {
  hypermesh::MeshHeader header{};
  header.flags = file.header().flags;
  header.index_to_world = file.header().index_to_world;
  header.domain = file.header().domain;
  header.isovalue = file.header().isovalue;
  return unwrap(hypermesh::Writer::create(path, header, file.times(), {}, paged::Codec::kRaw, true));
}

struct Means {
  std::size_t threads = 1;
  std::uint64_t memory = 0;
  Order order = Order::kPasses;
  bool resume = false;
  outofcore::Progress* progress = nullptr;
};

CellReport simplifyTo(const std::string& out, const hypermesh::File& file, const Options& options,
                      std::uint64_t cell_tets, const Means& run = {}) {
  outofcore::ThreadExecutor executor(run.threads);
  outofcore::Progress silent;
  outofcore::MemoryBudget memory(run.memory);
  Options with_order = options;
  with_order.order = run.order;
  hypermesh::Writer writer = writerFor(out, file);
  CellOptions cells;
  cells.cell_tets = cell_tets, cells.folder = out + ".cells", cells.run_name = "test", cells.resume = run.resume;
  const CellReport report = simplifyInCells(file, Metric::kSlice, with_order, cells, writer, executor, memory,
                                            run.progress != nullptr ? *run.progress : silent);
  unwrap(writer.close("{}"));
  EXPECT_FALSE(std::filesystem::exists(out + ".cells"));
  return report;
}

CellReport simplifyInCore(const std::string& out, const hypermesh::File& file, const Options& options) {
  outofcore::ThreadExecutor executor(1);
  outofcore::Progress progress;
  hypermesh::Writer writer = writerFor(out, file);
  SlimMesh mesh = readMesh(file, ReadOptions{}, progress);
  CellReport report;
  report.stats = simplify(mesh, options, executor, progress);
  writeMesh(mesh, report.stats.largest_error, writer, progress);
  unwrap(writer.close("{}"));
  report.tets = mesh.live_tets;
  return report;
}

Options toTets(std::uint64_t target) {
  Options options;
  options.target_tets = target;
  return options;
}

void expectManifold(const std::string& path) {
  const hypermesh::File file = open(path);
  EXPECT_TRUE(file.verify().ok()) << file.verify().fault().what;
  outofcore::Progress progress;
  const topology::HypermeshCheck faces = topology::checkHypermesh(file, progress);
  EXPECT_TRUE(faces.ok()) << (faces.faults.empty() ? "" : faces.faults[0]);
  EXPECT_EQ(faces.unused_vertices, 0u);
  outofcore::MemoryBudget memory;
  const topology::LinkCheck links = topology::checkLinks(file, memory, progress);
  EXPECT_TRUE(links.ok()) << (links.faults.empty() ? "" : links.faults[0]);
}

measure::SliceDistance distance(const std::string& result, const std::string& reference) {
  outofcore::ThreadExecutor executor(1);
  outofcore::Progress progress;
  return measure::compareSlices(open(result), open(reference), {0, 1, 2.37, 4, 5.63, 7, 8}, {1e-3, 5000, 100'000},
                                executor, progress);
}

// ---- whole meshes

TEST(Cells, TheSameBytesForAnyThreadsAndMemory) {
  const std::string in = marching::temporaryPath("cells_in.t4h"), out = marching::temporaryPath("cells_out.t4h");
  ball(in);
  const hypermesh::File file = open(in);
  const Options options = toTets(file.header().tets / 8);
  for (const Order order : {Order::kPasses, Order::kMultichoice}) {
    const CellReport first = simplifyTo(out, file, options, file.header().tets / 5, {1, 0, order});
    const std::string bytes = bytesOf(out);
    EXPECT_GE(first.sweeps.size(), 2U);
    EXPECT_GE(first.sweeps[0].cells, 5U);
    EXPECT_LE(first.tets, options.target_tets);
    EXPECT_GT(first.tets, options.target_tets * 9 / 10);
    std::set<std::size_t> in_flight{first.most_in_flight};
    const std::uint64_t least = boundCellMemory(file, file.header().tets / 5);
    for (const Means& run :
         {Means{2, 0, order}, Means{4, 0, order}, Means{4, least, order}, Means{3, 2 * least, order}}) {
      in_flight.insert(simplifyTo(out, file, options, file.header().tets / 5, run).most_in_flight);
      EXPECT_TRUE(bytes == bytesOf(out)) << run.threads << " threads, memory " << run.memory;
    }
    EXPECT_GE(in_flight.size(), 3U) << "memory and threads must have made a difference";
  }
}

TEST(Cells, TooLittleMemorySaysHowMuchAndLeavesNothing) {
  const std::string in = marching::temporaryPath("cells_in.t4h"), out = marching::temporaryPath("cells_out.t4h");
  ball(in);
  std::filesystem::remove(out);
  const hypermesh::File file = open(in);
  EXPECT_THROW(simplifyTo(out, file, toTets(5000), file.header().tets / 5, {1, 1 << 16}), Error);
  EXPECT_FALSE(std::filesystem::exists(out + ".cells"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(Cells, AreManifoldsAsNearTheInputAsInCore) {
  const std::string in = marching::temporaryPath("cells_in.t4h"), out = marching::temporaryPath("cells_out.t4h"),
                    core = marching::temporaryPath("cells_core.t4h");
  ball(in);
  const hypermesh::File file = open(in);
  const Options options = toTets(file.header().tets / 10);
  const CellReport report = simplifyTo(out, file, options, file.header().tets / 6, {2});
  simplifyInCore(core, file, options);
  expectManifold(out);
  EXPECT_LE(report.tets, options.target_tets);
  const measure::SliceDistance cells = distance(out, in), whole = distance(core, in);
  EXPECT_LT(cells.rms, 1.15 * whole.rms);
  EXPECT_LT(cells.p99, 1.25 * whole.p99);
  EXPECT_LT(cells.volume_error, 0.03);
}

// A mesh with a boundary of its own inside keeps it, and cuts are no boundary.
TEST(Cells, AFreeBoundaryIsHeldAndACutIsNone) {
  const std::string in = marching::temporaryPath("cells_hole.t4h"), out = marching::temporaryPath("cells_out.t4h");
  ball(in, true);
  const hypermesh::File file = open(in);
  simplifyTo(out, file, toTets(file.header().tets / 6), file.header().tets / 7, {2});
  expectManifold(out);
  outofcore::Progress progress;
  const auto before = topology::checkHypermesh(file, progress), after = topology::checkHypermesh(open(out), progress);
  EXPECT_GT(before.inner_boundary_faces, 100U);
  EXPECT_LT(after.inner_boundary_faces, before.inner_boundary_faces);
  EXPECT_GT(after.inner_boundary_faces, 10U);
  EXPECT_LT(distance(out, in).rms, 0.15);
}

TEST(Cells, AnErrorIsALimitInEverySweep) {
  const std::string in = marching::temporaryPath("cells_in.t4h"), out = marching::temporaryPath("cells_out.t4h");
  ball(in);
  const hypermesh::File file = open(in);
  Options options;
  options.most_error = 0.03;
  const CellReport report = simplifyTo(out, file, options, file.header().tets / 5);
  EXPECT_LE(report.stats.largest_error, 0.03);
  EXPECT_LT(report.tets, file.header().tets / 2);
  expectManifold(out);
  const CellReport whole = simplifyInCore(out, file, options);
  EXPECT_LT(static_cast<double>(report.tets), 1.15 * static_cast<double>(whole.tets));
}

// What lies near a plane that cut the first sweep is as dense as what lies elsewhere: the second sweep has been there.
TEST(Cells, NoSeamRemains) {
  const std::string in = marching::temporaryPath("cells_in.t4h"), out = marching::temporaryPath("cells_out.t4h");
  const marching::ExtractedMesh mesh = ball(in);
  const hypermesh::File file = open(in);
  // The first sweep's cells, found anew.
  const FixedGrid grid(file.header().bounds);
  const auto sumOf = [&](const Tet& tet) {
    FixedPlace sum{};
    for (const std::uint32_t v : tet) {
      const FixedPlace place = grid.placeOf(mesh.vertices[v]);
      for (std::size_t axis = 0; axis < 4; ++axis) sum[axis] += place[axis];
    }
    return sum;
  };
  std::vector<FixedPlace> sums;
  for (const Tet& tet : mesh.tets) sums.push_back(sumOf(tet));
  const double speed =
      makeSlimMesh(mesh.vertices, mesh.tets, mesh.header.domain, mesh.header.index_to_world, Metric::kSlice)
          .space.speed;
  const std::uint64_t cell_tets = mesh.tets.size() / 4;
  const CellTree tree(sums, mesh.tets.size(), cell_tets, Cuts::kHalves,
                      {grid.step(0), grid.step(1), grid.step(2), speed * grid.step(3)});
  ASSERT_GE(tree.cells(), 4U);
  std::map<std::uint32_t, std::set<std::uint32_t>> users;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (const std::uint32_t v : mesh.tets[t]) users[v].insert(tree.cellOf(sums[t]));
  std::set<std::array<float, 4>> seam;
  for (const auto& [v, cells] : users)
    if (cells.size() > 1) seam.insert({mesh.vertices[v].x, mesh.vertices[v].y, mesh.vertices[v].z, mesh.vertices[v].t});
  ASSERT_GT(seam.size(), 200U);
  const CellReport report = simplifyTo(out, file, toTets(mesh.tets.size() / 12), cell_tets);
  EXPECT_GE(report.sweeps[0].cells, 4U);
  EXPECT_GT(report.sweeps[1].cells, 1U) << "the last sweep must be cut, too";
  // A vertex that never moved has its old coordinates to the bit. Of all vertices a twelfth is left; of the seam's no
  // more than that may stand where they stood.
  std::size_t stuck = 0;
  const hypermesh::File result = open(out);
  for (std::size_t k = 0; k < result.geometryPages(); ++k)
    for (const Vec4f& v : unwrap(result.gather(k)).view.vertices) stuck += seam.contains({v.x, v.y, v.z, v.t}) ? 1 : 0;
  EXPECT_LT(static_cast<double>(stuck), 0.15 * static_cast<double>(seam.size()));
}

// ---- pieces

TEST(Cells, TheStreamingWriterWritesWhatTheOneInCoreWrites) {
  const std::string in = marching::temporaryPath("cells_in.t4h"), out = marching::temporaryPath("cells_a.t4h"),
                    streamed = marching::temporaryPath("cells_b.t4h");
  ball(in);
  const hypermesh::File file = open(in);
  outofcore::ThreadExecutor executor(1);
  outofcore::Progress progress;
  SlimMesh mesh = readMesh(file, ReadOptions{}, progress);
  const std::uint64_t all = mesh.positions.size();
  simplify(mesh, toTets(file.header().tets * 3 / 4), executor, progress);
  hypermesh::Writer a = writerFor(out, file);
  writeMesh(mesh, 0.5, a, progress);
  unwrap(a.close("{}"));
  {
    const outofcore::WorkFolder folder(streamed + ".cells", "test", false);
    std::vector<std::uint64_t> ids(all);
    for (std::size_t v = 0; v < all; ++v) ids[v] = 3 * v + (std::uint64_t{1} << 40);
    writeResult(folder.file("r"), mesh, ids, true, {});
    for (const std::size_t buffer : {std::size_t{1} << 12, std::size_t{1} << 26}) {
      hypermesh::Writer again = writerFor(streamed, file);
      const PartResults results{{folder.file("r")}, 0.5};
      const WrittenMesh written = writeResults({&results, 1}, {}, again, folder, buffer, progress);
      unwrap(again.close("{}"));
      EXPECT_EQ(written.vertices, mesh.live_vertices);
      EXPECT_EQ(written.tets, mesh.live_tets);
      EXPECT_GT(open(streamed).geometryPages(), 1U);
      EXPECT_TRUE(bytesOf(out) == bytesOf(streamed)) << buffer;
    }
  }
}

// Interrupts after a number of steps.
class Interrupting final : public outofcore::Progress {
 public:
  explicit Interrupting(int steps) : left_(steps) {}
  void step(std::uint64_t) override {
    if (--left_ < 0) throw Error(FaultCode::kInterrupted, "", "", "interrupted", "");
  }
  bool isOver() const { return left_ < 0; }

 private:
  int left_;
};

TEST(Cells, AnInterruptAtAnyStepIsResumedToTheSameBytes) {
  const std::string in = marching::temporaryPath("cells_in.t4h"), out = marching::temporaryPath("cells_out.t4h");
  ball(in);
  const hypermesh::File file = open(in);
  const Options options = toTets(file.header().tets / 8);
  simplifyTo(out, file, options, file.header().tets / 4);
  const std::string bytes = bytesOf(out);
  std::filesystem::remove(out);
  int interrupts = 0;
  bool whole = false;
  // Each run gets as far as one cell or phase further.
  for (int steps = 3; !whole && interrupts < 200; steps += 2) {
    Interrupting progress(steps);
    try {
      simplifyTo(out, file, options, file.header().tets / 4, {1, 0, Order::kPasses, true, &progress});
      whole = true;
    } catch (const Error& error) {
      ASSERT_EQ(error.fault().code, FaultCode::kInterrupted);
      ++interrupts;
      EXPECT_FALSE(std::filesystem::exists(out));
      if (std::filesystem::exists(out + ".cells")) {
        EXPECT_NE(error.fault().remedy.find("--resume"), std::string::npos);
      }
    }
  }
  EXPECT_TRUE(whole);
  EXPECT_GT(interrupts, 4);
  EXPECT_TRUE(bytes == bytesOf(out));
}

}  // namespace
}  // namespace tet4d::qslim4d

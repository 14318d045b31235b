#include "tests/vpartition/cuts.h"

#include <bit>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "libpreprocess/error.h"

namespace tet4d::vpartition::testing {

LoadedDag load(const std::string& path) {
  const patch_dag::File file = unwrap(patch_dag::File::open(path));
  unwrap(file.verify());
  LoadedDag dag;
  dag.nodes.assign(file.nodes().begin(), file.nodes().end());
  dag.domain = file.header().domain;
  std::map<std::array<std::uint32_t, 4>, std::uint64_t> ids;
  std::vector<std::set<std::uint64_t>> uppers(dag.nodes.size());
  for (std::size_t p = 0; p < file.patches(); ++p) {
    const patch_dag::LoadedPatch loaded = unwrap(file.loadPatch(p));
    LoadedDag::Patch& patch = dag.patches.emplace_back();
    patch.from = file.fromOf(p), patch.to = file.toOf(p), patch.shared = loaded.view.header->shared;
    patch.begin = file.patchEntry(p).bounds.min.t, patch.end = file.patchEntry(p).bounds.max.t;
    patch.vertices.assign(loaded.view.vertices.begin(), loaded.view.vertices.end());
    for (const auto& tet : loaded.view.tets) patch.tets.push_back({tet[0], tet[1], tet[2], tet[3]});
    for (const Vec4f& v : patch.vertices) {
      const auto bits = [](float f) { return std::bit_cast<std::uint32_t>(f); };
      patch.ids.push_back(ids.try_emplace({bits(v.x), bits(v.y), bits(v.z), bits(v.t)}, ids.size()).first->second);
    }
    uppers[patch.to].insert(patch.from);
  }
  for (const auto& set : uppers) dag.uppers.emplace_back(set.begin(), set.end());
  return dag;
}

std::vector<bool> randomCut(const LoadedDag& dag, std::mt19937& random, double chance) {
  std::vector<bool> refined(dag.nodes.size());
  refined[0] = true;
  std::bernoulli_distribution yes(chance);
  const auto whole = std::uniform_int_distribution<std::uint32_t>(0, dag.nodes[0].level)(random);
  for (std::size_t node = 1; node + 1 < dag.nodes.size(); ++node) {
    bool may = true;
    for (const std::uint64_t upper : dag.uppers[node]) may = may && refined[upper];
    refined[node] = may && (dag.nodes[node].level > whole || yes(random));
  }
  return refined;
}

std::vector<bool> cutAt(const LoadedDag& dag, double error) {
  std::vector<bool> refined(dag.nodes.size());
  for (std::size_t node = 0; node + 1 < dag.nodes.size(); ++node)
    refined[node] = node == 0 || double{dag.nodes[node].error_estimated} > error;
  return refined;
}

std::vector<std::size_t> patchesOf(const LoadedDag& dag, const std::vector<bool>& refined) {
  std::vector<std::size_t> cut;
  for (std::size_t p = 0; p < dag.patches.size(); ++p)
    if (refined[dag.patches[p].from] && !refined[dag.patches[p].to]) cut.push_back(p);
  return cut;
}

SliceMesh sliceOf(const LoadedDag& dag, const std::vector<std::size_t>& patches, float t) {
  TetSlicer slicer(t, dag.domain.max.t);
  for (const std::size_t p : patches) {
    const LoadedDag::Patch& patch = dag.patches[p];
    if (patch.begin <= t && t <= patch.end) slicer.add(patch.tets, patch.vertices, patch.ids);
  }
  return slicer.take();
}

double volumeOf(const SliceMesh& slice) {
  double sum = 0;
  for (const auto& [a, b, c] : slice.triangles) {
    const Vec3f &p = slice.positions[a], &q = slice.positions[b], &r = slice.positions[c];
    sum += double{p.x} * (double{q.y} * double{r.z} - double{q.z} * double{r.y}) -
           double{p.y} * (double{q.x} * double{r.z} - double{q.z} * double{r.x}) +
           double{p.z} * (double{q.x} * double{r.y} - double{q.y} * double{r.x});
  }
  return sum / 6;
}

BuildRun buildTo(const std::string& path, const std::string& mesh, const Options& options, std::size_t threads) {
  const hypermesh::File file = unwrap(hypermesh::File::open(mesh));
  outofcore::ThreadExecutor executor(threads);
  outofcore::MemoryBudget memory;
  outofcore::Progress silent;
  BuildRun run;
  run.dag = buildDag(file, options, executor, memory, silent);
  patch_dag::Header header{};
  header.flags = file.header().flags;
  header.index_to_world = file.header().index_to_world;
  header.domain = file.header().domain;
  header.isovalue = file.header().isovalue;
  header.time_scale = options.time_scale;
  auto writer =
      unwrap(patch_dag::Writer::create(path, header, file.times(), run.dag.nodes, {}, paged::Codec::kRaw, true));
  writeDag(run.dag, writer, silent);
  unwrap(writer.close("{}"));
  std::ifstream in(path, std::ios::binary);
  run.bytes.assign(std::istreambuf_iterator<char>(in), {});
  return run;
}

}  // namespace tet4d::vpartition::testing

#include "libpreprocess/vpartition/dag_builder.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/mesh_pages.h"
#include "libpreprocess/qslim4d/mesh_file.h"
#include "libpreprocess/qslim4d/space.h"
#include "libpreprocess/vpartition/cell.h"
#include "libpreprocess/vpartition/lattice.h"
#include "libpreprocess/vpartition/orphans.h"

namespace tet4d::vpartition {
namespace {

using hypermesh::Tet;

constexpr std::size_t kSamplesPerCell = 512, kLeastSamples = std::size_t{1} << 13, kMostSamples = std::size_t{1} << 18;
constexpr double kStuckShare = 0.9;
constexpr std::uint32_t kMostLevels = 64;
constexpr std::size_t kMostStuckLevels = 3;  // in a row
constexpr double kNoError = 1e-6;            // mean cells: below what f32 coordinates resolve
constexpr std::uint32_t kSink = 0;
constexpr std::size_t kChunk = 16384;  // tetrahedra a task

// The mesh of a level: vertices keep the numbers they have in the input.
struct LevelMesh {
  std::vector<Vec4f> positions;
  std::vector<Tet> tets;
  std::vector<std::uint32_t> left_by;  // by tetrahedron: the node that left it
};

// A node in the order of building: the sink, the cells of each level, the source.
struct Node {
  std::uint32_t level = 0, flags = 0;
  float error = 0;
  Bounds4f bounds;
};

float roundedUp(double value) {
  const auto near = static_cast<float>(value);
  return near < value ? std::nextafter(near, std::numeric_limits<float>::infinity()) : near;
}

void inChunks(outofcore::Executor& executor, std::size_t count,
              const std::function<void(std::size_t, std::size_t)>& task) {
  executor.run((count + kChunk - 1) / kChunk,
               [&](std::size_t i) { task(i * kChunk, std::min(count, (i + 1) * kChunk)); });
}

class Builder {
 public:
  Builder(const hypermesh::File& file, const Options& options, outofcore::Executor& executor,
          outofcore::Progress& progress)
      : file_(file),
        options_(options),
        executor_(executor),
        progress_(progress),
        space_(qslim4d::spaceOf(file.header().index_to_world)),
        lattice_(file.header().bounds, file.header().index_to_world, options.time_scale) {
    rules_.domain = file.header().domain;
    rules_.map = file.header().index_to_world;
    nodes_.push_back({});
  }

  Dag build() {
    read();
    std::size_t stuck_levels = 0;
    for (std::uint32_t level = 1; level <= kMostLevels; ++level) {
      if (mesh_.tets.size() <= options_.patch_tets) break;
      const std::uint32_t cells = addLevel(level);
      const LevelReport& report = dag_.levels.back();
      const bool is_stuck = static_cast<double>(report.tets_out) > kStuckShare * static_cast<double>(report.tets_in);
      if (level == 1 && is_stuck) refuseOneLevel(report);
      stuck_levels = is_stuck ? stuck_levels + 1 : 0;
      // Nothing is locked in one cell: what it could not take away, no later one can.
      if ((cells == 1 && is_stuck) || stuck_levels == kMostStuckLevels) break;
    }
    addSource();
    number();
    return std::move(dag_);
  }

 private:
  void read() {
    progress_.phase("read", file_.geometryPages());
    mesh_.positions.reserve(file_.header().vertices);
    mesh_.tets.reserve(file_.header().tets);
    std::uint64_t done = 0;
    exchange::forEachPage(file_, [&](const hypermesh::GatheredPage& page) {
      const auto own = page.view.vertices;
      mesh_.positions.insert(mesh_.positions.end(), own.begin(), own.end());
      const std::vector<std::uint64_t> ids = exchange::globalNumbers(page.view);
      for (const Tet& tet : page.view.tets) {
        Tet& named = mesh_.tets.emplace_back();
        for (std::size_t i = 0; i < 4; ++i) named[i] = static_cast<std::uint32_t>(ids[tet[i]]);
      }
      progress_.step(++done);
    });
    mesh_.left_by.assign(mesh_.tets.size(), kSink);
    double space = 0, time = 0;
    for (const Tet& tet : mesh_.tets) {
      for (std::size_t i = 1; i < 4; ++i) {
        const glm::dvec4 edge = qslim4d::difference(mesh_.positions[tet[i]], mesh_.positions[tet[0]]);
        space += space_.length(edge);
        time += std::abs(edge.w);
      }
    }
    rules_.speed = qslim4d::speedFrom(space, time);
  }

  // Partition, patches of what came in, simplified cells. Returns the number of cells.
  std::uint32_t addLevel(std::uint32_t level) {
    LevelReport report;
    report.tets_in = mesh_.tets.size();
    progress_.phase("partition", 1);
    placeTets();
    std::uint32_t cells = 0;
    const std::vector<std::uint32_t> owners = ownersAt(level, cells, report);
    // By owner, each one's in their own order.
    std::vector<std::uint32_t> begin(cells + std::size_t{1}), order(mesh_.tets.size());
    for (const std::uint32_t owner : owners) ++begin[owner + std::size_t{1}];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (std::uint32_t t = 0; t < owners.size(); ++t) order[next[owners[t]]++] = t;
    const auto first_node = static_cast<std::uint32_t>(nodes_.size());
    nodes_.resize(nodes_.size() + cells);
    const std::size_t first_patch = dag_.patches.size();
    cutLevel(first_node, begin, order);
    progress_.step(1);
    simplifyLevel(level, first_node, owners, begin, order, report);
    report.patches = dag_.patches.size() - first_patch;
    dropExact(first_node, first_patch);
    dag_.levels.push_back(report);
    return cells;
  }

  void placeTets() {
    places_.resize(mesh_.tets.size());
    inChunks(executor_, mesh_.tets.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) places_[t] = lattice_.placeOf(mesh_.tets[t], mesh_.positions);
    });
  }

  std::vector<Sample> samplesFor(std::uint32_t cells) {
    const float first = file_.header().bounds.min.t;
    Sampler sampler(std::clamp(cells * kSamplesPerCell, kLeastSamples, kMostSamples),
                    double{file_.header().bounds.max.t} - double{first}, options_.seed);
    const double steps = 1 / lattice_.step();
    for (std::size_t t = 0; t < mesh_.tets.size(); ++t) {
      const Tet& tet = mesh_.tets[t];
      Sample sample;
      sample.at = places_[t];
      for (std::size_t i = 1; i < 4; ++i) {
        const glm::dvec4 edge = qslim4d::difference(mesh_.positions[tet[i]], mesh_.positions[tet[0]]);
        const double along_space = space_.length(edge) * steps, along_time = edge.w * options_.time_scale * steps;
        sample.space2 += along_space * along_space;
        sample.time2 += along_time * along_time;
      }
      sampler.add(sample, double{mesh_.positions[tet[0]].t} - double{first});
    }
    return sampler.take();
  }

  // The owner of every tetrahedron, decided here and never again; cells that own none are left out.
  std::vector<std::uint32_t> ownersAt(std::uint32_t level, std::uint32_t& cells, LevelReport& report) {
    const double wanted = static_cast<double>(mesh_.tets.size()) / static_cast<double>(options_.cell_tets);
    cells = static_cast<std::uint32_t>(std::clamp(std::round(wanted), 1.0, 1e6));
    std::vector<std::uint32_t> owners(mesh_.tets.size(), 0);
    if (cells > 1) {
      const std::vector<Sample> samples = samplesFor(cells);
      const auto partition = makePartition(options_.partition, samples, cells, level, options_.seed);
      cells = partition->cells();
      inChunks(executor_, owners.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) owners[t] = partition->ownerOf(places_[t]);
      });
      report.orphans = mergeOrphans(mesh_.tets, mesh_.positions.size(), owners);
    }
    std::vector<std::uint64_t> sizes(cells);
    for (const std::uint32_t owner : owners) ++sizes[owner];
    std::vector<std::uint32_t> number(cells);
    std::uint32_t used = 0;
    for (std::uint32_t cell = 0; cell < cells; ++cell) {
      number[cell] = used;
      used += sizes[cell] != 0 ? 1 : 0;
    }
    for (std::uint32_t& owner : owners) owner = number[owner];
    std::erase(sizes, 0U);
    report.cells = cells = used;
    report.largest_cell = *std::max_element(sizes.begin(), sizes.end());
    report.smallest_cell = *std::min_element(sizes.begin(), sizes.end());
    return owners;
  }

  // The patches of the mesh as it came in, cut by the cells that take it up: nodes first_node + c. order: tetrahedra by
  // cell.
  void cutLevel(std::uint32_t first_node, const std::vector<std::uint32_t>& begin, std::vector<std::uint32_t>& order) {
    const std::size_t cells = begin.size() - 1;
    std::vector<std::vector<PatchRange>> cuts(cells);
    executor_.run(cells, [&](std::size_t c) {
      const auto part = std::span(order).subspan(begin[c], begin[c + 1] - begin[c]);
      cuts[c] = cutPatches(part, mesh_.left_by, places_, options_.patch_tets);
    });
    struct Task {
      std::size_t cell;
      PatchRange range;
    };
    std::vector<Task> tasks;
    std::vector<std::uint32_t> users(mesh_.positions.size(), kUnused);
    for (std::size_t c = 0; c < cells; ++c) {
      for (const PatchRange& range : cuts[c]) {
        for (std::uint32_t i = range.begin; i < range.end; ++i)
          noteUser(users, mesh_.tets[order[begin[c] + i]], static_cast<std::uint32_t>(tasks.size()));
        tasks.push_back({c, range});
      }
    }
    const std::size_t first = dag_.patches.size();
    dag_.patches.resize(first + tasks.size());
    executor_.run(tasks.size(), [&](std::size_t i) {
      const auto& [cell, range] = tasks[i];
      const auto chosen = std::span(order).subspan(begin[cell] + range.begin, range.end - range.begin);
      StoredPatch& patch = dag_.patches[first + i];
      patch = makePatch(chosen, mesh_.tets, mesh_.positions, users);
      patch.upper = first_node + static_cast<std::uint32_t>(cell);
      patch.lower = range.lower;
    });
  }

  CellMesh cellOf(std::span<const std::uint32_t> chosen, std::span<const std::uint32_t> users) const {
    CellMesh cell;
    std::vector<std::uint32_t> vertices;
    vertices.reserve(4 * chosen.size());
    for (const std::uint32_t t : chosen) vertices.insert(vertices.end(), mesh_.tets[t].begin(), mesh_.tets[t].end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    for (const std::uint32_t v : vertices) {
      cell.ids.push_back(v);
      cell.positions.push_back(mesh_.positions[v]);
      cell.flags.push_back(users[v] == kSeveral ? std::uint8_t{qslim4d::kLocked} : std::uint8_t{0});
    }
    cell.tets.reserve(chosen.size());
    for (const std::uint32_t t : chosen) {
      Tet& tet = cell.tets.emplace_back();
      for (std::size_t i = 0; i < 4; ++i) {
        const auto at = std::lower_bound(vertices.begin(), vertices.end(), mesh_.tets[t][i]);
        tet[i] = static_cast<std::uint32_t>(at - vertices.begin());
      }
    }
    return cell;
  }

  void simplifyLevel(std::uint32_t level, std::uint32_t first_node, const std::vector<std::uint32_t>& owners,
                     const std::vector<std::uint32_t>& begin, const std::vector<std::uint32_t>& order,
                     LevelReport& report) {
    const std::size_t cells = begin.size() - 1;
    progress_.phase("simplify", cells);
    std::vector<std::uint32_t> users(mesh_.positions.size(), kUnused);
    for (std::size_t t = 0; t < owners.size(); ++t) noteUser(users, mesh_.tets[t], owners[t]);
    std::vector<CellResult> results(cells);
    std::atomic<std::size_t> done{0};
    // Each cell reads the mesh and writes nothing but its result: in any order, at any time.
    executor_.run(cells, [&](std::size_t c) {
      const auto chosen = std::span(order).subspan(begin[c], begin[c + 1] - begin[c]);
      Node& node = nodes_[first_node + c];
      node.level = level;
      for (const std::uint32_t t : chosen) {
        for (const std::uint32_t v : mesh_.tets[t]) node.bounds.add(mesh_.positions[v]);
        const Node& below = nodes_[mesh_.left_by[t]];
        node.error = std::max(node.error, below.error);
        node.bounds.add(below.bounds);
      }
      results[c] = simplifyCell(cellOf(chosen, users), rules_, executor_);
      const CellResult& result = results[c];
      for (const Vec4f& v : result.mesh.positions) node.bounds.add(v);
      node.error = std::max(node.error, roundedUp(result.error_world));
      if (static_cast<double>(result.mesh.tets.size()) > kStuckShare * static_cast<double>(result.tets_in))
        node.flags |= patch_dag::kStuck;
      progress_.step(++done);
    });
    mergeLevel(first_node, results, report);
  }

  // What the cells left as one mesh. Vertices that several cells have were locked: all have the same.
  void mergeLevel(std::uint32_t first_node, std::vector<CellResult>& results, LevelReport& report) {
    mesh_.tets.clear();
    mesh_.left_by.clear();
    for (std::size_t c = 0; c < results.size(); ++c) {
      CellResult& result = results[c];
      const Node& node = nodes_[first_node + c];
      for (std::size_t v = 0; v < result.mesh.ids.size(); ++v)
        mesh_.positions[result.mesh.ids[v]] = result.mesh.positions[v];
      for (const Tet& tet : result.mesh.tets) {
        Tet& named = mesh_.tets.emplace_back();
        for (std::size_t i = 0; i < 4; ++i) named[i] = static_cast<std::uint32_t>(result.mesh.ids[tet[i]]);
      }
      mesh_.left_by.resize(mesh_.tets.size(), first_node + static_cast<std::uint32_t>(c));
      report.vertices += result.vertices_in;
      report.locked += result.locked;
      report.stuck += (node.flags & patch_dag::kStuck) != 0 ? 1 : 0;
      report.error_world = std::max(report.error_world, double{node.error});
      result = {};
    }
    report.tets_out = mesh_.tets.size();
  }

  bool isExact(std::uint32_t node) const {
    return node != kSink && nodes_[node].level != 0 && nodes_[node].error <= kNoError * space_.cell;
  }

  // Patches that come from a node without error are never wanted.
  void dropExact(std::uint32_t first_node, std::size_t first_patch) {
    for (std::uint32_t node = first_node; node < nodes_.size(); ++node) dag_.pruned_nodes += isExact(node) ? 1 : 0;
    const auto from = dag_.patches.begin() + static_cast<std::ptrdiff_t>(first_patch);
    dag_.patches.erase(std::remove_if(from, dag_.patches.end(), [&](const StoredPatch& p) { return isExact(p.upper); }),
                       dag_.patches.end());
  }

  [[noreturn]] void refuseOneLevel(const LevelReport& report) const {
    const double locked =
        100 * static_cast<double>(report.locked) / static_cast<double>(std::max<std::uint64_t>(1, report.vertices));
    throw Error(FaultCode::kBadInput, file_.reader().path(), "",
                "cannot be made coarser: of " + std::to_string(report.tets_in) + " tetrahedra in " +
                    std::to_string(report.cells) + " cells " + std::to_string(report.tets_out) + " were left, with " +
                    std::to_string(static_cast<int>(locked)) + " % of the vertices locked between cells",
                report.cells > 1 ? "raise --cell-tets, or lower --time-scale if cells are cut at every frame"
                                 : "see tet4d-info --links for where the mesh is no manifold");
  }

  void addSource() {
    progress_.phase("partition", 1);
    placeTets();
    const auto source = static_cast<std::uint32_t>(nodes_.size());
    Node node;
    node.level = static_cast<std::uint32_t>(dag_.levels.size()) + 1;
    node.bounds = file_.header().bounds;
    for (const Node& below : nodes_) {
      node.error = std::max(node.error, below.error);
      node.bounds.add(below.bounds);
    }
    nodes_.push_back(node);
    const std::size_t first_patch = dag_.patches.size();
    std::vector<std::uint32_t> order(mesh_.tets.size());
    std::iota(order.begin(), order.end(), 0U);
    if (!order.empty()) cutLevel(source, {0, static_cast<std::uint32_t>(order.size())}, order);
    dag_.root_tets = mesh_.tets.size();
    dag_.root_patches = dag_.patches.size() - first_patch;
    progress_.step(1);
  }

  // The nodes that are left get the numbers of a file, the source first; patches that ended in an exact node end in the
  // sink.
  void number() {
    std::vector<std::uint32_t> numbers(nodes_.size());
    const auto source = static_cast<std::uint32_t>(nodes_.size()) - 1;
    for (std::uint32_t i = source + 1; i-- > 0;) {
      if (i != source && isExact(i)) continue;
      const Node& node = nodes_[i];
      numbers[i] = static_cast<std::uint32_t>(dag_.nodes.size());
      patch_dag::NodeEntry& entry = dag_.nodes.emplace_back();
      entry = {};
      entry.level = node.level;
      entry.flags = node.flags;
      entry.error_estimated = node.error;
      entry.error_measured = i == kSink ? 0.0f : -1.0f;
      entry.bounds = i == kSink ? Bounds4f{} : node.bounds;
    }
    for (StoredPatch& patch : dag_.patches) {
      patch.upper = numbers[patch.upper];
      patch.lower = isExact(patch.lower) ? numbers[kSink] : numbers[patch.lower];
    }
    std::stable_sort(dag_.patches.begin(), dag_.patches.end(),
                     [](const StoredPatch& a, const StoredPatch& b) { return a.upper < b.upper; });
  }

  const hypermesh::File& file_;
  const Options& options_;
  outofcore::Executor& executor_;
  outofcore::Progress& progress_;
  qslim4d::Space space_;
  Lattice lattice_;
  CellRules rules_;
  LevelMesh mesh_;
  std::vector<Place> places_;  // of the level's tetrahedra
  std::vector<Node> nodes_;
  Dag dag_;
};

void checkInput(const hypermesh::File& file) {
  const hypermesh::MeshHeader& header = file.header();
  if (header.parts > 1)
    throw Error(FaultCode::kBadInput, file.reader().path(), "",
                "has " + std::to_string(header.parts) + " parts, but a patch DAG holds one surface",
                "extract each isovalue to a file of its own");
  if (header.vertices >= kSeveral || header.tets >= kSeveral)
    throw Error(FaultCode::kBadInput, file.reader().path(), "",
                "has " + std::to_string(header.vertices) + " vertices and " + std::to_string(header.tets) +
                    " tetrahedra, too many to partition in core (2^32 - 3)",
                "simplify it first with hyper-qslim");
}

}  // namespace

void checkOptions(const Options& options) {
  const auto refuse = [](const char* place, const std::string& what, const char* remedy) {
    throw Error(FaultCode::kUsage, "", place, what, remedy);
  };
  if (options.patch_tets < 1 || options.patch_tets > kMostPatchTets)
    refuse("--patch-tets", std::to_string(options.patch_tets) + " is not 1 to " + std::to_string(kMostPatchTets),
           "leave it out");
  if (options.cell_tets < options.patch_tets)
    refuse("--cell-tets", std::to_string(options.cell_tets) + " is less than --patch-tets", "leave it out");
  if (!std::isfinite(options.time_scale) || !(options.time_scale > 0))
    refuse("--time-scale", "is no number above 0", "leave it out: a frame counts as a cell");
}

std::uint64_t boundMemory(const hypermesh::File& file, const Options& options, std::size_t threads) {
  const hypermesh::MeshHeader& header = file.header();
  const double per_tet =
      static_cast<double>(header.vertices) / static_cast<double>(std::max<std::uint64_t>(1, header.tets));
  // A cell may be heavier than the mean, and half its vertices be others' too.
  const std::uint64_t cell = std::min(header.tets, 2 * options.cell_tets);
  const auto cell_vertices = static_cast<std::uint64_t>(2 * per_tet * static_cast<double>(cell)) + 4;
  const std::uint64_t cells =
      std::min<std::uint64_t>(threads, header.tets / std::max<std::uint64_t>(1, options.cell_tets) + 1);
  const std::uint64_t mesh =
      header.vertices * (sizeof(Vec4f) + 3 * 4 + 8) + header.tets * (2 * sizeof(Tet) + sizeof(Place) + 16 + 28 + 8);
  // Levels sum to about two and a half times the input, and vertices stand in several patches.
  const std::uint64_t patches = header.tets * 5 / 2 * (sizeof(patch_dag::LocalTet) + sizeof(Vec4f) / 2);
  return mesh + patches + cells * (qslim4d::simplifyBytes(cell_vertices, cell) + cell * 40);
}

Dag buildDag(const hypermesh::File& file, const Options& options, outofcore::Executor& executor,
             outofcore::MemoryBudget& memory, outofcore::Progress& progress) {
  checkOptions(options);
  checkInput(file);
  const auto held = memory.reserve(boundMemory(file, options, executor.threads()), "the mesh and its patches, in core");
  return Builder(file, options, executor, progress).build();
}

void writeDag(const Dag& dag, patch_dag::Writer& writer, outofcore::Progress& progress) {
  progress.phase("write", dag.patches.size());
  std::uint64_t done = 0;
  for (const StoredPatch& patch : dag.patches) {
    unwrap(writer.addPatch({patch.upper, patch.lower, patch.shared, patch.vertices, patch.tets, {}}));
    progress.step(++done);
  }
}

}  // namespace tet4d::vpartition

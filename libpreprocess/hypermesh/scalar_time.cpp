#include "libpreprocess/hypermesh/scalar_time.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/number_text.h"
#include "libpreprocess/hypermesh/crossing.h"

namespace tet4d::hypermesh {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Runs this close to each other are joined: a run takes as much as a vertex that is not used.
constexpr std::uint64_t kRunGap = 8;

[[noreturn]] void fail(const exchange::TetMesh& mesh, const std::string& place, const std::string& what,
                       const std::string& remedy) {
  throw Error(FaultCode::kBadInput, mesh.path, place, what, remedy);
}

}  // namespace

ScalarSweep::ScalarSweep(exchange::TetMesh mesh, std::uint64_t frames, outofcore::MemoryBudget& memory)
    : mesh_(std::move(mesh)) {
  if (mesh_.tets.size() >= kNone) fail(mesh_, "", "2^32 tetrahedra or more", "cut the mesh into parts");
  memory_ = memory.reserve(mesh_.points.size() * 21 + mesh_.tets.size() * 4, "the order of vertices and tetrahedra");
  checkTets();
  setTimes(frames);
  setMap();
  countShared();
  orientation_ = orientTets(mesh_.points, mesh_.tets, mesh_.path, memory);
  header_.flags = kInnerBoundary;
  header_.isovalue = std::numeric_limits<double>::quiet_NaN();
  const auto pages = static_cast<std::size_t>(frames - 1);
  sortTets(pages);
  numberVertices(pages);
  for (const std::uint32_t vertex : order_) header_.domain.add(positionOf(vertex));
  header_.domain.min.t = 0;
  header_.domain.max.t = static_cast<float>(frames - 1);
}

void ScalarSweep::checkTets() const {
  for (std::size_t i = 0; i < mesh_.tets.size(); ++i) {
    const auto& [a, b, c, d] = mesh_.tets[i];
    if (a != b && a != c && a != d && b != c && b != d && c != d) continue;
    fail(mesh_, "tetrahedron " + std::to_string(i), "names a vertex twice", "remove such tetrahedra");
  }
}

void ScalarSweep::setTimes(std::uint64_t frames) {
  if (frames < 2 || frames - 1 > kMaxIndex) {
    throw Error(FaultCode::kUsage, "", "option --sweep-frames", std::to_string(frames) + " frames",
                "give 2 to " + std::to_string(kMaxIndex + 1));
  }
  used_.assign(mesh_.points.size(), 0);
  for (const auto& tet : mesh_.tets) {
    for (const std::uint32_t vertex : tet) used_[vertex] = 1;
  }
  double min = std::numeric_limits<double>::infinity(), max = -min;
  for (std::size_t i = 0; i < used_.size(); ++i) {
    if (used_[i] == 0) continue;
    const double s = mesh_.scalar[i];
    if (!std::isfinite(s)) {
      fail(mesh_, "vertex " + std::to_string(i), "its scalar is " + exchange::numberText(s),
           "give every vertex a finite value, or remove the tetrahedra around it");
    }
    min = std::min(min, s), max = std::max(max, s);
  }
  if (min == max) {
    fail(mesh_, "", "the scalar is " + exchange::numberText(min) + " at every vertex, there is nothing to sweep",
         "choose another scalar");
  }
  const double steps = static_cast<double>(frames - 1);
  for (std::uint64_t k = 0; k < frames; ++k) {
    const double part = static_cast<double>(k) / steps;
    // Halves, so that a range beyond the largest double does not overflow.
    times_.push_back(k == 0 ? min : k + 1 == frames ? max : 2 * (min / 2 + part * (max / 2 - min / 2)));
    if (k == 0 || (times_[k] > times_[k - 1] && (times_[k] < max || k + 1 == frames))) continue;
    fail(mesh_, "",
         "the scalar's range, " + exchange::numberText(min) + " to " + exchange::numberText(max) + ", does not hold " +
             std::to_string(frames) + " numbers",
         "give fewer --sweep-frames");
  }
}

// World coordinates as they are if float32 holds them all; otherwise from the middle of the mesh, scaled by a power of
// two.
void ScalarSweep::setMap() {
  bool fits = true;
  std::array<double, 3> low, high;
  low.fill(std::numeric_limits<double>::infinity()), high.fill(-std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < used_.size(); ++i) {
    if (used_[i] == 0) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const double x = mesh_.points[i][c];
      fits = fits && static_cast<double>(static_cast<float>(x)) == x;
      low[c] = std::min(low[c], x), high[c] = std::max(high[c], x);
    }
  }
  if (fits) return;
  double half = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    header_.index_to_world.origin[c] = low[c] / 2 + high[c] / 2;
    half = std::max(half, high[c] / 2 - low[c] / 2);
  }
  // A mesh in one point keeps a scale of 1.
  const double scale = half > 0 ? std::ldexp(1.0, std::clamp(std::ilogb(half), -300, 300)) : 1.0;
  for (std::size_t c = 0; c < 3; ++c) header_.index_to_world.axes[c][c] = scale;
}

float ScalarSweep::frameOf(std::uint32_t vertex) const {
  const double min = times_.front(), max = times_.back(), steps = static_cast<double>(times_.size() - 1);
  const double range = max - min;
  const double s = mesh_.scalar[vertex];
  const double part = std::isfinite(range) ? (s - min) / range : (s / 2 - min / 2) / (max / 2 - min / 2);
  return static_cast<float>(part * steps);
}

Vec4f ScalarSweep::positionOf(std::uint32_t vertex) const {
  const AffineMap& map = header_.index_to_world;
  const auto& p = mesh_.points[vertex];
  const auto along = [&](std::size_t c) { return static_cast<float>((p[c] - map.origin[c]) / map.axes[c][c]); };
  return {along(0), along(1), along(2), frameOf(vertex)};
}

void ScalarSweep::countShared() {
  std::vector<std::uint32_t> sorted;
  for (std::uint32_t i = 0; i < used_.size(); ++i) {
    if (used_[i] != 0) sorted.push_back(i);
  }
  std::sort(sorted.begin(), sorted.end(),
            [&](std::uint32_t a, std::uint32_t b) { return mesh_.scalar[a] < mesh_.scalar[b]; });
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    shared_frames_ +=
        mesh_.scalar[sorted[i]] != mesh_.scalar[sorted[i - 1]] && frameOf(sorted[i]) == frameOf(sorted[i - 1]);
  }
}

std::size_t ScalarSweep::pageOf(std::size_t tet) const {
  float least = std::numeric_limits<float>::infinity();
  for (const std::uint32_t vertex : mesh_.tets[tet]) least = std::min(least, frameOf(vertex));
  return std::min(static_cast<std::size_t>(least), times_.size() - 2);
}

// Counting sort: the tetrahedra of a page keep the mesh's order.
void ScalarSweep::sortTets(std::size_t pages) {
  page_tets_.assign(pages + 1, 0);
  for (std::size_t i = 0; i < mesh_.tets.size(); ++i) ++page_tets_[pageOf(i) + 1];
  std::partial_sum(page_tets_.begin(), page_tets_.end(), page_tets_.begin());
  std::vector<std::uint64_t> next(page_tets_.begin(), page_tets_.end() - 1);
  tet_order_.resize(mesh_.tets.size());
  for (std::size_t i = 0; i < mesh_.tets.size(); ++i) {
    tet_order_[static_cast<std::size_t>(next[pageOf(i)]++)] = static_cast<std::uint32_t>(i);
  }
}

// Vertices by owner, then by the last page that uses them: what a later page needs of an owner lies close together.
void ScalarSweep::numberVertices(std::size_t pages) {
  owner_.assign(mesh_.points.size(), kNone);
  last_.assign(mesh_.points.size(), 0);
  for (std::uint32_t page = 0; page < pages; ++page) {
    for (std::uint64_t i = page_tets_[page]; i < page_tets_[page + 1]; ++i) {
      for (const std::uint32_t vertex : mesh_.tets[tet_order_[static_cast<std::size_t>(i)]]) {
        owner_[vertex] = std::min(owner_[vertex], page);
        last_[vertex] = page;
      }
    }
  }
  for (std::uint32_t i = 0; i < used_.size(); ++i) {
    if (used_[i] != 0) order_.push_back(i);
  }
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (owner_[a] != owner_[b]) return owner_[a] < owner_[b];
    return last_[a] != last_[b] ? last_[a] < last_[b] : a < b;
  });
  number_.assign(mesh_.points.size(), kNone);
  page_vertices_.assign(pages + 1, 0);
  for (std::size_t i = 0; i < order_.size(); ++i) {
    number_[order_[i]] = static_cast<std::uint32_t>(i);
    ++page_vertices_[owner_[order_[i]] + 1];
  }
  std::partial_sum(page_vertices_.begin(), page_vertices_.end(), page_vertices_.begin());
}

void ScalarSweep::writePage(std::size_t page, Writer& writer) const {
  const std::uint64_t first = page_vertices_[page], owned = page_vertices_[page + 1] - first;
  const auto mine = std::span(tet_order_)
                        .subspan(static_cast<std::size_t>(page_tets_[page]),
                                 static_cast<std::size_t>(page_tets_[page + 1] - page_tets_[page]));
  std::vector<Vec4f> vertices;
  for (std::uint64_t i = first; i < first + owned; ++i) vertices.push_back(positionOf(order_[i]));
  std::vector<std::uint64_t> foreign;
  Bounds4f bounds;
  for (const std::uint32_t tet : mine) {
    for (const std::uint32_t vertex : mesh_.tets[tet]) {
      bounds.add(positionOf(vertex));
      if (number_[vertex] < first) foreign.push_back(number_[vertex]);
    }
  }
  std::sort(foreign.begin(), foreign.end());
  std::vector<Run> runs;
  for (const std::uint64_t number : foreign) {
    if (!runs.empty() && number <= runs.back().first + runs.back().count + kRunGap) {
      runs.back().count = std::max(runs.back().count, number + 1 - runs.back().first);
    } else {
      runs.push_back({number, 1});
    }
  }
  std::vector<std::uint64_t> local_begins;  // of each run among the local indices
  std::uint64_t locals = owned;
  for (const Run& run : runs) {
    local_begins.push_back(locals);
    locals += run.count;
  }
  const auto localOf = [&](std::uint64_t number) {
    if (number >= first) return static_cast<std::uint32_t>(number - first);
    const auto run =
        std::upper_bound(runs.begin(), runs.end(), number, [](std::uint64_t n, const Run& r) { return n < r.first; }) -
        1;
    return static_cast<std::uint32_t>(local_begins[static_cast<std::size_t>(run - runs.begin())] + number - run->first);
  };
  std::vector<Tet> tets;
  for (const std::uint32_t tet : mine) {
    Tet local{};
    for (std::size_t c = 0; c < 4; ++c) local[c] = localOf(number_[mesh_.tets[tet][c]]);
    tets.push_back(local);
  }
  if (tets.empty()) {  // an empty step keeps its rank
    bounds = {};
    bounds.add(Vec4f{0, 0, 0, static_cast<float>(page)});
  }
  unwrap(writer.addPage(vertices, runs, tets, bounds));
}

void ScalarSweep::write(Writer& writer, outofcore::Progress& progress) {
  const std::size_t pages = page_tets_.size() - 1;
  progress.phase("write", pages);
  for (std::size_t page = 0; page < pages; ++page) {
    writePage(page, writer);
    progress.step(page + 1);
  }
}

}  // namespace tet4d::hypermesh

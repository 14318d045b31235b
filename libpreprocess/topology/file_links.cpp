// The link test of a file, streamed.
#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "libpreprocess/error.h"
#include "libpreprocess/topology/link_judge.h"
#include "libpreprocess/topology/links.h"
#include "libpreprocess/topology/vertex_reach.h"

namespace tet4d::topology {
namespace {

using hypermesh::Tet;

bool onWall(const Vec4f& v, const Bounds4f& domain) {
  return v.x == domain.min.x || v.x == domain.max.x || v.y == domain.min.y || v.y == domain.max.y ||
         v.z == domain.min.z || v.z == domain.max.z || v.t == domain.min.t || v.t == domain.max.t;
}

class FileLinks {
 public:
  FileLinks(const hypermesh::File& file, outofcore::MemoryBudget& memory, outofcore::Progress& progress)
      : file_(file), memory_(memory), reach_(file, progress, &memory) {
    const std::uint32_t flags = file.header().flags;
    anywhere_ = (flags & hypermesh::kOnGrid) == 0 || (flags & hypermesh::kInnerBoundary) != 0;
    progress.phase("links", file.geometryPages());
    for (std::size_t k = 0; k < file.geometryPages(); ++k) {
      checkPage(k);
      progress.step(k + 1);
    }
  }

  LinkCheck result() {
    LinkCheck check = judge_.result(file_.header().vertices);
    check.most_open = most_open_;
    return check;
  }

 private:
  // A triangle of the link of a vertex that later pages may still add to.
  struct Open {
    std::uint64_t vertex;
    LinkTriangle triangle;
    friend bool operator<(const Open& a, const Open& b) { return a.vertex < b.vertex; }
  };

  void checkPage(std::size_t k) {
    const auto& counts = file_.geometryEntry(k).counts;
    const std::uint64_t locals = counts[1] + counts[3];
    const auto held = memory_.reserve(
        file_.gatherBytes(k) + locals * 2 * sizeof(std::uint64_t) + counts[2] * 4 * sizeof(std::uint32_t),
        "a page and the tetrahedra at each of its vertices");
    const hypermesh::GatheredPage page = unwrap(file_.gather(k));
    numberLocals(page.view);
    collectStars(page.view.tets);
    // Vertices that this page uses last are final: what is carried of them and what is here is all there is.
    std::uint64_t opening = 0;
    for (std::size_t i = 0; i < globals_.size(); ++i) {
      const Reach reach = reach_.of(globals_[i]);
      if (reach.last > k) {
        opening += starOf(i).size();
        continue;
      }
      link_.clear();
      if (reach.first < k) takeOpen(globals_[i]);
      addStar(i, page.view.tets);
      if (!link_.empty())
        judge_.judge(globals_[i], link_, anywhere_ || onWall(page.positions[i], file_.header().domain));
    }
    std::erase_if(open_, [&](const Open& open) { return reach_.of(open.vertex).last <= k; });
    carryOn(k, opening, page.view.tets);
  }

  void numberLocals(const hypermesh::PageView& page) {
    globals_.resize(page.header->owned);
    std::iota(globals_.begin(), globals_.end(), page.header->first_vertex);
    for (const hypermesh::Run& run : page.runs) {
      for (std::uint64_t i = 0; i < run.count; ++i) globals_.push_back(run.first + i);
    }
  }

  // The page's tetrahedra at each local vertex: tets_ from where the vertex before ends to ends_[vertex].
  void collectStars(std::span<const Tet> tets) {
    ends_.assign(globals_.size() + 1, 0);
    for (const Tet& tet : tets) {
      for (const std::uint32_t v : tet) ++ends_[v + 1];
    }
    std::partial_sum(ends_.begin(), ends_.end(), ends_.begin());
    tets_.resize(ends_.back());
    for (std::size_t i = 0; i < tets.size(); ++i) {
      for (const std::uint32_t v : tets[i]) tets_[ends_[v]++] = static_cast<std::uint32_t>(i);
    }
    ends_.pop_back();
  }
  std::span<const std::uint32_t> starOf(std::size_t local) const {
    const std::uint64_t begin = local == 0 ? 0 : ends_[local - 1];
    return {tets_.data() + begin, static_cast<std::size_t>(ends_[local] - begin)};
  }

  LinkTriangle opposite(const Tet& tet, std::size_t local) const {
    LinkTriangle triangle{};
    std::size_t c = 0;
    for (const std::uint32_t w : tet) {
      if (w != local) triangle[c++] = globals_[w];
    }
    return triangle;
  }
  void addStar(std::size_t local, std::span<const Tet> tets) {
    for (const std::uint32_t i : starOf(local)) link_.push_back(opposite(tets[i], local));
  }
  void takeOpen(std::uint64_t vertex) {
    const auto [begin, end] = std::equal_range(open_.begin(), open_.end(), Open{vertex, {}});
    for (auto open = begin; open != end; ++open) link_.push_back(open->triangle);
  }

  // Adds the page's triangles at vertices that later pages use, `count` of them, to the front.
  void carryOn(std::size_t k, std::uint64_t count, std::span<const Tet> tets) {
    const std::uint64_t needed = open_.size() + count;
    most_open_ = std::max(most_open_, needed);
    if (needed > open_.capacity()) {
      // Beside the old front, which is there until it is copied.
      auto grown =
          memory_.reserve(needed * sizeof(Open), "the open front of the link test after page " + std::to_string(k));
      open_.reserve(needed);
      front_ = std::move(grown);
    }
    for (std::size_t i = 0; i < globals_.size(); ++i) {
      if (reach_.of(globals_[i]).last <= k) continue;
      for (const std::uint32_t tet : starOf(i)) open_.push_back({globals_[i], opposite(tets[tet], i)});
    }
    std::sort(open_.begin(), open_.end());
  }

  const hypermesh::File& file_;
  outofcore::MemoryBudget& memory_;
  VertexReach reach_;
  LinkJudge judge_;
  bool anywhere_ = false;  // boundary is legal everywhere
  // Of the page at hand, by local number:
  std::vector<std::uint64_t> globals_, ends_;
  std::vector<std::uint32_t> tets_;
  std::vector<LinkTriangle> link_;  // of the vertex at hand
  // Across pages, by vertex:
  std::vector<Open> open_;
  outofcore::MemoryBudget::Reservation front_;
  std::uint64_t most_open_ = 0;
};

}  // namespace

LinkCheck checkLinks(const hypermesh::File& file, outofcore::MemoryBudget& memory, outofcore::Progress& progress) {
  return FileLinks(file, memory, progress).result();
}

}  // namespace tet4d::topology

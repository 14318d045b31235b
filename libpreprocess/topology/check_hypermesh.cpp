#include "libpreprocess/topology/check_hypermesh.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/topology/vertex_reach.h"

namespace tet4d::topology {
namespace {

using hypermesh::Tet;

constexpr std::size_t kFaultsInWords = 3;  // of each kind

// One bit a wall of the domain a vertex lies on; a face lies on a wall if its vertices share a bit.
std::uint8_t wallsOf(const Vec4f& v, const Bounds4f& domain) {
  const std::array<bool, 8> on{v.x == domain.min.x, v.x == domain.max.x, v.y == domain.min.y, v.y == domain.max.y,
                               v.z == domain.min.z, v.z == domain.max.z, v.t == domain.min.t, v.t == domain.max.t};
  unsigned bits = 0;
  for (std::size_t i = 0; i < on.size(); ++i) bits |= static_cast<unsigned>(on[i]) << i;
  return static_cast<std::uint8_t>(bits);
}

// A face as the tetrahedra met so far use it.
struct Face {
  std::array<std::uint64_t, 3> vertices;  // global, ascending
  std::uint64_t uses;                     // tetrahedra
  std::int64_t turn;                      // sum of the induced orientations of the ascending triple: +1 or -1 each
  std::uint64_t page, tet;                // of its first use
  std::uint8_t walls;
};

// A face of one page, in the bucket of its smallest local vertex.
struct LocalFace {
  std::uint32_t middle, largest;
  std::uint64_t tet_and_turn;  // 2 * tet, plus 1 if the induced orientation is that of the ascending triple
};

// The corners of the face opposite to each vertex, in induced orientation: (-1)^i (v0 .. without vi .. v3).
constexpr std::array<std::array<std::uint8_t, 3>, 4> kFaceCorners{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

// Sorts three numbers ascending; true if the permutation is even.
bool sortEven(std::array<std::uint32_t, 3>& v) {
  bool even = true;
  const auto order = [&](std::size_t i, std::size_t j) {
    if (v[j] < v[i]) std::swap(v[i], v[j]), even = !even;
  };
  order(0, 1), order(1, 2), order(0, 1);
  return even;
}

// Whether any 3x3 minor of the three edges is not zero. Differences of f32 are exact enough in double that vertices
// that coincide give exactly zero.
bool hasVolume(const std::array<Vec4f, 4>& v) {
  std::array<std::array<double, 4>, 3> edges;
  for (std::size_t i = 0; i < 3; ++i) {
    edges[i] = {double{v[i + 1].x} - v[0].x, double{v[i + 1].y} - v[0].y, double{v[i + 1].z} - v[0].z,
                double{v[i + 1].t} - v[0].t};
  }
  for (const auto& [i, j, k] : {std::array{0u, 1u, 2u}, {0u, 1u, 3u}, {0u, 2u, 3u}, {1u, 2u, 3u}}) {
    const auto& [p, q, r] = edges;
    const double minor =
        p[i] * (q[j] * r[k] - q[k] * r[j]) - p[j] * (q[i] * r[k] - q[k] * r[i]) + p[k] * (q[i] * r[j] - q[j] * r[i]);
    if (minor != 0) return true;
  }
  return false;
}

class Checker {
 public:
  Checker(const hypermesh::File& file, outofcore::Progress& progress, outofcore::MemoryBudget* memory)
      : file_(file), memory_(memory), reach_(file, progress, memory) {
    progress.phase("faces", file.geometryPages());
    for (std::size_t k = 0; k < file.geometryPages(); ++k) {
      checkPage(k);
      progress.step(k + 1);
    }
  }

  HypermeshCheck result() {
    check_.vertices = file_.header().vertices;
    check_.tets = file_.header().tets;
    return std::move(check_);
  }

 private:
  void checkPage(std::size_t k) {
    page_ = k;
    outofcore::MemoryBudget::Reservation held;
    if (memory_ != nullptr) {
      const auto& counts = file_.geometryEntry(k).counts;
      // Number, bucket, walls and marks of a vertex; four faces of a tetrahedron.
      held = memory_->reserve(file_.gatherBytes(k) + (counts[1] + counts[3]) * 20 + counts[2] * 4 * sizeof(LocalFace),
                              "a page and the faces of its tetrahedra");
    }
    const hypermesh::GatheredPage page = unwrap(file_.gather(k));
    numberLocals(page.view);
    walls_.resize(globals_.size());
    for (std::size_t i = 0; i < walls_.size(); ++i) walls_[i] = wallsOf(page.positions[i], file_.header().domain);
    lookAtTets(page);
    bucketFaces(page.view.tets);
    matchInPage();
    matchAcrossPages();
    countUnused(page.view.header->owned);
  }

  // Global numbers of the page's locals, no two alike, and whether other pages use them.
  void numberLocals(const hypermesh::PageView& page) {
    globals_.resize(page.header->owned);
    std::iota(globals_.begin(), globals_.end(), page.header->first_vertex);
    for (const hypermesh::Run& run : page.runs) {
      for (std::uint64_t i = 0; i < run.count; ++i) globals_.push_back(run.first + i);
    }
    shared_.resize(globals_.size());
    for (std::size_t i = 0; i < globals_.size(); ++i) {
      const Reach reach = reach_.of(globals_[i]);
      shared_[i] = reach.first != reach.last;
    }
  }

  // What a tetrahedron shows on its own.
  void lookAtTets(const hypermesh::GatheredPage& page) {
    used_.assign(globals_.size(), false);
    for (std::size_t i = 0; i < page.view.tets.size(); ++i) {
      std::array<Vec4f, 4> corners;
      for (std::size_t c = 0; c < 4; ++c) {
        used_[page.view.tets[i][c]] = true;
        corners[c] = page.positions[page.view.tets[i][c]];
      }
      if (!hasVolume(corners)) ++check_.degenerate_tets;
      const bool flat =
          std::all_of(corners.begin(), corners.end(), [&](const Vec4f& v) { return v.t == corners[0].t; });
      if (flat) ++check_.flat_time_tets;
    }
  }

  void bucketFaces(std::span<const Tet> tets) {
    bucket_ends_.assign(globals_.size() + 1, 0);
    const auto eachFace = [&](auto&& visit) {
      for (std::size_t i = 0; i < tets.size(); ++i) {
        const Tet& tet = tets[i];
        for (const auto& corners : kFaceCorners) {
          std::array<std::uint32_t, 3> v{tet[corners[0]], tet[corners[1]], tet[corners[2]]};
          const bool even = sortEven(v);
          visit(v, 2 * static_cast<std::uint64_t>(i) + (even ? 1 : 0));
        }
      }
    };
    eachFace([&](const auto& v, std::uint64_t) { ++bucket_ends_[v[0] + 1]; });
    std::partial_sum(bucket_ends_.begin(), bucket_ends_.end(), bucket_ends_.begin());
    local_faces_.resize(bucket_ends_.back());
    // bucket_ends_[v] is where bucket v begins; filling moves it to where the bucket ends.
    eachFace([&](const auto& v, std::uint64_t tet_and_turn) {
      local_faces_[bucket_ends_[v[0]]++] = {v[1], v[2], tet_and_turn};
    });
    bucket_ends_.pop_back();
  }

  // Groups equal faces. Those with a vertex that no other page uses are final; the others go to shared_faces_.
  void matchInPage() {
    shared_faces_.clear();
    std::size_t begin = 0;
    for (std::uint32_t smallest = 0; smallest < bucket_ends_.size(); ++smallest) {
      const std::size_t end = bucket_ends_[smallest];
      const std::span<LocalFace> bucket(local_faces_.data() + begin, end - begin);
      begin = end;
      std::sort(bucket.begin(), bucket.end(), [](const LocalFace& a, const LocalFace& b) {
        return std::pair(a.middle, a.largest) != std::pair(b.middle, b.largest)
                   ? std::pair(a.middle, a.largest) < std::pair(b.middle, b.largest)
                   : a.tet_and_turn < b.tet_and_turn;
      });
      for (std::size_t i = 0; i < bucket.size();) {
        const std::uint32_t middle = bucket[i].middle, largest = bucket[i].largest;
        Face face{{smallest, middle, largest}, 0, 0, page_, bucket[i].tet_and_turn / 2, 0};
        for (; i < bucket.size() && bucket[i].middle == middle && bucket[i].largest == largest; ++i) {
          ++face.uses;
          face.turn += bucket[i].tet_and_turn % 2 != 0 ? 1 : -1;
        }
        finishFace(face, {smallest, middle, largest});
      }
    }
  }

  void finishFace(Face& face, const std::array<std::uint32_t, 3>& local) {
    face.walls = static_cast<std::uint8_t>(walls_[local[0]] & walls_[local[1]] & walls_[local[2]]);
    std::array<std::uint32_t, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return globals_[local[a]] < globals_[local[b]]; });
    if (std::array<std::uint32_t, 3> sorted = order; !sortEven(sorted)) face.turn = -face.turn;
    for (std::size_t c = 0; c < 3; ++c) face.vertices[c] = globals_[local[order[c]]];
    if (shared_[local[0]] && shared_[local[1]] && shared_[local[2]]) {
      shared_faces_.push_back(face);
    } else {
      judge(face);
    }
  }

  // Merges the page's shared faces with those carried from earlier pages; carries on what a later page can still meet.
  void matchAcrossPages() {
    if (memory_ != nullptr) {
      // Both fronts and their merger.
      front_ = {};
      front_ = memory_->reserve(2 * (carried_.size() + shared_faces_.size()) * sizeof(Face),
                                "the open front of the face test after page " + std::to_string(page_));
    }
    const auto before = [](const Face& a, const Face& b) { return a.vertices < b.vertices; };
    std::sort(shared_faces_.begin(), shared_faces_.end(), before);
    std::vector<Face> merged;
    merged.reserve(carried_.size() + shared_faces_.size());
    // Carried faces come first among equals: their place is that of the first use.
    std::merge(carried_.begin(), carried_.end(), shared_faces_.begin(), shared_faces_.end(), std::back_inserter(merged),
               before);
    carried_.clear();
    for (std::size_t i = 0; i < merged.size(); ++i) {
      Face face = merged[i];
      if (i + 1 < merged.size() && merged[i + 1].vertices == face.vertices) {
        face.uses += merged[i + 1].uses;
        face.turn += merged[i + 1].turn;
        ++i;
      }
      const bool open =
          std::all_of(face.vertices.begin(), face.vertices.end(), [&](auto v) { return reach_.of(v).last > page_; });
      if (open) {
        carried_.push_back(face);
      } else {
        judge(face);
      }
    }
    check_.most_open_faces = std::max<std::uint64_t>(check_.most_open_faces, carried_.size());
  }

  // A face that no later page can meet.
  void judge(const Face& face) {
    const auto what = [&](const std::string& text) {
      return place(face.page, face.tet) + ": triangle " + numbers(face.vertices) + " " + text;
    };
    if (face.uses > 2) {
      return fault(check_.faces_over_two, what("lies in " + std::to_string(face.uses) + " tetrahedra"));
    }
    if (face.uses == 2) {
      ++check_.inner_faces;
      if (face.turn != 0) fault(check_.misoriented_faces, what("has two tetrahedra of opposite orientation"));
      return;
    }
    if (face.walls != 0) {
      ++check_.wall_faces;
      return;
    }
    const std::uint32_t flags = file_.header().flags;
    if ((flags & hypermesh::kOnGrid) == 0 || (flags & hypermesh::kInnerBoundary) != 0) {
      ++check_.inner_boundary_faces;
    } else {
      fault(check_.inner_boundary_faces, what("lies in one tetrahedron, but on no wall of the domain"));
    }
  }

  // Vertices of one owner may be used by several pages: marks wait until the last of them has passed.
  void countUnused(std::uint64_t owned) {
    const std::uint64_t own_first = reach_.firstVertexOf(page_);
    if (owned != 0) marks_.try_emplace(page_, owned, false);
    for (std::size_t i = 0; i < used_.size(); ++i) {
      const std::uint64_t owner = i < owned ? page_ : reach_.ownerOf(globals_[i]);
      const std::uint64_t first = i < owned ? own_first : reach_.firstVertexOf(owner);
      auto mark = marks_.find(owner);
      if (mark == marks_.end()) {
        mark = marks_.try_emplace(owner, file_.geometryEntry(owner).counts[1], false).first;
      }
      if (used_[i]) mark->second[globals_[i] - first] = true;
    }
    for (auto mark = marks_.begin(); mark != marks_.end();) {
      if (reach_.lastUseOfOwner(mark->first) > page_) {
        ++mark;
        continue;
      }
      check_.unused_vertices += static_cast<std::uint64_t>(std::count(mark->second.begin(), mark->second.end(), false));
      mark = marks_.erase(mark);
    }
  }

  void fault(std::uint64_t& count, std::string words) {
    if (count++ < kFaultsInWords) check_.faults.push_back(std::move(words));
  }
  static std::string place(std::uint64_t page, std::uint64_t tet) {
    return "page " + std::to_string(page) + ", tetrahedron " + std::to_string(tet);
  }
  template <std::size_t n>
  static std::string numbers(const std::array<std::uint64_t, n>& vertices) {
    std::string text;
    for (const std::uint64_t v : vertices) text += (text.empty() ? "(" : ", ") + std::to_string(v);
    return text + ")";
  }

  const hypermesh::File& file_;
  outofcore::MemoryBudget* memory_;  // or null
  VertexReach reach_;
  HypermeshCheck check_;
  std::uint64_t page_ = 0;
  // Of the page at hand, by local number:
  std::vector<std::uint64_t> globals_;
  std::vector<bool> shared_, used_;
  std::vector<std::uint8_t> walls_;
  std::vector<std::size_t> bucket_ends_;
  std::vector<LocalFace> local_faces_;
  // Across pages:
  std::vector<Face> shared_faces_, carried_;
  outofcore::MemoryBudget::Reservation front_;
  std::map<std::uint64_t, std::vector<bool>> marks_;  // used vertices, by owner
};

}  // namespace

HypermeshCheck checkHypermesh(const hypermesh::File& file, outofcore::Progress& progress,
                              outofcore::MemoryBudget* memory) {
  return Checker(file, progress, memory).result();
}

}  // namespace tet4d::topology

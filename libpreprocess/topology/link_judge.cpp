#include "libpreprocess/topology/link_judge.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace tet4d::topology {
namespace {

constexpr std::size_t kFaultsInWords = 3;  // of each kind
constexpr std::uint64_t kVertexItself = std::numeric_limits<std::uint64_t>::max();

// Groups of numbers that hang together.
class Groups {
 public:
  void reset(std::size_t count) {
    parent_.resize(count);
    std::iota(parent_.begin(), parent_.end(), 0u);
    groups_ = count;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = rootOf(a), b = rootOf(b);
    if (a != b) parent_[a] = b, --groups_;
  }
  std::size_t count() const { return groups_; }

 private:
  std::uint32_t rootOf(std::uint32_t a) {
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }
  std::vector<std::uint32_t> parent_;
  std::size_t groups_ = 0;
};

}  // namespace

// The link of one vertex. Buffers are kept from vertex to vertex.
class LinkJudge::VertexLink {
 public:
  enum class Shape { kSphere, kDisc, kFaulty };
  enum class EdgeShape { kCycle, kPath, kFaulty };

  // triangles: of the link, global numbers; not empty.
  void build(std::span<LinkTriangle> triangles) {
    names_.clear();
    for (LinkTriangle& triangle : triangles) {
      std::sort(triangle.begin(), triangle.end());
      names_.insert(names_.end(), triangle.begin(), triangle.end());
    }
    std::sort(names_.begin(), names_.end());
    names_.erase(std::unique(names_.begin(), names_.end()), names_.end());
    std::sort(triangles.begin(), triangles.end());
    twice_ = std::adjacent_find(triangles.begin(), triangles.end()) != triangles.end();
    triangles_ = triangles.size();

    // corners_[v]: the edges opposite to link vertex v in its triangles, as pairs of local numbers.
    if (corners_.size() < names_.size()) corners_.resize(names_.size());
    for (std::size_t i = 0; i < names_.size(); ++i) corners_[i].clear();
    sides_.clear();
    for (const LinkTriangle& triangle : triangles) {
      std::array<std::uint32_t, 3> local;
      for (std::size_t c = 0; c < 3; ++c) {
        local[c] =
            static_cast<std::uint32_t>(std::lower_bound(names_.begin(), names_.end(), triangle[c]) - names_.begin());
      }
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t a = local[(c + 1) % 3], b = local[(c + 2) % 3];
        corners_[local[c]].push_back({a, b});
        sides_.emplace_back(std::min(a, b), std::max(a, b));
      }
    }
    std::sort(sides_.begin(), sides_.end());
  }

  std::span<const std::uint64_t> names() const { return names_; }

  // The whole link; `around` must be filled.
  Shape shape() {
    std::size_t edges = 0;
    bool closed = true;
    for (std::size_t i = 0; i < sides_.size();) {
      std::size_t uses = 0;
      const auto side = sides_[i];
      for (; i < sides_.size() && sides_[i] == side; ++i) ++uses;
      if (uses > 2) return Shape::kFaulty;
      closed &= uses == 2;
      ++edges;
    }
    groups_.reset(names_.size());
    for (const auto& [a, b] : sides_) groups_.join(a, b);
    const bool surface = std::none_of(around.begin(), around.end(), [](auto s) { return s == EdgeShape::kFaulty; });
    if (twice_ || !surface || groups_.count() != 1) return Shape::kFaulty;
    const auto euler = static_cast<std::ptrdiff_t>(names_.size() + triangles_) - static_cast<std::ptrdiff_t>(edges);
    if (closed && euler == 2) return Shape::kSphere;
    return !closed && euler == 1 ? Shape::kDisc : Shape::kFaulty;
  }

  // The link of the edge from the vertex to its link's vertex `local`: the graph of the opposite edges.
  EdgeShape edgeShape(std::size_t local) {
    const auto& opposite = corners_[local];
    ends_.clear();
    for (const auto& [a, b] : opposite) ends_.push_back(a), ends_.push_back(b);
    std::sort(ends_.begin(), ends_.end());
    std::size_t single = 0;
    nodes_.clear();
    for (std::size_t i = 0; i < ends_.size();) {
      const std::size_t begin = i;
      nodes_.push_back(ends_[i]);
      while (i < ends_.size() && ends_[i] == nodes_.back()) ++i;
      if (i - begin > 2) return EdgeShape::kFaulty;
      single += i - begin == 1 ? 1 : 0;
    }
    groups_.reset(nodes_.size());
    const auto nodeOf = [&](std::uint32_t v) {
      return static_cast<std::uint32_t>(std::lower_bound(nodes_.begin(), nodes_.end(), v) - nodes_.begin());
    };
    for (const auto& [a, b] : opposite) groups_.join(nodeOf(a), nodeOf(b));
    // Every node has degree 1 or 2; if they hang together there are two ends or none. A cycle of two is a tetrahedron
    // that is there twice.
    if (groups_.count() != 1 || (single == 0 && nodes_.size() < 3)) return EdgeShape::kFaulty;
    return single == 0 ? EdgeShape::kCycle : EdgeShape::kPath;
  }

  std::vector<EdgeShape> around;  // edgeShape() of each of its vertices, by rank in names()

 private:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<std::uint64_t> names_;
  std::vector<std::uint32_t> ends_, nodes_;
  std::vector<std::vector<Pair>> corners_;
  std::vector<Pair> sides_;
  std::size_t triangles_ = 0;
  bool twice_ = false;
  Groups groups_;
};

LinkJudge::LinkJudge() : link_(std::make_unique<VertexLink>()) {}
LinkJudge::~LinkJudge() = default;

void LinkJudge::keep(std::vector<Found>& found, std::uint64_t vertex, std::uint64_t other, const char* what) {
  const auto key = [](const Found& f) { return std::pair(f.vertex, f.other); };
  const std::pair mine(vertex, other);
  if (found.size() == kFaultsInWords && key(found.back()) < mine) return;
  const auto place =
      std::find_if(found.begin(), found.end(), [&](const Found& f) { return mine < std::pair(f.vertex, f.other); });
  const std::string name = other == kVertexItself
                               ? "vertex " + std::to_string(vertex)
                               : "edge (" + std::to_string(vertex) + ", " + std::to_string(other) + ")";
  found.insert(place, {vertex, other, name + ": its link is " + what});
  if (found.size() > kFaultsInWords) found.pop_back();
}

void LinkJudge::degenerate(std::uint64_t tet) {
  if (check_.degenerate_tets++ < kFaultsInWords) {
    check_.faults.push_back("tetrahedron " + std::to_string(tet) + " names a vertex twice");
  }
}

void LinkJudge::judge(std::uint64_t v, std::span<LinkTriangle> link, bool may_bound) {
  using EdgeShape = VertexLink::EdgeShape;
  ++check_.vertices;
  check_.largest_star = std::max<std::uint64_t>(check_.largest_star, link.size());
  link_->build(link);
  link_->around.clear();
  for (std::size_t w = 0; w < link_->names().size(); ++w) {
    link_->around.push_back(link_->edgeShape(w));
    if (link_->names()[w] < v) continue;  // an edge is counted at its smaller end
    ++check_.edges;
    switch (link_->around.back()) {
      case EdgeShape::kCycle:
        ++check_.cycle_edges;
        break;
      case EdgeShape::kPath:
        ++check_.path_edges;
        break;
      case EdgeShape::kFaulty:
        ++check_.faulty_edges;
        keep(edges_, v, link_->names()[w], "neither one cycle nor one path");
    }
  }
  const auto bad = [&](const char* what) {
    ++check_.faulty_vertices;
    keep(vertices_, v, kVertexItself, what);
  };
  switch (link_->shape()) {
    case VertexLink::Shape::kSphere:
      ++check_.sphere_links;
      break;
    case VertexLink::Shape::kDisc:
      if (may_bound) {
        ++check_.disc_links;
      } else {
        bad("a disc, but no boundary may be there");
      }
      break;
    case VertexLink::Shape::kFaulty:
      bad("neither a sphere nor a disc");
  }
}

LinkCheck LinkJudge::result(std::uint64_t vertices) {
  check_.unused_vertices = vertices - check_.vertices;
  std::vector<Found> all = edges_;
  all.insert(all.end(), vertices_.begin(), vertices_.end());
  std::sort(all.begin(), all.end(),
            [](const Found& a, const Found& b) { return std::pair(a.vertex, a.other) < std::pair(b.vertex, b.other); });
  for (Found& found : all) check_.faults.push_back(std::move(found.words));
  return std::move(check_);
}

}  // namespace tet4d::topology

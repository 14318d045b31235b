#include "libpreprocess/topology/links.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "libpreprocess/error.h"

namespace tet4d::topology {
namespace {

using hypermesh::Tet;
using Triangle = std::array<std::uint32_t, 3>;

constexpr std::size_t kFaultsInWords = 3;  // of each kind

void fault(LinkCheck& check, std::uint64_t& count, std::string words) {
  if (count++ < kFaultsInWords) check.faults.push_back(std::move(words));
}

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

// The link of one vertex. Buffers are kept from vertex to vertex.
class VertexLink {
 public:
  enum class Shape { kSphere, kDisc, kFaulty };
  enum class EdgeShape { kCycle, kPath, kFaulty };

  // triangles: of the link, global numbers; not empty.
  void build(std::span<Triangle> triangles) {
    names_.clear();
    for (Triangle& triangle : triangles) {
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
    for (const Triangle& triangle : triangles) {
      Triangle local;
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

  std::span<const std::uint32_t> names() const { return names_; }

  // The whole link. `around` must hold edgeShape of each of its vertices.
  Shape shape(std::span<const EdgeShape> around) {
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

 private:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<std::uint32_t> names_, ends_, nodes_;
  std::vector<std::vector<Pair>> corners_;
  std::vector<Pair> sides_;
  std::size_t triangles_ = 0;
  bool twice_ = false;
  Groups groups_;
};

// The tetrahedra at each vertex, as one list with where each vertex's part ends.
struct Stars {
  std::vector<std::uint64_t> ends;
  std::vector<std::uint32_t> tets;
};

Stars starsOf(std::span<const Tet> tets, std::size_t vertices, LinkCheck& check) {
  Stars stars{std::vector<std::uint64_t>(vertices + 1), {}};
  std::vector<bool> degenerate(tets.size());
  for (std::size_t i = 0; i < tets.size(); ++i) {
    Tet sorted = tets[i];
    std::sort(sorted.begin(), sorted.end());
    if (sorted.back() >= vertices) {
      throw Error(FaultCode::kBadInput, "", "tetrahedron " + std::to_string(i),
                  "names vertex " + std::to_string(sorted.back()) + ", but there are " + std::to_string(vertices));
    }
    degenerate[i] = std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
    if (degenerate[i]) {
      fault(check, check.degenerate_tets, "tetrahedron " + std::to_string(i) + " names a vertex twice");
      continue;
    }
    for (const std::uint32_t v : tets[i]) ++stars.ends[v + 1];
  }
  std::partial_sum(stars.ends.begin(), stars.ends.end(), stars.ends.begin());
  stars.tets.resize(stars.ends.back());
  // ends[v] is where part v begins; filling moves it to where the part ends.
  for (std::size_t i = 0; i < tets.size(); ++i) {
    if (degenerate[i]) continue;
    for (const std::uint32_t v : tets[i]) stars.tets[stars.ends[v]++] = static_cast<std::uint32_t>(i);
  }
  stars.ends.pop_back();
  return stars;
}

// may_bound(v): whether vertex v may lie on the boundary.
template <class MayBound>
LinkCheck check(std::span<const Tet> tets, std::size_t vertices, MayBound may_bound) {
  LinkCheck result;
  const Stars stars = starsOf(tets, vertices, result);
  VertexLink link;
  std::vector<Triangle> triangles;
  std::vector<VertexLink::EdgeShape> around;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    const std::uint64_t begin = v == 0 ? 0 : stars.ends[v - 1], end = stars.ends[v];
    if (begin == end) {
      ++result.unused_vertices;
      continue;
    }
    ++result.vertices;
    result.largest_star = std::max(result.largest_star, end - begin);
    triangles.clear();
    for (std::uint64_t i = begin; i < end; ++i) {
      Triangle opposite{};
      std::size_t c = 0;
      for (const std::uint32_t w : tets[stars.tets[i]]) {
        if (w != v) opposite[c++] = w;
      }
      triangles.push_back(opposite);
    }
    link.build(triangles);
    around.clear();
    for (std::size_t w = 0; w < link.names().size(); ++w) {
      around.push_back(link.edgeShape(w));
      if (link.names()[w] < v) continue;  // an edge is counted at its smaller end
      ++result.edges;
      switch (around.back()) {
        case VertexLink::EdgeShape::kCycle:
          ++result.cycle_edges;
          break;
        case VertexLink::EdgeShape::kPath:
          ++result.path_edges;
          break;
        case VertexLink::EdgeShape::kFaulty:
          fault(result, result.faulty_edges,
                "edge (" + std::to_string(v) + ", " + std::to_string(link.names()[w]) +
                    "): its link is neither one cycle nor one path");
      }
    }
    const auto bad = [&](const char* what) {
      fault(result, result.faulty_vertices, "vertex " + std::to_string(v) + ": its link is " + what);
    };
    switch (link.shape(around)) {
      case VertexLink::Shape::kSphere:
        ++result.sphere_links;
        break;
      case VertexLink::Shape::kDisc:
        if (may_bound(v)) {
          ++result.disc_links;
        } else {
          bad("a disc, but no boundary may be there");
        }
        break;
      case VertexLink::Shape::kFaulty:
        bad("neither a sphere nor a disc");
    }
  }
  return result;
}

bool onWall(const Vec4f& v, const Bounds4f& domain) {
  return v.x == domain.min.x || v.x == domain.max.x || v.y == domain.min.y || v.y == domain.max.y ||
         v.z == domain.min.z || v.z == domain.max.z || v.t == domain.min.t || v.t == domain.max.t;
}

}  // namespace

LinkCheck checkLinks(std::span<const Tet> tets, std::uint64_t vertices, bool boundary_allowed) {
  return check(tets, vertices, [=](std::uint32_t) { return boundary_allowed; });
}

LinkCheck checkLinks(std::span<const Tet> tets, std::span<const std::uint8_t> may_bound) {
  return check(tets, may_bound.size(), [=](std::uint32_t v) { return may_bound[v] != 0; });
}

std::uint64_t linkCheckBytes(const hypermesh::File& file) {
  // Index list, stars (four numbers a tetrahedron), star ends, boundary marks.
  return file.header().tets * (sizeof(Tet) + 4 * sizeof(std::uint32_t)) + file.header().vertices * (8 + 1);
}

LinkCheck checkLinks(const hypermesh::File& file, std::uint64_t memory_bytes, outofcore::Progress& progress) {
  const std::uint64_t needed = linkCheckBytes(file), vertices = file.header().vertices;
  if (needed > memory_bytes || vertices > 0xffffffffull || file.header().tets > 0xffffffffull) {
    throw Error(FaultCode::kOutOfMemory, file.reader().path(), "",
                "the link test works in core and needs " + std::to_string(needed) + " bytes for " +
                    std::to_string(file.header().tets) + " tetrahedra, more than the " + std::to_string(memory_bytes) +
                    " allowed",
                "allow more memory, or use the face test, which streams");
  }
  const std::uint32_t flags = file.header().flags;
  const bool anywhere = (flags & hypermesh::kOnGrid) == 0 || (flags & hypermesh::kInnerBoundary) != 0;
  std::vector<Tet> tets;
  tets.reserve(file.header().tets);
  std::vector<std::uint8_t> may_bound(vertices, anywhere ? 1 : 0);
  progress.phase("gather", file.geometryPages());
  for (std::size_t k = 0; k < file.geometryPages(); ++k) {
    const hypermesh::GatheredPage page = unwrap(file.gather(k));
    std::vector<std::uint32_t> globals;
    for (std::uint64_t i = 0; i < page.view.header->owned; ++i) {
      const std::uint64_t global = page.view.header->first_vertex + i;
      globals.push_back(static_cast<std::uint32_t>(global));
      if (onWall(page.view.vertices[i], file.header().domain)) may_bound[global] = 1;
    }
    for (const hypermesh::Run& run : page.view.runs) {
      for (std::uint64_t i = 0; i < run.count; ++i) globals.push_back(static_cast<std::uint32_t>(run.first + i));
    }
    for (const Tet& tet : page.view.tets) {
      tets.push_back({globals[tet[0]], globals[tet[1]], globals[tet[2]], globals[tet[3]]});
    }
    progress.step(k + 1);
  }
  return checkLinks(tets, may_bound);
}

}  // namespace tet4d::topology

#include "libpreprocess/qslim4d/collapse.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <optional>
#include <utility>

#include "libpreprocess/qslim4d/inside.h"
#include "libpreprocess/qslim4d/placement_pair.h"

namespace tet4d::qslim4d {
namespace {

constexpr double kLeastTurn = 0.2588190451025207;  // cosine of 75 degrees
// A tetrahedron whose 3-volume is below this share of its longest edge's cube has none: f32 coordinates say no more.
constexpr double kLeastVolume = 1e-9;

// Flags of a vertex while links are compared.
enum Mark : std::uint32_t { kOfU = 1, kOfBoth = 2 };

bool has(const hypermesh::Tet& tet, std::uint32_t v) {
  return tet[0] == v || tet[1] == v || tet[2] == v || tet[3] == v;
}

std::uint64_t edgeOf(std::uint32_t a, std::uint32_t b) {
  return a < b ? std::uint64_t{a} << 32 | b : std::uint64_t{b} << 32 | a;
}

// Whether an angle with this dot product, of vectors whose squared lengths have this product, is at most 75 degrees.
bool isTurnSmall(double dot, double lengths2) { return dot >= 0 && dot * dot >= kLeastTurn * kLeastTurn * lengths2; }

bool hasVolume(double volume2, double longest2) {
  return volume2 > kLeastVolume * kLeastVolume * longest2 * longest2 * longest2;
}

// The 2x2 minors of two edges: the 4D cross product but for its first factor.
struct Minors {
  double xy, xz, xt, yz, yt, zt;
  Minors(const glm::dvec4& v, const glm::dvec4& w)
      : xy(v.x * w.y - v.y * w.x),
        xz(v.x * w.z - v.z * w.x),
        xt(v.x * w.w - v.w * w.x),
        yz(v.y * w.z - v.z * w.y),
        yt(v.y * w.w - v.w * w.y),
        zt(v.z * w.w - v.w * w.z) {}
  glm::dvec4 cross(const glm::dvec4& u) const {
    return {u.y * zt - u.z * yt + u.w * yz, -(u.x * zt - u.z * xt + u.w * xz), u.x * yt - u.y * xt + u.w * xy,
            -(u.x * yz - u.y * xz + u.z * xy)};
  }
};

template <class T>
bool holds(const std::vector<T>& few, const T& item) {
  return std::find(few.begin(), few.end(), item) != few.end();
}

template <class T>
bool haveCommon(const std::vector<T>& few, const std::vector<T>& others) {
  return std::any_of(few.begin(), few.end(), [&](const T& item) { return holds(others, item); });
}

// The items that an ascending list holds exactly once, in place.
void keepSingles(std::vector<std::uint64_t>& items) {
  std::sort(items.begin(), items.end());
  std::size_t kept = 0;
  for (std::size_t i = 0, end = 0; i < items.size(); i = end) {
    while (end < items.size() && items[end] == items[i]) ++end;
    if (end - i == 1) items[kept++] = items[i];
  }
  items.resize(kept);
}

}  // namespace

bool Collapser::evaluate(std::uint32_t u, std::uint32_t v, Placement& placement) const {
  if (((mesh_->is_boundary[u] | mesh_->is_boundary[v]) & kLocked) != 0) return false;
  const Walls wu = mesh_->walls[u], wv = mesh_->walls[v], both = wu | wv;
  if (both != wu && both != wv) return false;
  const Vec4f& held = mesh_->positions[both == wu ? u : v];
  Fixed fixed{0, {held.x, held.y, held.z, held.t}};
  for (unsigned c = 0; c < 4; ++c)
    if ((both >> (2 * c) & 3u) != 0) fixed.mask |= 1u << c;
  Quadric q = mesh_->quadrics[v].about(difference(mesh_->positions[u], mesh_->positions[v]));
  q.add(mesh_->quadrics[u]);
  std::optional<Quadric> attributes;
  if (mesh_->columns.inMetric())
    q.add(attributes.emplace(mesh_->columns.quadric(u, v, mesh_->positions[u], mesh_->positions[v])));
  placement =
      placeVertex(q, mesh_->positions[u], mesh_->positions[v], fixed, rules_.align, rules_.frames, mesh_->space);
  keepInside(q, mesh_->positions[u], mesh_->positions[v], fixed, mesh_->domain, placement);
  if (attributes) {
    const double length = mesh_->space.extent(difference(mesh_->positions[v], mesh_->positions[u]));
    limitAttributes(*attributes, q.weight, length, difference(placement.at, mesh_->positions[u]), placement);
  }
  return true;
}

void Collapser::price(std::uint32_t u, std::span<const std::uint32_t> others, std::vector<Priced>& priced) const {
  const SlimMesh& mesh = *mesh_;
  const auto alone = [&](std::uint32_t w) {
    Placement placement;
    if (evaluate(std::min(u, w), std::max(u, w), placement)) priced.push_back({w, placement.cost, placement.error});
  };
  const bool is_usual = mesh.walls[u] == 0 && (mesh.is_boundary[u] & kLocked) == 0 && !mesh.columns.inMetric();
  std::array<std::uint32_t, 2> pair{};
  std::size_t waiting = 0;
  const auto both = [&] {
    const auto [a, b] = pair;
    const PairCosts costs =
        costPair(mesh.quadrics[u], mesh.positions[u], {&mesh.quadrics[a], &mesh.quadrics[b]},
                 {&mesh.positions[a], &mesh.positions[b]}, rules_.align, rules_.frames, mesh.space, mesh.domain);
    for (std::size_t i = 0; i < waiting; ++i) {
      if (costs.is_usual[i])
        priced.push_back({pair[i], costs.cost[i], costs.error[i]});
      else
        alone(pair[i]);
    }
    waiting = 0;
  };
  for (const std::uint32_t w : others) {
    if ((mesh.is_boundary[w] & kLocked) != 0) continue;
    if (!is_usual || mesh.walls[w] != 0) {
      alone(w);
      continue;
    }
    pair[waiting++] = w;
    if (waiting == 2) both();
  }
  if (waiting == 0) return;
  pair[1] = pair[0];
  both();
}

// The tetrahedra at v, apart from those with `other`.
void Collapser::gatherApart(std::uint32_t v, std::uint32_t other, std::vector<Corner>& apart) const {
  apart.clear();
  mesh_->prefetchStar(v);
  for (const std::uint32_t c : mesh_->starOf(v)) {
    const hypermesh::Tet& tet = mesh_->tets[c / 4];
    if (tet[0] != kNone && !has(tet, other)) apart.push_back({tet, c});
  }
}

// The tetrahedra at v: apart from those with u, and the link of both.
void Collapser::gatherSecond(std::uint32_t u, std::uint32_t v) {
  apart_v_.clear();
  link_edges_.clear(), link_tets_.clear();
  for (const std::uint32_t c : mesh_->starOf(v)) {
    const hypermesh::Tet& tet = mesh_->tets[c / 4];
    if (tet[0] == kNone) continue;
    if (!has(tet, u)) {
      apart_v_.push_back({tet, c});
      continue;
    }
    std::array<std::uint32_t, 4> rest{};
    std::size_t n = 0;
    for (const std::uint32_t w : tet)
      if (w != u && w != v) rest[n++] = w;
    link_edges_.push_back(edgeOf(rest[0], rest[1]));
    link_tets_.push_back(c / 4);
  }
}

// Edges and faces of a link all of whose vertices lie in Lk(uv).
void Collapser::sharedPieces(const std::vector<Corner>& apart, std::vector<Edge>& edges, std::vector<Face>& faces) {
  edges.clear(), faces.clear();
  for (const auto& [tet, number] : apart) {
    Face shared{};
    std::size_t n = 0;
    for (std::uint32_t i = 0; i < 4; ++i)
      if (i != number % 4 && (marks_.flags(tet[i]) & kOfBoth) != 0) shared[n++] = tet[i];
    if (n < 2) continue;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 1; j < n; ++j) edges.push_back(edgeOf(shared[i], shared[j]));
    if (n < 3) continue;
    std::sort(shared.begin(), shared.end());
    faces.push_back(shared);
  }
}

// Lk(u) and Lk(v) may share what is in Lk(uv) and nothing else. Vertices first; edges and faces in both links then have
// their corners among the few of Lk(uv).
bool Collapser::linksAllow() {
  if (link_edges_.empty()) return false;
  marks_.begin(3 * (apart_u_.size() + apart_v_.size()) + 2 * link_edges_.size(), mesh_->positions.size());
  for (const Edge edge : link_edges_)
    marks_.add(static_cast<std::uint32_t>(edge >> 32), kOfBoth), marks_.add(static_cast<std::uint32_t>(edge), kOfBoth);
  for (const auto& [tet, number] : apart_u_)
    for (const std::uint32_t w : tet) marks_.add(w, kOfU);
  for (const auto& [tet, number] : apart_v_) {
    for (std::uint32_t i = 0; i < 4; ++i)
      if (i != number % 4 && marks_.flags(tet[i]) == kOfU) return false;
  }
  sharedPieces(apart_u_, edges_u_, faces_u_);
  sharedPieces(apart_v_, edges_v_, faces_v_);
  if (haveCommon(faces_u_, faces_v_)) return false;
  return std::none_of(edges_u_.begin(), edges_u_.end(),
                      [&](Edge edge) { return holds(edges_v_, edge) && !holds(link_edges_, edge); });
}

// Edges of a vertex's link in one of its triangles only: the boundary as seen from it. `other` is the edge's other end.
void Collapser::readBorder(const std::vector<Corner>& apart, std::uint32_t other, std::vector<Edge>& border) const {
  border.clear();
  for (const auto& [tet, number] : apart) {
    std::array<std::uint32_t, 3> opposite{};
    std::size_t n = 0;
    for (std::uint32_t i = 0; i < 4; ++i)
      if (i != number % 4) opposite[n++] = tet[i];
    border.insert(border.end(), {edgeOf(opposite[0], opposite[1]), edgeOf(opposite[0], opposite[2]),
                                 edgeOf(opposite[1], opposite[2])});
  }
  for (const Edge edge : link_edges_) {
    const auto a = static_cast<std::uint32_t>(edge >> 32), b = static_cast<std::uint32_t>(edge);
    border.insert(border.end(), {edge, edgeOf(a, other), edgeOf(b, other)});
  }
  keepSingles(border);
}

// The same with the boundary coned to one more vertex: its cone over a face of the boundary is a tetrahedron.
bool Collapser::bordersAllow(std::uint32_t u, std::uint32_t v) {
  if ((mesh_->is_boundary[u] & mesh_->is_boundary[v] & kOnBoundary) == 0) return true;
  readBorder(apart_u_, v, border_u_);
  readBorder(apart_v_, u, border_v_);
  const auto touches = [](const std::vector<Edge>& border, std::uint32_t w) {
    return std::any_of(border.begin(), border.end(), [&](Edge edge) {
      return static_cast<std::uint32_t>(edge >> 32) == w || static_cast<std::uint32_t>(edge) == w;
    });
  };
  if (!touches(border_u_, v)) return false;  // the edge runs through the inside from boundary to boundary
  for (const Edge edge : border_u_) {
    for (const std::uint32_t w : {static_cast<std::uint32_t>(edge >> 32), static_cast<std::uint32_t>(edge)}) {
      if (w != v && touches(border_v_, w) && !holds(border_u_, edgeOf(v, w))) return false;
    }
  }
  // Edges with u or v in them are no edges of both links.
  return !haveCommon(border_u_, border_v_);
}

// The tetrahedra of a vertex that moves away from the other end, with the vertex moved from `from` to `at`.
//
// A tetrahedron's normal is linear in each corner: the minors of the face that stays serve for both places.
Verdict Collapser::judgeStar(const std::vector<Corner>& apart, const Vec4f& from, const Vec4f& at) const {
  const Space& space = mesh_->space;
  for (const auto& [tet, number] : apart) {
    std::array<const Vec4f*, 3> p{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < 4; ++i)
      if (i != number % 4) p[n++] = &mesh_->positions[tet[i]];
    if (p[0]->t == at.t && p[1]->t == at.t && p[2]->t == at.t) return Verdict::kFlatTime;
    const glm::dvec4 a = difference(*p[1], *p[0]), b = difference(*p[2], *p[0]), to = difference(at, *p[0]);
    const Minors minors(a, b);
    const glm::dvec4 before = minors.cross(difference(from, *p[0])), after = minors.cross(to);
    const glm::dvec4 la = space.toLengths(a), lb = space.toLengths(b), lto = space.toLengths(to);
    const double reach2 = std::max({glm::dot(la, la), glm::dot(lb, lb), glm::dot(lto, lto)});
    const glm::dvec3 was = space.spatialNormal(before), is = space.spatialNormal(after);
    const double speed2 = space.speed * space.speed, was2 = glm::dot(was, was), is2 = glm::dot(is, is);
    const double volume2 = speed2 * is2 + after.w * after.w;
    // No edge is longer than two from the first corner together.
    if (!hasVolume(volume2, 4 * reach2)) {
      const double across2 =
          std::max({glm::dot(la - lb, la - lb), glm::dot(la - lto, la - lto), glm::dot(lb - lto, lb - lto)});
      if (!hasVolume(volume2, std::max(reach2, across2))) return Verdict::kFlip;
    }
    // Spatial normals, for they are what a slice shows; where the surface jumps there is none, and the whole normal
    // counts.
    const double dot = glm::dot(was, is);
    if (speed2 * was2 > 1e-6 * before.w * before.w) {
      if (!isTurnSmall(dot, was2 * is2) || is2 == 0) return Verdict::kFlip;
    } else if (!isTurnSmall(speed2 * dot + before.w * after.w, (speed2 * was2 + before.w * before.w) * volume2)) {
      return Verdict::kFlip;
    }
  }
  return Verdict::kAllowed;
}

// The cheap tests first, and those that refuse most.
Verdict Collapser::judge(std::uint32_t u, std::uint32_t v, const Vec4f& at) {
  mesh_->prefetchStar(v);
  gatherApart(u, v, apart_u_);
  if (const Verdict verdict = judgeStar(apart_u_, mesh_->positions[u], at); verdict != Verdict::kAllowed)
    return verdict;
  gatherSecond(u, v);
  const std::size_t left = apart_u_.size() + apart_v_.size();
  if (left > rules_.most_star) return Verdict::kStar;
  if (left == 0) return Verdict::kLinks;  // nothing would be left of the component
  if (const Verdict verdict = judgeStar(apart_v_, mesh_->positions[v], at); verdict != Verdict::kAllowed)
    return verdict;
  return linksAllow() && bordersAllow(u, v) ? Verdict::kAllowed : Verdict::kLinks;
}

std::uint32_t Collapser::collapse(std::uint32_t u, std::uint32_t v, const Vec4f& at) {
  makeRoom(*mesh_, std::uint64_t{mesh_->stars[u].size} + mesh_->stars[v].size);
  gatherApart(u, v, apart_u_);
  gatherSecond(u, v);
  return merge(u, v, at);
}

// Tetrahedra with both ends die, in v's others u takes v's place.
std::uint32_t Collapser::merge(std::uint32_t u, std::uint32_t v, const Vec4f& at) {
  SlimMesh& mesh = *mesh_;
  for (const std::uint32_t tet : link_tets_) mesh.tets[tet][0] = kNone;
  for (const Corner& corner : apart_v_) mesh.tets[corner.number / 4][corner.number % 4] = u;
  Star star = mesh.stars[u];
  const std::size_t size = apart_u_.size() + apart_v_.size();
  if (size > star.size)
    star.begin =
        static_cast<std::uint32_t>(std::atomic_ref(mesh.corners_used).fetch_add(size, std::memory_order_relaxed));
  star.size = static_cast<std::uint32_t>(size);
  std::uint32_t* to = mesh.corners.data() + star.begin;
  for (const std::vector<Corner>* apart : {&apart_u_, &apart_v_})
    for (const Corner& corner : *apart) *to++ = corner.number;
  mesh.stars[u] = star;
  mesh.stars[v] = {};
  unite(u, v, at);
  return static_cast<std::uint32_t>(link_tets_.size());
}

// What is known of two vertices is that of one.
void Collapser::unite(std::uint32_t u, std::uint32_t v, const Vec4f& at) {
  SlimMesh& mesh = *mesh_;
  if (!mesh.columns.empty()) mesh.columns.merge(u, v, mesh.positions[u], mesh.positions[v], at, mesh.space);
  mesh.quadrics[u] = mesh.quadrics[u].about(difference(at, mesh.positions[u]));
  mesh.quadrics[u].add(mesh.quadrics[v].about(difference(at, mesh.positions[v])));
  mesh.positions[u] = at;
  mesh.walls[u] |= mesh.walls[v];
  mesh.is_boundary[u] |= mesh.is_boundary[v];
}

std::span<const std::uint32_t> Collapser::neighbours(std::uint32_t v) {
  neighbours_.clear();
  mesh_->prefetchStar(v);
  marks_.begin(3 * std::size_t{mesh_->stars[v].size}, mesh_->positions.size());
  mesh_->forEachTet(v, [&](std::uint32_t tet, std::uint32_t) {
    for (const std::uint32_t w : mesh_->tets[tet]) {
      if (w == v || marks_.add(w, 1) != 0) continue;
      // The caller will look at the edge's quadric.
      const auto* quadric = reinterpret_cast<const char*>(&mesh_->quadrics[w]);
      __builtin_prefetch(quadric), __builtin_prefetch(quadric + 64), __builtin_prefetch(&mesh_->positions[w]);
      neighbours_.push_back(w);
    }
  });
  return neighbours_;
}

}  // namespace tet4d::qslim4d

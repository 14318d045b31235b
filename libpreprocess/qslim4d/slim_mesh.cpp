#include "libpreprocess/qslim4d/slim_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/matrix.hpp>
#include <optional>
#include <string>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/outofcore/huge_pages.h"

namespace tet4d::qslim4d {
namespace {

// Of a constraint that holds a free boundary in place.
constexpr double kBoundaryWeight = 10;

// Room behind the stars for merged ones, as a share of the living corners: about 30 are written anew for a collapse, so
// the stars are laid out again each time a few per cent of the vertices are gone.
constexpr std::uint64_t kRoomShare = 16;

Walls wallsOf(const Vec4f& v, const Bounds4f& domain) {
  const std::array<float, 4> at{v.x, v.y, v.z, v.t};
  const std::array<float, 4> low{domain.min.x, domain.min.y, domain.min.z, domain.min.t};
  const std::array<float, 4> high{domain.max.x, domain.max.y, domain.max.z, domain.max.t};
  unsigned walls = 0;
  for (unsigned c = 0; c < 4; ++c) {
    if (at[c] == low[c]) walls |= 1u << (2 * c);
    if (at[c] == high[c]) walls |= 1u << (2 * c + 1);
  }
  return static_cast<Walls>(walls);
}

double speedOf(const SlimMesh& mesh) {
  double space = 0, time = 0;
  for (const hypermesh::Tet& tet : mesh.tets) {
    for (std::size_t i = 1; i < 4; ++i) {
      const glm::dvec4 edge = difference(mesh.positions[tet[i]], mesh.positions[tet[0]]);
      space += mesh.space.length(edge);
      time += std::abs(edge.w);
    }
  }
  return speedFrom(space, time);
}

void addTetQuadric(SlimMesh& mesh, const hypermesh::Tet& tet, Metric metric) {
  const Vec4f& o = mesh.positions[tet[0]];
  const glm::dvec4 n = cross4(difference(mesh.positions[tet[1]], o), difference(mesh.positions[tet[2]], o),
                              difference(mesh.positions[tet[3]], o));
  const double slope = glm::length(mesh.space.spatialNormal(n));
  if (metric == Metric::kPaper) {
    for (const std::uint32_t v : tet) mesh.quadrics[v].addPlane(n, 1, slope * slope);
    return;
  }
  const double weight = std::max(slope, kLeastSlope * std::abs(n.w) / mesh.space.speed);
  if (!(weight > 0)) return;  // without volume
  for (const std::uint32_t v : tet) mesh.quadrics[v].addPlane(n, 1 / weight, weight);
}

using Face = std::array<std::uint32_t, 3>;

// Holds a face of a free boundary: distances to the hyperplane through it that stands across its tetrahedron. Angles
// are those of lengths, with time measured by the mesh's speed; the weight is that of the tetrahedron's own term.
void addBoundaryQuadric(SlimMesh& mesh, const Face& face, std::uint32_t apex, Metric metric) {
  const Space& space = mesh.space;
  const auto toLengths = [&](std::uint32_t v) {
    return space.toLengths(difference(mesh.positions[v], mesh.positions[face[0]]));
  };
  const glm::dvec4 u = toLengths(face[1]), v = toLengths(face[2]);
  const glm::dvec4 normal = cross4(u, v, toLengths(apex));
  const double volume = glm::length(normal);
  if (!(volume > 0)) return;
  const glm::dvec4 across = cross4(u, v, normal / volume);
  const double slope = std::max(glm::length(spatial(across)), kLeastSlope * std::abs(across.w));
  const double duration = volume / glm::length(across) / space.speed;  // the tetrahedron's height, as time
  const double scale = kBoundaryWeight * (metric == Metric::kPaper ? duration * duration : duration / slope);
  if (!std::isfinite(scale)) return;
  const glm::dvec4 plane(glm::transpose(space.axes) * spatial(across), space.speed * across.w);
  for (const std::uint32_t w : face) mesh.quadrics[w].addPlane(plane, scale, 0);
}

[[noreturn]] void refuseFace(Face face, const CellContext* cell) {
  std::array<std::uint64_t, 3> names{face[0], face[1], face[2]};
  if (cell != nullptr) names = {cell->names[face[0]], cell->names[face[1]], cell->names[face[2]]};
  throw Error(FaultCode::kBadInput, "",
              "triangle " + std::to_string(names[0]) + " " + std::to_string(names[1]) + " " + std::to_string(names[2]),
              "lies in more than two tetrahedra: the mesh is no manifold there",
              "see tet4d-info --validate for all such places, and mend the mesh, or give --non-manifold keep");
}

constexpr std::uint32_t kChunk = 4096;  // vertices a task

void inChunks(outofcore::Executor* executor, std::size_t count, const std::function<void(std::size_t)>& task) {
  const std::size_t chunks = (count + kChunk - 1) / kChunk;
  if (executor != nullptr) return executor->run(chunks, task);
  for (std::size_t i = 0; i < chunks; ++i) task(i);
}

struct SeenFace {
  Face face;  // ascending
  std::uint32_t apex;
};

// The faces of tetrahedra at v whose smallest vertex is v, equal ones side by side.
void facesFrom(const SlimMesh& mesh, std::uint32_t v, std::vector<SeenFace>& seen) {
  seen.clear();
  mesh.forEachTet(v, [&](std::uint32_t t, std::uint32_t corner) {
    const hypermesh::Tet& tet = mesh.tets[t];
    std::array<std::uint32_t, 3> larger{};
    std::size_t n = 0;
    for (std::uint32_t i = 0; i < 4; ++i)
      if (i != corner) larger[n++] = tet[i];
    if (larger[0] > larger[1]) std::swap(larger[0], larger[1]);
    if (larger[1] > larger[2]) std::swap(larger[1], larger[2]);
    if (larger[0] > larger[1]) std::swap(larger[0], larger[1]);
    if (v < larger[0]) {
      seen.push_back({{v, larger[0], larger[1]}, larger[2]});
      seen.push_back({{v, larger[0], larger[2]}, larger[1]});
    }
    if (v < larger[1]) seen.push_back({{v, larger[1], larger[2]}, larger[0]});
  });
  std::sort(seen.begin(), seen.end(), [](const SeenFace& a, const SeenFace& b) {
    return std::pair(a.face[1], a.face[2]) < std::pair(b.face[1], b.face[2]);
  });
}

using Faces = std::vector<SeenFace>;

// The faces of one tetrahedron, in order of vertices: a list for every so many of them.
std::vector<Faces> boundaryFaces(const SlimMesh& mesh, const MeshContext& context) {
  std::vector<Faces> found((mesh.positions.size() + kChunk - 1) / kChunk);
  std::vector<std::optional<Face>> refused(found.size());
  inChunks(context.executor, mesh.positions.size(), [&](std::size_t chunk) {
    Faces seen;
    const std::size_t end = std::min(mesh.positions.size(), (chunk + 1) * kChunk);
    for (std::size_t v = chunk * kChunk; v < end; ++v) {
      facesFrom(mesh, static_cast<std::uint32_t>(v), seen);
      for (std::size_t i = 0, next = 0; i < seen.size(); i = next) {
        while (next < seen.size() && seen[next].face == seen[i].face) ++next;
        if (next - i > 2 && !context.keep_non_manifold && !refused[chunk]) refused[chunk] = seen[i].face;
        if (next - i == 1) found[chunk].push_back(seen[i]);
      }
    }
    found[chunk].shrink_to_fit();
  });
  for (const std::optional<Face>& face : refused)
    if (face) refuseFace(*face, context.cell);
  return found;
}

// Marks boundary vertices, and holds what of the boundary is on no wall.
void findBoundary(SlimMesh& mesh, Metric metric, const MeshContext& context) {
  const auto allHave = [&](const Face& face, std::uint8_t flag) {
    return (mesh.is_boundary[face[0]] & mesh.is_boundary[face[1]] & mesh.is_boundary[face[2]] & flag) != 0;
  };
  const bool has_terms = context.cell != nullptr && !context.cell->quadrics.empty();
  for (const Faces& faces : boundaryFaces(mesh, context)) {
    for (const auto& [face, apex] : faces) {
      if (context.cell != nullptr && allHave(face, kLocked)) continue;  // cut, not bounded
      for (const std::uint32_t w : face) mesh.is_boundary[w] |= kOnBoundary;
      if (has_terms && !allHave(face, kUncounted)) continue;
      if ((mesh.walls[face[0]] & mesh.walls[face[1]] & mesh.walls[face[2]]) == 0)
        addBoundaryQuadric(mesh, face, apex, metric);
    }
  }
}

}  // namespace

double speedFrom(double space, double time) { return space > 0 && time > 0 ? space / time : 1; }

SlimMesh makeSlimMesh(std::vector<Vec4f> positions, std::vector<hypermesh::Tet> tets, const Bounds4f& domain,
                      const AffineMap& map, Metric metric, const MeshContext& context) {
  const CellContext* cell = context.cell;
  SlimMesh mesh;
  mesh.positions = std::move(positions);
  mesh.tets = std::move(tets);
  mesh.space = spaceOf(map);
  mesh.domain = domain;
  const std::size_t corners = 4 * mesh.tets.size();
  outofcore::reserveHuge(mesh.corners, corners + corners / kRoomShare);
  mesh.corners.resize(corners + corners / kRoomShare);
  outofcore::reserveHuge(mesh.stars, mesh.positions.size());
  mesh.stars.resize(mesh.positions.size());
  tidy(mesh);
  mesh.space.speed = cell != nullptr ? cell->speed : speedOf(mesh);
  outofcore::reserveHuge(mesh.quadrics, mesh.positions.size());
  mesh.quadrics.resize(mesh.positions.size());
  mesh.is_boundary.assign(mesh.positions.size(), 0);
  const bool has_quadrics = cell != nullptr && !cell->quadrics.empty();
  if (has_quadrics) mesh.quadrics.assign(cell->quadrics.begin(), cell->quadrics.end());
  if (cell != nullptr) mesh.is_boundary.assign(cell->flags.begin(), cell->flags.end());
  mesh.walls.reserve(mesh.positions.size());
  for (const Vec4f& v : mesh.positions) mesh.walls.push_back(wallsOf(v, domain));
  if (!has_quadrics)
    for (const hypermesh::Tet& tet : mesh.tets) addTetQuadric(mesh, tet, metric);
  findBoundary(mesh, metric, context);
  return mesh;
}

void tidy(SlimMesh& mesh) {
  std::erase_if(mesh.tets, [](const hypermesh::Tet& tet) { return tet[0] == kNone; });
  std::fill(mesh.stars.begin(), mesh.stars.end(), Star{});
  for (const hypermesh::Tet& tet : mesh.tets)
    for (const std::uint32_t v : tet) ++mesh.stars[v].size;
  mesh.live_tets = mesh.tets.size();
  mesh.corners_used = 4 * mesh.live_tets;
  mesh.live_vertices = 0;
  std::uint32_t begin = 0;
  for (Star& star : mesh.stars) {
    mesh.live_vertices += star.size != 0 ? 1 : 0;
    star.begin = begin;
    begin += std::exchange(star.size, 0);
  }
  for (std::uint32_t tet = 0; tet < mesh.tets.size(); ++tet) {
    for (std::uint32_t i = 0; i < 4; ++i) {
      Star& star = mesh.stars[mesh.tets[tet][i]];
      mesh.corners[star.begin + star.size++] = 4 * tet + i;
    }
  }
}

void makeRoom(SlimMesh& mesh, std::uint64_t count) {
  if (mesh.corners_used + count <= mesh.corners.size()) return;
  // Corners are laid out from nothing: where they need a larger pool, the old one goes first.
  const std::uint64_t needed = 4 * mesh.live_tets + count;
  if (needed > mesh.corners.size()) {
    release(mesh.corners);
    outofcore::reserveHuge(mesh.corners, needed);
    mesh.corners.resize(needed);
  }
  tidy(mesh);
}

std::uint64_t slimMeshBytes(std::uint64_t vertices, std::uint64_t tets) {
  constexpr std::uint64_t kRoom = std::min(kRoomShare, kMostNewShare);
  return vertices * (sizeof(Vec4f) + sizeof(Quadric) + sizeof(Star) + 2) +
         tets * (sizeof(hypermesh::Tet) + 4 * sizeof(std::uint32_t) * (kRoom + 1) / kRoom);
}

}  // namespace tet4d::qslim4d

#include "libpreprocess/qslim4d/slim_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/matrix.hpp>
#include <string>
#include <utility>

#include "libpreprocess/error.h"

namespace tet4d::qslim4d {
namespace {

// Where the spatial part of a tetrahedron's normal is below this share of its temporal part, the surface stands almost
// parallel to the present (births, jumps): a fixed-time distance has no meaning there, and its weight is bounded.
constexpr double kLeastSlope = 0.05;
// Of a constraint that holds a free boundary in place.
constexpr double kBoundaryWeight = 10;

void linkStars(SlimMesh& mesh) {
  mesh.next.assign(4 * mesh.tets.size(), kNone);
  mesh.head.assign(mesh.positions.size(), kNone);
  mesh.tail.assign(mesh.positions.size(), kNone);
  for (std::uint32_t tet = 0; tet < mesh.tets.size(); ++tet) {
    for (std::uint32_t i = 0; i < 4; ++i) {
      const std::uint32_t v = mesh.tets[tet][i], corner = 4 * tet + i;
      if (mesh.head[v] == kNone) {
        mesh.head[v] = corner;
        ++mesh.live_vertices;
      } else {
        mesh.next[mesh.tail[v]] = corner;
      }
      mesh.tail[v] = corner;
    }
  }
  mesh.live_tets = mesh.tets.size();
}

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
    const glm::dvec4 offset = difference(mesh.positions[v], mesh.positions[face[0]]);
    return glm::dvec4(space.axes * spatial(offset), space.speed * offset.w);
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
              "see tet4d-info --validate for all such places, and mend the mesh");
}

// Marks boundary vertices, and holds what of the boundary is on no wall.
void findBoundary(SlimMesh& mesh, Metric metric, const CellContext* cell) {
  const auto allHave = [&](const Face& face, std::uint8_t flag) {
    return (mesh.is_boundary[face[0]] & mesh.is_boundary[face[1]] & mesh.is_boundary[face[2]] & flag) != 0;
  };
  struct Seen {
    Face face;  // ascending
    std::uint32_t apex;
  };
  std::vector<Seen> seen;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    seen.clear();
    mesh.forEachTet(v, [&](std::uint32_t tet, std::uint32_t corner) {
      for (std::uint32_t skip = 0; skip < 4; ++skip) {
        if (skip == corner) continue;
        Face face{};
        std::size_t n = 0;
        for (std::uint32_t i = 0; i < 4; ++i)
          if (i != skip) face[n++] = mesh.tets[tet][i];
        std::sort(face.begin(), face.end());
        if (face[0] == v) seen.push_back({face, mesh.tets[tet][skip]});
      }
    });
    std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) { return a.face < b.face; });
    for (std::size_t i = 0, end = 0; i < seen.size(); i = end) {
      while (end < seen.size() && seen[end].face == seen[i].face) ++end;
      if (end - i > 2) refuseFace(seen[i].face, cell);
      if (end - i == 2) continue;
      const Face& face = seen[i].face;
      if (allHave(face, kLocked)) continue;  // cut, not bounded
      for (const std::uint32_t w : face) mesh.is_boundary[w] |= kOnBoundary;
      if (cell != nullptr && !cell->quadrics.empty() && !allHave(face, kUncounted)) continue;
      if ((mesh.walls[face[0]] & mesh.walls[face[1]] & mesh.walls[face[2]]) == 0)
        addBoundaryQuadric(mesh, face, seen[i].apex, metric);
    }
  }
}

}  // namespace

double speedFrom(double space, double time) { return space > 0 && time > 0 ? space / time : 1; }

SlimMesh makeSlimMesh(std::vector<Vec4f> positions, std::vector<hypermesh::Tet> tets, const Bounds4f& domain,
                      const AffineMap& map, Metric metric, const CellContext* cell) {
  SlimMesh mesh;
  mesh.positions = std::move(positions);
  mesh.tets = std::move(tets);
  mesh.space = spaceOf(map);
  linkStars(mesh);
  mesh.space.speed = cell != nullptr ? cell->speed : speedOf(mesh);
  mesh.quadrics.resize(mesh.positions.size());
  mesh.is_boundary.assign(mesh.positions.size(), 0);
  const bool has_quadrics = cell != nullptr && !cell->quadrics.empty();
  if (has_quadrics) mesh.quadrics.assign(cell->quadrics.begin(), cell->quadrics.end());
  if (cell != nullptr) mesh.is_boundary.assign(cell->flags.begin(), cell->flags.end());
  mesh.walls.reserve(mesh.positions.size());
  for (const Vec4f& v : mesh.positions) mesh.walls.push_back(wallsOf(v, domain));
  if (!has_quadrics)
    for (const hypermesh::Tet& tet : mesh.tets) addTetQuadric(mesh, tet, metric);
  findBoundary(mesh, metric, cell);
  return mesh;
}

std::uint64_t slimMeshBytes(std::uint64_t vertices, std::uint64_t tets) {
  return vertices * (sizeof(Vec4f) + sizeof(Quadric) + 2 * sizeof(std::uint32_t) + 2) +
         tets * (sizeof(hypermesh::Tet) + 4 * sizeof(std::uint32_t));
}

}  // namespace tet4d::qslim4d

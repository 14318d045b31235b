// How large a hypermesh is: 3-volume of the hypersurface, enclosed 4-volume, swept slice area, tetrahedra per active
// cell.
//
// Shares no code with the builders. For a tetrahedron (a, b, c, d) let N be the 4D cross product of b-a, c-a, d-a, the
// vector with det(n, b-a, c-a, d-a) = n . N: |N| is six times its 3-volume, and N points out of the inside set
// (formats/core/tet_slice.h). Double throughout, compensated sums.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/measure/compensated_sum.h"
#include "libpreprocess/outofcore/progress.h"

namespace tet4d::measure {

struct HypermeshMeasures {
  std::uint64_t tets = 0;
  double volume3 = 0;     // of the hypersurface, sum |N| / 6: cells^3 with one frame as long as one cell
  double swept_area = 0;  // integral over time of the slices' area, sum |spatial part of N| / 6: cells^2 * frames
  // Enclosed 4-volume, cells^3 * frames, and with lengths and times of the world. By the divergence theorem with the
  // field (x, y, z, 0) / 3, which has no flux through the first and last time. Absent if a tetrahedron touches a
  // spatial wall of the domain, or the file allows inner boundary: there need be no enclosed set then.
  std::optional<double> volume4, volume4_world;
  // |sum of the spatial parts of N| over the sum of their lengths: 0 for slices that are closed, but for rounding.
  double closure = 0;
  std::uint64_t active_cells = 0;  // hypercubes of the grid that hold a tetrahedron's centroid, per page and summed
  double tetsPerActiveCell() const {
    return active_cells == 0 ? 0 : static_cast<double>(tets) / static_cast<double>(active_cells);
  }
};

// Adds up a mesh part by part. A part is a page, or the whole mesh.
class HypermeshMeter {
 public:
  // domain: its spatial walls; closed: whether 4-volumes are wanted where no wall is touched.
  // times: world time of each frame; a tetrahedron is straight in world time between its vertices.
  HypermeshMeter(const Bounds4f& domain, bool closed, const AffineMap& index_to_world, std::span<const double> times);

  // tets: indices into positions, all in range. O(tets log tets), memory O(active cells of the part).
  void add(std::span<const Vec4f> positions, std::span<const hypermesh::Tet> tets);
  HypermeshMeasures result() const;

 private:
  bool onSpatialWall(const Vec4f& v) const;

  Bounds4f domain_;
  bool closed_;
  AffineMap index_to_world_;
  std::vector<double> times_;
  std::array<double, 3> centre_{};  // of the domain: the field's origin, so that large coordinates cancel early
  std::uint64_t tets_ = 0, active_cells_ = 0;
  CompensatedSum volume3_, swept_area_, volume4_, volume4_time_;
  std::array<CompensatedSum, 3> spatial_normal_;
};

// A file, page by page (phase "measure"). Memory: one gathered page. Throws Error where a page is damaged.
HypermeshMeasures measureHypermesh(const hypermesh::File& file, outofcore::Progress& progress);

// A mesh in core, closed, without walls and with world = index space.
HypermeshMeasures measureHypermesh(std::span<const Vec4f> positions, std::span<const hypermesh::Tet> tets);

}  // namespace tet4d::measure

// A tetrahedral mesh with a scalar as a hypermesh whose time is the scalar: its slice at v is the isosurface of v, so
// playing it sweeps the isovalue. Ponchio & Hormann 2008, sec. 3: any tetrahedral 3-manifold in space-time is one.
//
// Time. The scalar's range is divided into frames - 1 equal steps; the header's table of times holds the scalar's
// values there, so world time is the scalar. A vertex is at frame (s - min) / (max - min) * (frames - 1), computed in
// double: the map is affine, as it must be for slices to be isosurfaces, and with frames - 1 a power of two it costs no
// more than one rounding to float32. Scalars closer than 2^-24 of the range may share a frame number, and are counted.
//
// Inside is {s >= t}, as in tet4d-mc: slices wind counter-clockwise seen from the side of lower values. A slice at the
// very value of vertices is the limit from above, as of every hypermesh (lifespans are half-open). The mesh's own
// boundary is inner boundary of the hypermesh.
//
// Pages are steps of the range: page k has the tetrahedra whose least scalar lies in step k, and the vertices that they
// are the first to use. Memory: the mesh, and 21 bytes a vertex and 4 a tetrahedron beside it, and one page.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/exchange/read_tet_mesh.h"
#include "libpreprocess/hypermesh/orient_tets.h"
#include "libpreprocess/outofcore/memory_budget.h"
#include "libpreprocess/outofcore/progress.h"

namespace tet4d::hypermesh {

inline constexpr std::uint64_t kSweepFrames = 65;

class ScalarSweep {
 public:
  // Takes a mesh with a scalar; frames: at least 2, at most kMaxIndex + 1. Throws Error{kBadInput}: a scalar of a used
  // vertex that is not finite, one value everywhere, a range without that many doubles, a tetrahedron that names a
  // vertex twice, what orientTets() refuses.
  ScalarSweep(exchange::TetMesh mesh, std::uint64_t frames, outofcore::MemoryBudget& memory);

  const MeshHeader& header() const { return header_; }
  const std::vector<double>& times() const { return times_; }
  const Orientation& orientation() const { return orientation_; }
  // Pairs of neighbouring values of the scalar that share a frame number.
  std::uint64_t sharedFrames() const { return shared_frames_; }
  std::uint64_t vertices() const { return order_.size(); }  // used by tetrahedra
  std::uint64_t tets() const { return mesh_.tets.size(); }

  // Writes the pages. The writer was made with header() and times().
  void write(Writer& writer, outofcore::Progress& progress);

 private:
  void checkTets() const;
  void setTimes(std::uint64_t frames);
  void setMap();
  void countShared();
  void sortTets(std::size_t pages);
  void numberVertices(std::size_t pages);
  void writePage(std::size_t page, Writer& writer) const;
  float frameOf(std::uint32_t vertex) const;
  Vec4f positionOf(std::uint32_t vertex) const;
  std::size_t pageOf(std::size_t tet) const;

  exchange::TetMesh mesh_;
  outofcore::MemoryBudget::Reservation memory_;
  MeshHeader header_{};
  std::vector<double> times_;
  Orientation orientation_;
  std::uint64_t shared_frames_ = 0;
  std::vector<std::uint8_t> used_;           // by vertex
  std::vector<std::uint32_t> tet_order_;     // tetrahedra by page
  std::vector<std::uint64_t> page_tets_;     // where each page's begin in tet_order_, and their end
  std::vector<std::uint32_t> owner_, last_;  // of a vertex: the first page that uses it, and the last
  std::vector<std::uint32_t> order_;         // vertices by their numbers in the hypermesh
  std::vector<std::uint32_t> number_;        // by vertex
  std::vector<std::uint64_t> page_vertices_;
};

}  // namespace tet4d::hypermesh

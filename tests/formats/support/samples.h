// Small files of every payload, made anew each time with the same bytes.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "formats/dynamic_triangles.h"
#include "formats/grid4.h"
#include "formats/hypermesh.h"
#include "formats/patch_dag.h"
#include "formats/surface_sequence.h"

namespace tet4d::test {

// A rippled sheet x = f(y, z, t) over `cells` x `cells` cells and `slabs` time steps, each cube of (y, z, t) in six
// tetrahedra: an oriented manifold whose boundary lies on the walls of its domain. Inside is x < f. Page k owns the
// vertices of time k (the last page those of its end too) and takes those of time k + 1 as a run.
struct Sheet {
  struct Page {
    std::vector<Vec4f> vertices;
    std::vector<hypermesh::Run> runs;
    std::vector<hypermesh::Tet> tets;
    Bounds4f bounds;
  };
  hypermesh::MeshHeader header{};
  std::vector<double> times;
  std::vector<Page> pages;
};
Sheet makeSheet(std::size_t cells, std::size_t slabs);

// A sample file: its name, and what writes it to a path.
struct Sample {
  std::string name;
  std::uint32_t payload;
  bool exact;  // its bytes depend on this project alone (no compressor)
  std::function<Status(const std::string& path)> write;
};
// Grids, hypermeshes, dynamic triangles, surface sequences and patch DAGs: raw and zstd (if built), with columns, empty
// pages, no pages, one element.
const std::vector<Sample>& samples();
const Sample& sampleNamed(const std::string& name);

// The dynamic triangles of a page of a sheet, by the table of formats/core; positions: own vertices, then foreign ones.
// In two bands: those that live longer than half the page's interval, and the others, three intervals each.
struct TrianglePage {
  std::vector<Vec4f> vertices;
  std::vector<dyntri::Edge> edges;
  std::vector<dyntri::Lifespan> lifespans;
  std::vector<dyntri::Triangle> triangles;
  std::vector<dyntri::Band> bands;
  std::vector<dyntri::Alive> index;
  std::uint64_t empty = 0, part = 0;
  dyntri::PageView view() const { return {vertices, edges, lifespans, triangles, bands, index, {}, part}; }
};
TrianglePage trianglesOf(const std::vector<Vec4f>& positions, const std::vector<hypermesh::Tet>& tets);

// Opens any payload and verifies everything. `opened`: whether open() succeeded.
Status openAndVerify(const std::string& path, std::uint32_t payload, bool* opened = nullptr);

}  // namespace tet4d::test

// Cells of a mesh that is simplified out of core, as temporary files: what scatter() writes for a cell, what a cell's
// simplification leaves. Private to qslim4d.
//
// Vertices keep the numbers they have in the input. A vertex that several cells use stands in each of them, with its
// values of columns, and its quadric and what columns have in the metric in parts whose sum is the whole.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/outofcore/work_folder.h"
#include "libpreprocess/qslim4d/non_manifold.h"
#include "libpreprocess/qslim4d/simplify.h"

namespace tet4d::qslim4d {

struct CellVertex {
  std::uint64_t id;
  Vec4f at;
  std::uint32_t flags;  // kUncounted
  std::uint32_t reserved;
};
struct CellQuadric {
  std::uint64_t id;
  Quadric quadric;  // about the vertex
};
static_assert(sizeof(CellVertex) == 32 && sizeof(CellQuadric) == 136);

// What a vertex carries beside its place, as runs of numbers: values of its columns in their order; and for what is in
// the metric the quadric of Columns::squares and the AttributeTerms of Columns::sums.
struct VertexLoad {
  std::size_t values = 0;  // floats
  std::size_t sums = 0;    // doubles; 0: no column is in the metric
  std::uint64_t bytes() const { return values * sizeof(float) + sums * sizeof(double); }
};
VertexLoad loadOf(std::span<const SlimColumn> columns);

// Which part of a file is simplified, and in which of its tries under a promise; 0 where there is one only.
struct PartTry {
  std::size_t part = 0, number = 0;
  std::string suffix() const;  // of lines in the journal and names of files; empty for the first of the first
};

// Files of one sweep in the work folder. Before a cell is simplified it has vertices, in slots that its tetrahedra name
// (a vertex may have several), their values, quadrics, sums beside each of these, and the numbers of vertices that
// other cells use too; afterwards a result.
class CellPaths {
 public:
  CellPaths(const outofcore::WorkFolder& folder, std::size_t sweep, const PartTry& which = {})
      : prefix_(folder.file("sweep" + std::to_string(sweep) + which.suffix() + ".")) {}
  std::string plan() const { return prefix_ + "plan"; }
  std::string vertices() const { return prefix_ + "vertices"; }  // prefixes of BucketFiles
  std::string values() const { return prefix_ + "values"; }
  std::string tets() const { return prefix_ + "tets"; }
  std::string sums() const { return prefix_ + "sums"; }
  std::string quadrics() const { return prefix_ + "quadrics"; }
  std::string shared() const { return prefix_ + "shared"; }
  std::string users() const { return prefix_ + "users"; }
  std::string result(std::size_t cell) const { return prefix_ + "result." + std::to_string(cell); }

 private:
  std::string prefix_;
};

// A cell with local numbers; vertices ascend by id.
struct LoadedCell {
  std::vector<std::uint64_t> ids;
  std::vector<Vec4f> positions;
  std::vector<std::uint8_t> flags;  // kLocked, kUncounted
  std::vector<Quadric> quadrics;    // empty in the first sweep
  std::vector<hypermesh::Tet> tets;
  Columns columns;  // sums and squares as the quadrics
};

// with_quadrics: there are any, and sums. columns: those that vertices carry, without values. O(cell log cell).
LoadedCell loadCell(const CellPaths& paths, std::size_t cell, bool with_quadrics,
                    std::span<const SlimColumn> columns = {});
// What loading and holding it takes, before makeSlimMesh(), but for columns.
std::uint64_t loadBytes(std::uint64_t slots, std::uint64_t tets);
void removeCell(const CellPaths& paths, std::size_t cell);

// What is left of a cell, and what it was.
struct ResultHeader {
  std::uint64_t vertices, tets;
  std::uint64_t tets_in;
  double free_share;  // of its vertices: not locked
  VertexLoad load;
  NonManifold non_manifold;  // found for the first time
  Stats stats;
};

// A part of a mesh with local numbers, as spans: a page of the input, or the result of a cell.
struct Piece {
  std::span<const std::uint64_t> ids;
  std::span<const Vec4f> positions;
  std::span<const std::uint8_t> flags;  // kUncounted; empty: a page of the input
  std::span<const Quadric> quadrics;    // as the flags
  std::span<const float> values;        // VertexLoad::values for each vertex
  std::span<const double> sums;         // VertexLoad::sums for each vertex, where there are quadrics
  std::span<const hypermesh::Tet> tets;
  double expected = 1;  // how many should be left in the end for each tetrahedron
};

// ids: of the vertices of `mesh`. first: it was the first sweep.
void writeResult(const std::string& path, const SlimMesh& mesh, std::span<const std::uint64_t> ids, bool first,
                 const Stats& stats, const NonManifold& found = {});
ResultHeader readResultHeader(const std::string& path);

// Memory of the result; the spans of piece() point into it.
struct CellResult {
  ResultHeader header{};
  std::vector<std::uint64_t> ids;
  std::vector<Vec4f> positions;
  std::vector<std::uint8_t> flags;
  std::vector<float> values;
  std::vector<Quadric> quadrics;
  std::vector<double> sums;
  std::vector<hypermesh::Tet> tets;
  Piece piece(double expected) const { return {ids, positions, flags, quadrics, values, sums, tets, expected}; }
};
// What is read of a result: the mesh alone, with its values, or all.
enum class ResultWants { kMesh, kValues, kAll };
CellResult readResult(const std::string& path, ResultWants wants);

// Pieces that are visited one after the other, in an order that is always the same.
using VisitPiece = std::function<void(const Piece&)>;
using PieceSource = std::function<void(const VisitPiece&)>;

}  // namespace tet4d::qslim4d

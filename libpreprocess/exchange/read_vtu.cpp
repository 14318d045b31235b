// Unstructured grids of VTK: points, tetrahedra and one scalar.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/header_text.h"
#include "libpreprocess/exchange/tet_mesh_formats.h"
#include "libpreprocess/exchange/vtk_array.h"
#include "libpreprocess/exchange/vtk_selection.h"

namespace tet4d::exchange {
namespace {

constexpr std::uint64_t kTetra = 10;
constexpr const char* kMakeAgain = "write the file again";

std::string cellTypeName(std::uint64_t type) {
  constexpr std::array<const char*, 15> kNames{"empty cell",  "vertex",         "poly-vertex", "line",  "poly-line",
                                               "triangle",    "triangle strip", "polygon",     "pixel", "quadrilateral",
                                               "tetrahedron", "voxel",          "hexahedron",  "wedge", "pyramid"};
  if (type < kNames.size()) return kNames[static_cast<std::size_t>(type)];
  if (type == 24) return "tetrahedron of ten nodes";
  return type == 42 ? "polyhedron" : "type " + std::to_string(type);
}

// Whole numbers of an array one after the other, through a fixed buffer.
class Counts {
 public:
  explicit Counts(std::unique_ptr<VtkArray> array) : array_(std::move(array)) {}
  // Value i, below size().
  std::uint64_t at(std::uint64_t i) {
    if (i < first_ || i - first_ >= buffer_.size()) {
      first_ = i;
      buffer_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(std::uint64_t{1} << 13, array_->values() - i)));
      array_->readCounts(first_, buffer_);
    }
    return buffer_[static_cast<std::size_t>(i - first_)];
  }
  std::uint64_t size() const { return array_->values(); }

 private:
  std::unique_ptr<VtkArray> array_;
  std::uint64_t first_ = 0;
  std::vector<std::uint64_t> buffer_;
};

class VtuReader {
 public:
  VtuReader(const std::string& path, const TetMeshOptions& options)
      : options_(options), file_(std::make_shared<InputFile>(path)), document_(readVtkDocument(*file_)) {
    mesh_.path = path;
  }

  TetMesh read() {
    if (document_.type != "UnstructuredGrid") {
      document_.fail(document_.root, "the file is of type " + inQuotes(document_.type) + ", expected UnstructuredGrid",
                     "give a mesh of tetrahedra (.vtu)");
    }
    const XmlElement& grid = document_.dataset();
    for (const XmlElement& piece : grid.children) {
      if (piece.name == "Piece") readPiece(piece);
    }
    if (mesh_.tets.empty()) document_.fail(grid, "the mesh has no tetrahedra", "give a mesh of tetrahedra");
    return std::move(mesh_);
  }

 private:
  const XmlElement& child(const XmlElement& piece, const char* name) const {
    if (const XmlElement* found = piece.child(name)) return *found;
    document_.fail(piece, std::string("the piece has no <") + name + ">", kMakeAgain);
  }

  std::unique_ptr<VtkArray> open(const XmlElement& parent, std::string_view name, std::uint64_t tuples) const {
    for (const XmlElement& array : parent.children) {
      const std::string* array_name = array.attribute("Name");
      const bool fits = name.empty() || (array_name != nullptr && *array_name == name);
      if (array.name == "DataArray" && fits) return openVtkArray(document_, array, file_, tuples);
    }
    document_.fail(parent, "it has no array " + inQuotes(name), kMakeAgain);
  }

  void readPiece(const XmlElement& piece) {
    const std::uint64_t points = document_.needCount(piece, "NumberOfPoints");
    const std::uint64_t cells = document_.needCount(piece, "NumberOfCells");
    const std::uint64_t first = mesh_.points.size();
    if (points > std::numeric_limits<std::uint32_t>::max() - first) {
      document_.fail(piece, "the mesh has 2^32 points or more", "cut it into parts");
    }
    readPoints(piece, points);
    if (!options_.scalar.empty()) readScalar(piece, first, points);
    if (cells > 0) readCells(piece, first, points, cells);
  }

  void readPoints(const XmlElement& piece, std::uint64_t points) {
    const XmlElement& element = child(piece, "Points");
    if (points == 0) return;
    const auto array = open(element, "", points);
    if (array->components() != 3) document_.fail(element, "its points do not have three coordinates", kMakeAgain);
    const std::size_t first = mesh_.points.size();
    mesh_.points.resize(first + static_cast<std::size_t>(points));
    array->readNumbers(0, std::span(mesh_.points[first].data(), static_cast<std::size_t>(points) * 3));
    for (std::size_t i = first; i < mesh_.points.size(); ++i) checkPoint(mesh_, i);
  }

  void readScalar(const XmlElement& piece, std::uint64_t first, std::uint64_t points) {
    if (hasSelection(piece)) {
      const VtkSelection selection = selectVtkScalar(document_, piece, options_.scalar);
      const XmlElement& element = selectedArray(document_, piece, selection);
      if (selection.of_cells) {
        document_.fail(element, "it is of cells, a scalar of points is needed",
                       "convert it (in ParaView: Cell Data to Point Data)");
      }
      const auto array = openVtkArray(document_, element, file_, points);
      const std::uint64_t components = array->components();
      mesh_.scalar.resize(static_cast<std::size_t>(first + points));
      if (components == 1) {
        array->readNumbers(0, std::span(mesh_.scalar).subspan(static_cast<std::size_t>(first)));
        return;
      }
      for (std::uint64_t i = 0; i < points; ++i) {
        array->readNumbers(i * components + selection.component,
                           std::span(&mesh_.scalar[static_cast<std::size_t>(first + i)], 1));
      }
      return;
    }
    takeCoordinate(mesh_, options_.scalar);
  }

  // Whether to look for an array: a coordinate is meant only where none is of that name.
  bool hasSelection(const XmlElement& piece) const {
    if (!isCoordinate(options_.scalar)) return true;
    const XmlElement* data = piece.child("PointData");
    return data != nullptr && std::any_of(data->children.begin(), data->children.end(), [&](const XmlElement& array) {
             const std::string* name = array.attribute("Name");
             return name != nullptr && *name == options_.scalar;
           });
  }

  void readCells(const XmlElement& piece, std::uint64_t first, std::uint64_t points, std::uint64_t cells) {
    const XmlElement& element = child(piece, "Cells");
    Counts types(open(element, "types", cells)), offsets(open(element, "offsets", cells));
    std::uint64_t tets = 0;
    for (std::uint64_t i = 0; i < cells; ++i) {
      if (types.at(i) == kTetra) {
        ++tets;
      } else if (!options_.tets_only) {
        fail(i, "is a " + cellTypeName(types.at(i)) + ", not a tetrahedron",
             "cut other cells into tetrahedra (in ParaView: Tetrahedralize), or leave them out with --tets-only");
      }
    }
    mesh_.other_cells += cells - tets;
    Counts corners(open(element, "connectivity", offsets.at(cells - 1)));
    mesh_.tets.reserve(mesh_.tets.size() + static_cast<std::size_t>(tets));
    for (std::uint64_t i = 0, begin = 0; i < cells; ++i) {
      const std::uint64_t end = offsets.at(i);
      if (end < begin || end > corners.size()) {
        fail(i, "ends at " + std::to_string(end) + " of the connectivity, which is out of order", kMakeAgain);
      }
      if (types.at(i) == kTetra) addTet(i, {begin, end}, corners, first, points);
      begin = end;
    }
  }

  void addTet(std::uint64_t cell, std::pair<std::uint64_t, std::uint64_t> range, Counts& corners, std::uint64_t first,
              std::uint64_t points) {
    if (range.second - range.first != 4) {
      fail(cell, "is a tetrahedron of " + std::to_string(range.second - range.first) + " vertices", kMakeAgain);
    }
    std::array<std::uint32_t, 4> tet{};
    for (std::size_t c = 0; c < 4; ++c) {
      const std::uint64_t corner = corners.at(range.first + c);
      if (corner >= points) {
        fail(cell, "vertex id " + std::to_string(corner) + ", but there are " + std::to_string(points) + " points",
             kMakeAgain);
      }
      tet[c] = static_cast<std::uint32_t>(first + corner);
    }
    mesh_.tets.push_back(tet);
  }

  [[noreturn]] void fail(std::uint64_t cell, const std::string& what, const std::string& remedy) const {
    throw Error(FaultCode::kBadInput, mesh_.path, "cell " + std::to_string(cell), what, remedy);
  }

  const TetMeshOptions& options_;
  std::shared_ptr<const InputFile> file_;
  VtkDocument document_;
  TetMesh mesh_;
};

}  // namespace

TetMesh readVtu(const std::string& path, const TetMeshOptions& options) { return VtuReader(path, options).read(); }

}  // namespace tet4d::exchange

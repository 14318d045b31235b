// Which array of a VTK file is meant: by its name, or the one there is.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libpreprocess/exchange/vtk_document.h"

namespace tet4d::exchange {

// A scalar of a file: an array, or a component of one.
struct VtkSelection {
  std::string name;             // of the array
  std::uint64_t component = 0;  // to read of its components
  bool of_cells = false;        // in CellData, otherwise in PointData
};

// The scalar `wanted` of a <Piece>: "p", or "U:1" for the second component of U; an array of that very name comes
// first, one of points before one of cells. If it is empty: the active Scalars, or the only array of one component.
// Throws Error{kBadInput} that lists the arrays and names the nearest.
VtkSelection selectVtkScalar(const VtkDocument& document, const XmlElement& piece, const std::string& wanted);

// The array of a selection in a piece, which must be there.
const XmlElement& selectedArray(const VtkDocument& document, const XmlElement& piece, const VtkSelection& selection);

// Numeric arrays of <PointData> or <CellData>, as "p", "U (3 components)", for messages.
std::string listVtkArrays(const VtkDocument& document, const XmlElement& piece);

// "U:1" as the array U and the component 1; without a colon and a number, the whole name and nothing.
std::pair<std::string, std::optional<std::uint64_t>> splitComponent(const std::string& name);

}  // namespace tet4d::exchange

// How far the columns of two hypermeshes' slices are from each other, at places that lie nearest.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/outofcore/progress.h"

namespace tet4d::measure {

struct ColumnDistance {
  std::string name;
  // In the column's own unit, over all vertices of both slices: the difference to the value, interpolated, at the
  // nearest point of the other slice; of several components its length.
  double rms = 0, max = 0;
  std::uint64_t samples = 0, unknown = 0;  // unknown: not finite on a side, left out
};

// Compares the columns that both files have, by name and components, at the frames given (phase "measure columns").
// O(vertices of the slices log triangles); memory of two slices with columns and a tree.
std::vector<ColumnDistance> compareColumns(const hypermesh::File& mesh, const hypermesh::File& reference,
                                           const std::vector<double>& frames, outofcore::Progress& progress);

}  // namespace tet4d::measure

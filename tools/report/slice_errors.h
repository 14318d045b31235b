// Errors of a hypermesh's slices, over several times.
#pragma once

#include <string>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/exchange/world_mesh.h"
#include "libpreprocess/measure/surface_distance.h"
#include "tools/report/rows.h"

namespace tet4d::report {

// Of several slices: the largest of each, and the root mean square of rms.
class SliceErrors {
 public:
  void add(double max, double bound, double p99, double rms);
  void addSize(double area_error, double volume_error);
  // "max_<kind>_cells" and so on: lengths divided by `cell`; in world units too, "max_<kind>".
  void write(Row& row, const std::string& kind, double cell) const;
  // … without area and volume.
  void writeLengths(Row& row, const std::string& kind, double cell) const;
  double rms() const;

 private:
  double max_ = 0, bound_ = 0, p99_ = 0, squares_ = 0, area_ = 0, volume_ = 0;
  std::size_t slices_ = 0;
};

exchange::WorldMesh sliceAt(const hypermesh::File& mesh, double time);

struct Size {
  double area = 0, volume = 0;
  bool closed = false;
};
Size sizeOf(const exchange::WorldMesh& mesh);

}  // namespace tet4d::report

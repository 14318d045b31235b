#include "libpreprocess/qslim4d/part_pages.h"

#include <algorithm>
#include <string>

#include "libpreprocess/error.h"

namespace tet4d::qslim4d {

PartPages::PartPages(const hypermesh::File& file) : parts_(std::max<std::size_t>(1, file.parts().size())) {
  const auto fail = [&](std::size_t page, const std::string& what) {
    throw Error(FaultCode::kBadInput, file.reader().path(), "page " + std::to_string(page), what,
                "make the file again");
  };
  std::uint64_t first = 0, tets = 0;
  for (std::size_t k = 0; k < file.geometryPages(); ++k) {
    const auto& counts = file.geometryEntry(k).counts;
    if (counts[0] != first)
      fail(k, "its first vertex is " + std::to_string(counts[0]) + ", expected " + std::to_string(first));
    first += counts[1], tets += counts[2];
    Part& part = parts_[file.parts().empty() ? 0 : unwrap(file.partOf(k))];
    part.pages.push_back(k);
    part.ranges.push_back({counts[0], first});
    part.tets += counts[2];
  }
  if (first == file.header().vertices && tets == file.header().tets) return;
  fail(file.geometryPages(), "the pages hold " + std::to_string(first) + " vertices and " + std::to_string(tets) +
                                 " tetrahedra, the header tells of " + std::to_string(file.header().vertices) +
                                 " and " + std::to_string(file.header().tets));
}

bool PartPages::owns(std::size_t part, std::uint64_t vertex) const {
  const std::vector<Range>& ranges = parts_[part].ranges;
  const auto after = std::upper_bound(ranges.begin(), ranges.end(), vertex,
                                      [](std::uint64_t v, const Range& range) { return v < range.first; });
  return after != ranges.begin() && vertex < std::prev(after)->end;
}

}  // namespace tet4d::qslim4d

// Which pages of a file belong to which of its parts. Private to qslim4d.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/hypermesh.h"

namespace tet4d::qslim4d {

class PartPages {
 public:
  // Reads all pages of a file with parts, one at a time. Throws Error{kBadInput} if the pages' own vertices are not the
  // numbers 0, 1, 2 … in order or the counts are not those of the header; Error of a damaged page.
  explicit PartPages(const hypermesh::File& file);

  // One for a file without parts.
  std::size_t parts() const { return parts_.size(); }
  const std::vector<std::size_t>& pages(std::size_t part) const { return parts_[part].pages; }
  std::uint64_t tets(std::size_t part) const { return parts_[part].tets; }
  // Whether a page of the part owns this vertex. O(log pages).
  bool owns(std::size_t part, std::uint64_t vertex) const;

 private:
  struct Range {
    std::uint64_t first, end;  // vertices
  };
  struct Part {
    std::vector<std::size_t> pages;
    std::vector<Range> ranges;  // ascending
    std::uint64_t tets = 0;
  };
  std::vector<Part> parts_;
};

}  // namespace tet4d::qslim4d

// One page of a column, read apart from what is drawn: to learn where a column's values lie.
#pragma once

#include <cstddef>
#include <span>

#include "formats/dynamic_triangles.h"
#include "player/stream/page_buffer.h"

namespace tet4d::stream {

struct ColumnPage {
  PageBuffer buffer;
  std::span<const float> rows;  // components * vertices of the page, within buffer
};

// Column `column` of geometry page `page`, read into memory of its own and checked. Any thread; O(its bytes). Fault:
// the file cannot be read, the page fails its checksum, or there is no memory for it.
Result<ColumnPage> readColumnPage(const dyntri::File& file, std::size_t column, std::size_t page);

}  // namespace tet4d::stream

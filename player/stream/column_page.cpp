#include "player/stream/column_page.h"

#include <string>
#include <utility>

namespace tet4d::stream {

Result<ColumnPage> readColumnPage(const dyntri::File& file, std::size_t column, std::size_t page) {
  const std::size_t number = file.tablePage(page) + 1 + column;
  const paged::PageEntry& entry = file.pages().entries()[number];
  const bool is_raw = entry.codec == static_cast<std::uint32_t>(paged::Codec::kRaw);
  PageBuffer decoded(entry.raw_bytes), stored(is_raw ? 0 : entry.bytes);
  if (decoded.empty() || (!is_raw && stored.empty())) {
    return Fault{FaultCode::kOutOfMemory, file.reader().path(), "page " + std::to_string(number),
                 "no memory for " + std::to_string(entry.raw_bytes) + " bytes", "give the program more memory"};
  }
  const std::span<std::byte> from = is_raw ? decoded.bytes() : stored.bytes();
  if (Status status = file.pages().readStored(number, from); !status.ok()) return status.fault();
  if (Status status = file.pages().decode(number, from, decoded.bytes()); !status.ok()) return status.fault();
  // Its size was proved when the file was opened; its values may be any.
  const std::uint64_t values = file.geometryEntry(page).counts[0] * file.columns()[column].components;
  ColumnPage made{std::move(decoded), {}};
  made.rows = {reinterpret_cast<const float*>(made.buffer.bytes().data()), values};
  return made;
}

}  // namespace tet4d::stream

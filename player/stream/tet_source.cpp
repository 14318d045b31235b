#include "player/stream/tet_source.h"

#include <algorithm>
#include <utility>

namespace tet4d::stream {

void TetSource::beginFrame() {
  ++frame_;
  bytes_touched_ = 0;
  while (bytes_ > budget_bytes_) {
    const auto oldest = std::min_element(slots_.begin(), slots_.end(), [](const auto& a, const auto& b) {
      return a.second.last_frame < b.second.last_frame;
    });
    bytes_ -= oldest->second.bytes;
    slots_.erase(oldest);
  }
}

Status TetSource::load(std::size_t page) {
  if (const auto found = slots_.find(page); found != slots_.end()) {
    found->second.last_frame = frame_;
    return {};
  }
  auto gathered = file_->gather(page);
  if (!gathered.ok()) return gathered.fault();
  Slot slot{std::move(gathered).value(), 0, frame_};
  slot.bytes = slot.page.positions.size() * sizeof(Vec4f) + slot.page.view.tets.size_bytes();
  bytes_ += slot.bytes;
  bytes_touched_ += file_->geometryEntry(page).bytes;
  slots_.emplace(page, std::move(slot));
  return {};
}

std::optional<TetPage> TetSource::residentTets(std::size_t page) const {
  const auto found = slots_.find(page);
  if (found == slots_.end()) return std::nullopt;
  return TetPage{found->second.page.positions, found->second.page.view.tets};
}

}  // namespace tet4d::stream

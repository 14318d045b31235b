#include "player/stream/page_source.h"

#include <utility>

namespace tet4d::stream {

PageSource::PageSource(const dyntri::File& file, std::uint64_t budget_bytes)
    : file_(&file), budget_bytes_(budget_bytes), slots_(file.geometryPages()) {}

void PageSource::beginFrame() {
  ++frame_;
  bytes_touched_ = 0;
}

Status PageSource::load(std::size_t page) {
  Slot& slot = slots_[page];
  if (!slot.is_resident) {
    auto loaded = file_->loadGeometry(page);
    if (!loaded.ok()) return loaded.fault();
    bytes_touched_ += loaded.value().touched();
    auto view =
        dyntri::validatePage(loaded.value().bytes(), entry(page), file_->reader().path(), file_->tablePage(page));
    if (!view.ok()) return view.fault();
    // A decoded page's bytes live on the heap, a raw one's in the mapping: moving PageBytes leaves the view valid.
    slot.bytes = std::move(loaded).value();
    slot.view = view.value();
    slot.is_resident = true;
    resident_bytes_ += entry(page).raw_bytes;
  }
  slot.last_frame = frame_;
  slot.last_use = ++uses_;
  return {};
}

const dyntri::PageView* PageSource::resident(std::size_t page) const {
  return slots_[page].is_resident ? &slots_[page].view : nullptr;
}

void PageSource::evict() {
  while (resident_bytes_ > budget_bytes_) {
    std::size_t oldest = slots_.size();
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      if (!slots_[i].is_resident || slots_[i].last_frame == frame_) continue;
      if (oldest == slots_.size() || slots_[i].last_use < slots_[oldest].last_use) oldest = i;
    }
    if (oldest == slots_.size()) return;  // all that is left belongs to this frame
    resident_bytes_ -= entry(oldest).raw_bytes;
    slots_[oldest] = Slot{};
  }
}

}  // namespace tet4d::stream

// Residency of a file's pages: what is in memory, checked and validated, within a byte budget.
//
// load() is the only place where the player reads a file; it checks a page's checksum, decodes it and proves its
// content once, before a chooser or a renderer sees it. The chooser asks resident() and draws what is there. Ponchio &
// Hormann 2008, sec. 6.3 (pages are mapped one by one when needed).
//
// One thread at a time for now. The calls are split so that threads can come in behind them: load() is a request whose
// effect is seen by resident(), and nothing a frame uses is evicted before the next beginFrame().
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/dynamic_triangles.h"
#include "player/stream/residency.h"

namespace tet4d::stream {

class PageSource final : public Residency {
 public:
  // `file` must outlive the source. budget_bytes: of decoded pages; a frame whose own pages exceed it is still whole.
  PageSource(const dyntri::File& file, std::uint64_t budget_bytes);

  std::size_t size() const { return slots_.size(); }
  const paged::PageEntry& entry(std::size_t page) const { return file_->geometryEntry(page); }

  // A new frame begins: pages used by earlier frames may be evicted, bytesTouched() restarts at 0.
  void beginFrame();

  // Brings page `page` in if it is not resident, and marks it as used by this frame. A Fault names file and page; the
  // page then stays absent. O(page) when it comes in, O(1) when it is there.
  Status load(std::size_t page);

  // The page, or nullptr if it is not resident. Never reads. Valid until the page is evicted, which does not happen
  // within the frame that loaded it.
  const dyntri::PageView* resident(std::size_t page) const override;

  // Drops least recently used pages, none of the current frame, until the budget holds. O(pages) per page dropped.
  void evict();

  // Stored bytes read from the file since beginFrame().
  std::uint64_t bytesTouched() const { return bytes_touched_; }
  // Decoded bytes of the resident pages.
  std::uint64_t residentBytes() const { return resident_bytes_; }

 private:
  struct Slot {
    bool is_resident = false;
    std::uint64_t last_frame = 0;  // the frame that used it last
    std::uint64_t last_use = 0;    // the load() that used it last
    paged::PageBytes bytes;        // keeps the view alive
    dyntri::PageView view;
  };

  const dyntri::File* file_;
  std::uint64_t budget_bytes_;
  std::uint64_t frame_ = 1, uses_ = 0;
  std::uint64_t bytes_touched_ = 0, resident_bytes_ = 0;
  std::vector<Slot> slots_;
};

}  // namespace tet4d::stream

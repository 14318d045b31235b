// Brings a file's pages in beside drawing, within a budget of bytes, in the order in which they are needed.
//
// One thread draws: it calls everything here. Threads behind it read (pread into memory of our own: nothing that is
// handed out is mapped, so drawing never faults, also when the file is cut off) and check, decode and prove. A frame:
//   beginFrame(); want(pages of this frame and of those to come); [waitFor(pages of this frame)]; resident() …
// Ponchio & Hormann 2008, sec. 6.3, pages by name; here they come before they are asked for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "formats/dynamic_triangles.h"
#include "player/stream/residency.h"

namespace tet4d::stream {

struct PagerOptions {
  // Of decoded pages and of what is on the way. The pages of the frame itself may exceed it, nothing else.
  std::uint64_t budget_bytes = std::numeric_limits<std::uint64_t>::max();
  unsigned io_threads = 1, decode_threads = 1;  // at least 1
};

struct PageSlot;

struct Want {
  std::size_t page = 0;
  double urgency = 0;  // time until it is needed, in any unit; 0: by this frame. Finite, not negative
};

class Pager final : public Residency {
 public:
  // `file` must outlive the pager.
  Pager(const dyntri::File& file, const PagerOptions& options);
  ~Pager() override;
  Pager(const Pager&) = delete;
  Pager& operator=(const Pager&) = delete;

  std::size_t size() const { return visible_.size() / stride_; }

  // From the next want() on. What is held beyond a smaller budget goes as new pages make room, the frame's own last.
  void setBudget(std::uint64_t bytes);
  std::uint64_t budget() const;

  // The columns that come with each page from now on, by number; none at first. Others are not read.
  void useColumns(std::span<const std::size_t> columns);

  // A new frame: what has arrived shows, the counts of a frame restart. O(arrived).
  void beginFrame();

  // All pages that this frame and those to come need; once a frame, before resident() is asked. Kept and brought in,
  // most urgent first, as far as the budget goes; less urgent ones are neither read nor kept. Pages that are not listed
  // stay while there is room, and make it, those used longest ago first. O(n log n) of the wants and the resident
  // pages.
  void want(std::span<const Want> wants);

  // Waits until each of `pages`, all wanted with urgency 0, is resident or found damaged.
  void waitFor(std::span<const std::size_t> pages);

  const dyntri::PageView* resident(std::size_t page) const override;
  std::span<const float> residentColumn(std::size_t page, std::size_t column) const override;

  // Why a page, or a column in use of it, cannot come in, or null. It is not read again.
  const Fault* faultOf(std::size_t page) const;
  // Faults found since the last call, each page once; that the file was changed or replaced while open is among them
  // (kIo, no place), once.
  std::vector<Fault> takeFaults();

  // Stored bytes. A page is touched by the first frame that uses it after it was read.
  struct FrameReads {
    std::uint64_t touched = 0;
    std::uint64_t prefetched = 0;  // of them, what had come before a frame needed it
  };
  FrameReads frameReads() const { return frame_reads_; }
  struct Totals {
    std::uint64_t read = 0;    // stored bytes read so far
    std::uint64_t unused = 0;  // of them, what no frame has used
    std::uint64_t held = 0;    // decoded bytes in memory now, pages on the way included
    std::uint64_t peak = 0;    // the most of `held`
  };
  Totals totals() const;

 private:
  struct State;
  void absorb();
  bool makeRoom(std::uint64_t bytes);
  void keepWanted(std::vector<Want>& wants);
  std::vector<Want> withColumns(std::span<const Want> wants) const;

  std::size_t stride_;                    // entries of the page table to a page: itself and its columns
  std::vector<std::size_t> in_use_;       // of them, from 0: the page, then columns
  std::vector<const PageSlot*> visible_;  // by entry; the drawing thread's own: changes only in its calls
  FrameReads frame_reads_;
  std::uint64_t frame_ = 1;
  std::unique_ptr<State> state_;
};

}  // namespace tet4d::stream

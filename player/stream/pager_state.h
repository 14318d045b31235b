// What the drawing thread and the threads behind it share. Private to player/stream.
#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "player/stream/page_buffer.h"
#include "player/stream/pager.h"

namespace tet4d::stream {

enum class Phase : unsigned char {
  kAbsent,
  kQueued,    // to be read
  kReading,   // an I/O thread has it
  kRead,      // to be decoded
  kDecoding,  // a decoding thread has it
  kArrived,   // proved, not yet shown to the drawing thread
  kResident,
  kDamaged,
};

struct PageSlot {
  Phase phase = Phase::kAbsent;
  bool doomed = false;       // on the way and no longer wanted: dropped when it arrives
  bool used = false;         // by a frame, since it was read
  bool was_awaited = false;  // a frame needed it before it came
  double urgency = 0;
  std::uint64_t wanted = 0;       // the call of want() that kept it last
  std::uint64_t last_frame = 0;   // the frame that used it last
  std::uint64_t charge = 0;       // bytes counted in `charged`
  PageBuffer stored, decoded;     // stored: of compressed pages, until decoded
  dyntri::PageView view;          // of a page
  std::span<const float> column;  // of a column's page
};

struct Pager::State {
  State(const dyntri::File& source, const PagerOptions& options);
  ~State();

  const dyntri::File& file;
  mutable std::mutex mutex;
  std::condition_variable to_read, to_decode, arrival;
  std::uint64_t budget;  // with the mutex held, as all below
  bool stopping = false, look_at_file = false, was_changed = false, was_replaced = false;
  std::vector<PageSlot> slots;          // by entry of the page table, as everything here
  std::vector<std::size_t> queue;       // kQueued, most urgent last
  std::vector<std::size_t> undecoded;   // kRead
  std::vector<std::size_t> on_the_way;  // kReading to kDecoding
  std::vector<std::size_t> arrived;     // kArrived
  std::vector<std::size_t> resident;    // kResident
  std::vector<PageBuffer> dropped;      // to be given back by a thread behind
  std::map<std::size_t, Fault> faults;  // of damaged pages
  std::vector<Fault> new_faults;
  std::uint64_t wants = 0;    // calls of want()
  std::uint64_t charged = 0;  // what is resident and what was let in, doomed pages not counted
  std::uint64_t held = 0;     // bytes of buffers that exist
  std::uint64_t peak = 0, read = 0, unused = 0;
  std::size_t doomed = 0, freeing = 0;  // pages doomed on the way; threads that give buffers back

  const paged::PageEntry& entry(std::size_t page) const { return file.pages().entries()[page]; }
  bool isCompressed(std::size_t page) const {
    return entry(page).codec != static_cast<std::uint32_t>(paged::Codec::kRaw);
  }
  std::uint64_t storedCost(std::size_t page) const {
    return isCompressed(page) ? PageBuffer::cost(entry(page).bytes) : 0;
  }
  std::uint64_t cost(std::size_t page) const { return PageBuffer::cost(entry(page).raw_bytes) + storedCost(page); }

  // With the mutex held.
  void release(PageSlot& slot);  // its charge
  void fail(std::size_t page, const Fault& fault);
  // A page that is no longer wanted leaves the way it is on.
  void abandon(std::size_t page);
  void leaveTheWay(std::size_t page);
  void drop(PageBuffer& buffer);

 private:
  using Lock = std::unique_lock<std::mutex>;
  void readPages();
  void decodePages();
  Status prove(std::size_t page);
  bool takeRoom(Lock& lock, std::size_t page);
  void readOne(Lock& lock, std::size_t page);
  void decodeOne(Lock& lock, std::size_t page);
  void freeDropped(Lock& lock);
  void lookAtFile(Lock& lock);
  std::size_t takeMostUrgent(std::vector<std::size_t>& pages) const;

  std::vector<std::jthread> threads_;  // last: they stop before the rest goes
};

}  // namespace tet4d::stream

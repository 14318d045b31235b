// The threads behind a pager: they read, check, decode and prove.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "player/stream/pager_state.h"

namespace tet4d::stream {
namespace {

Fault noMemory(const std::string& path, std::size_t page, std::uint64_t bytes) {
  return {FaultCode::kOutOfMemory, path, "page " + std::to_string(page),
          "no memory for " + std::to_string(bytes) + " bytes", "give the program more memory"};
}

// Whoever draws goes first: pages that a film will need are fetched in what time that leaves, and a page that is waited
// for has the machine to itself. A wish; a system that does not grant it plays with stalls.
void stepBack() { static_cast<void>(setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 10)); }

}  // namespace

Pager::State::State(const dyntri::File& source, const PagerOptions& options)
    : file(source), budget(options.budget_bytes), slots(source.pages().size()) {
  for (unsigned i = 0; i < std::max(options.io_threads, 1u); ++i)
    threads_.emplace_back([this] { stepBack(), readPages(); });
  for (unsigned i = 0; i < std::max(options.decode_threads, 1u); ++i)
    threads_.emplace_back([this] { stepBack(), decodePages(); });
}

Pager::State::~State() {
  {
    const std::scoped_lock lock(mutex);
    stopping = true;
  }
  to_read.notify_all();
  to_decode.notify_all();
}

void Pager::State::release(PageSlot& slot) { charged -= std::exchange(slot.charge, 0); }

void Pager::State::fail(std::size_t page, const Fault& fault) {
  PageSlot& slot = slots[page];
  if (std::exchange(slot.doomed, false)) --doomed;
  release(slot);
  leaveTheWay(page);
  slot.phase = Phase::kDamaged;
  faults.emplace(page, fault);
  new_faults.push_back(fault);
  arrival.notify_all();
  to_read.notify_all();
}

void Pager::State::leaveTheWay(std::size_t page) { std::erase(on_the_way, page); }

void Pager::State::drop(PageBuffer& buffer) {
  if (!buffer.empty()) dropped.push_back(std::exchange(buffer, {}));
}

void Pager::State::abandon(std::size_t page) {
  PageSlot& slot = slots[page];
  if (std::exchange(slot.doomed, false)) --doomed;
  release(slot);
  leaveTheWay(page);
  slot.phase = Phase::kAbsent;
  slot.was_awaited = false;
  to_read.notify_all();
}

std::size_t Pager::State::takeMostUrgent(std::vector<std::size_t>& pages) const {
  const auto first = std::min_element(
      pages.begin(), pages.end(), [&](std::size_t a, std::size_t b) { return slots[a].urgency < slots[b].urgency; });
  const std::size_t page = *first;
  pages.erase(first);
  return page;
}

void Pager::State::readPages() {
  Lock lock(mutex);
  for (;;) {
    to_read.wait(lock, [&] { return stopping || !queue.empty() || !dropped.empty() || look_at_file; });
    if (stopping) return;
    freeDropped(lock);
    if (std::exchange(look_at_file, false)) lookAtFile(lock);
    if (stopping || queue.empty()) continue;
    const std::size_t page = queue.back();
    queue.pop_back();
    slots[page].phase = Phase::kReading;
    on_the_way.push_back(page);
    if (takeRoom(lock, page)) readOne(lock, page);
  }
}

void Pager::State::freeDropped(Lock& lock) {
  if (dropped.empty()) return;
  std::vector<PageBuffer> buffers = std::exchange(dropped, {});
  std::uint64_t bytes = 0;
  for (const PageBuffer& buffer : buffers) bytes += PageBuffer::cost(buffer.bytes().size());
  ++freeing;
  lock.unlock();
  buffers.clear();
  lock.lock();
  --freeing;
  held -= bytes;
  to_read.notify_all();
}

// Waits until what was dropped is gone, so that the budget holds at every moment, and takes the page's memory. False if
// the page is no longer wanted or there is none.
bool Pager::State::takeRoom(Lock& lock, std::size_t page) {
  const std::uint64_t bytes = cost(page);
  PageSlot& slot = slots[page];
  while (bytes > budget || held > budget - bytes) {
    if (stopping) return false;
    if (slot.doomed) {
      abandon(page);
      return false;
    }
    if (!dropped.empty()) {
      freeDropped(lock);
    } else if (freeing > 0 || doomed > 0) {
      to_read.wait(lock);
    } else {
      break;  // all that is held is wanted now
    }
  }
  held += bytes;
  peak = std::max(peak, held);
  lock.unlock();
  PageBuffer decoded(entry(page).raw_bytes), stored(isCompressed(page) ? entry(page).bytes : 0);
  lock.lock();
  if (decoded.empty() || (isCompressed(page) && stored.empty())) {
    held -= bytes;
    fail(page, noMemory(file.reader().path(), page, bytes));
    return false;
  }
  slot.decoded = std::move(decoded);
  slot.stored = std::move(stored);
  return true;
}

void Pager::State::readOne(Lock& lock, std::size_t page) {
  PageSlot& slot = slots[page];
  const auto bytes = isCompressed(page) ? slot.stored.bytes() : slot.decoded.bytes();
  lock.unlock();
  const Status status = file.pages().readStored(page, bytes);
  lock.lock();
  lookAtFile(lock);
  if (status.ok()) {
    read += entry(page).bytes;
    slot.phase = Phase::kRead;
    undecoded.push_back(page);
    to_decode.notify_one();
    return;
  }
  drop(slot.decoded);
  drop(slot.stored);
  fail(page, status.fault());
}

void Pager::State::decodePages() {
  Lock lock(mutex);
  for (;;) {
    to_decode.wait(lock, [&] { return stopping || !undecoded.empty(); });
    if (stopping) return;
    const std::size_t page = takeMostUrgent(undecoded);
    slots[page].phase = Phase::kDecoding;
    decodeOne(lock, page);
  }
}

// Without the mutex: checks and decodes an entry that was read, and hands out its spans once they are proved.
Status Pager::State::prove(std::size_t page) {
  PageSlot& slot = slots[page];
  const std::span<std::byte> decoded = slot.decoded.bytes();
  const std::span<const std::byte> stored = isCompressed(page) ? slot.stored.bytes() : decoded;
  if (Status status = file.pages().decode(page, stored, decoded); !status.ok()) return status;
  const std::size_t stride = 1 + file.columns().size(), part = page % stride;
  if (part == 0) {
    const auto view = dyntri::validatePage(decoded, entry(page), file.reader().path(), page);
    if (!view.ok()) return view.fault();
    slot.view = view.value();
  } else {
    // Its size was proved when the file was opened; its values may be any.
    const std::uint64_t values = entry(page - part).counts[0] * file.columns()[part - 1].components;
    slot.column = {reinterpret_cast<const float*>(decoded.data()), values};
  }
  return {};
}

void Pager::State::decodeOne(Lock& lock, std::size_t page) {
  PageSlot& slot = slots[page];
  const bool is_hopeless = slot.doomed;
  Status proved;
  lock.unlock();
  if (!is_hopeless) proved = prove(page);
  lock.lock();
  drop(slot.stored);
  if (proved.ok() && !slot.doomed && !is_hopeless) {
    slot.charge -= storedCost(page);
    charged -= storedCost(page);
    slot.used = false;
    slot.phase = Phase::kArrived;
    leaveTheWay(page);
    arrived.push_back(page);
    arrival.notify_all();
    to_read.notify_all();
    return;
  }
  unused += entry(page).bytes;
  drop(slot.decoded);
  if (!proved.ok()) {
    fail(page, proved.fault());
  } else if (slot.doomed) {
    abandon(page);
  } else {  // wanted again after it was passed over: it is read once more
    leaveTheWay(page);
    slot.phase = Phase::kQueued;
    queue.push_back(page);
    to_read.notify_all();
  }
}

// Whether the file still is what was opened; once for each way in which it can differ.
void Pager::State::lookAtFile(Lock& lock) {
  if (was_changed && was_replaced) return;
  lock.unlock();
  const container::Reader::Fate fate = file.reader().fate();
  lock.lock();
  const std::string& path = file.reader().path();
  if (fate == container::Reader::Fate::kChanged && !std::exchange(was_changed, true)) {
    new_faults.push_back({FaultCode::kIo, path, "", "was changed while it is open",
                          "pages that no longer fit their checksums are left out: open it again"});
  }
  if (fate == container::Reader::Fate::kReplaced && !std::exchange(was_replaced, true)) {
    new_faults.push_back({FaultCode::kIo, path, "", "was replaced or removed while it is open",
                          "what was opened plays on: open the new file to see it"});
  }
}

}  // namespace tet4d::stream

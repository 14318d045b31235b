#include "player/stream/pager.h"

#include <algorithm>
#include <cassert>

#include "player/stream/pager_state.h"

namespace tet4d::stream {

Pager::Pager(const dyntri::File& file, const PagerOptions& options)
    : stride_(1 + file.columns().size()),
      in_use_{0},
      visible_(file.pages().size(), nullptr),
      state_(std::make_unique<State>(file, options)) {}

Pager::~Pager() = default;

void Pager::setBudget(std::uint64_t bytes) {
  const std::scoped_lock lock(state_->mutex);
  state_->budget = bytes;
  state_->to_read.notify_all();
}

std::uint64_t Pager::budget() const {
  const std::scoped_lock lock(state_->mutex);
  return state_->budget;
}

void Pager::useColumns(std::span<const std::size_t> columns) {
  in_use_ = {0};
  for (const std::size_t column : columns) {
    assert(column + 1 < stride_);
    in_use_.push_back(1 + column);
  }
}

const dyntri::PageView* Pager::resident(std::size_t page) const {
  const PageSlot* slot = visible_[page * stride_];
  return slot == nullptr ? nullptr : &slot->view;
}

std::span<const float> Pager::residentColumn(std::size_t page, std::size_t column) const {
  if (column + 1 >= stride_) return {};
  const PageSlot* slot = visible_[page * stride_ + 1 + column];
  return slot == nullptr ? std::span<const float>{} : slot->column;
}

// From pages to entries of the page table; from here on `page` is an entry.
std::vector<Want> Pager::withColumns(std::span<const Want> wants) const {
  std::vector<Want> all;
  all.reserve(wants.size() * in_use_.size());
  for (const Want& want : wants) {
    for (const std::size_t part : in_use_) all.push_back({want.page * stride_ + part, want.urgency});
  }
  return all;
}

// With the mutex held: what has arrived becomes visible.
void Pager::absorb() {
  for (const std::size_t page : state_->arrived) {
    PageSlot& slot = state_->slots[page];
    slot.phase = Phase::kResident;
    state_->resident.push_back(page);
    visible_[page] = &slot;
  }
  state_->arrived.clear();
}

void Pager::beginFrame() {
  constexpr std::uint64_t kFramesBetweenLooks = 32;
  const std::scoped_lock lock(state_->mutex);
  ++frame_;
  frame_reads_ = {};
  absorb();
  if (frame_ % kFramesBetweenLooks == 0) {
    state_->look_at_file = true;
    state_->to_read.notify_all();
  }
}

// With the mutex held: lets go of pages that nobody wants until `bytes` fit. False if they do not.
bool Pager::makeRoom(std::uint64_t bytes) {
  State& s = *state_;
  const auto fits = [&] { return bytes <= s.budget && s.charged <= s.budget - bytes; };
  while (!fits()) {
    const auto is_kept = [&](std::size_t page) { return s.slots[page].wanted == s.wants; };
    auto oldest = s.resident.end();
    for (auto at = s.resident.begin(); at != s.resident.end(); ++at) {
      if (is_kept(*at)) continue;
      if (oldest == s.resident.end() || s.slots[*at].last_frame < s.slots[*oldest].last_frame) oldest = at;
    }
    if (oldest == s.resident.end()) break;
    PageSlot& slot = s.slots[*oldest];
    if (!slot.used) s.unused += s.entry(*oldest).bytes;
    visible_[*oldest] = nullptr;
    s.release(slot);
    s.dropped.push_back(std::move(slot.decoded));
    slot.phase = Phase::kAbsent;
    slot.was_awaited = false;
    *oldest = s.resident.back();
    s.resident.pop_back();
  }
  for (const std::size_t page : s.on_the_way) {
    PageSlot& slot = s.slots[page];
    if (fits()) break;
    if (slot.doomed || slot.wanted == s.wants) continue;
    s.release(slot);
    slot.doomed = true;
    ++s.doomed;
  }
  return fits();
}

// With the mutex held: leaves of `wants`, which are sorted, those that the budget has room for, and marks them.
void Pager::keepWanted(std::vector<Want>& wants) {
  State& s = *state_;
  std::uint64_t kept_bytes = 0;
  std::size_t kept = 0;
  for (const Want& want : wants) {
    PageSlot& slot = s.slots[want.page];
    if (slot.wanted == s.wants || slot.phase == Phase::kDamaged) continue;  // named twice, or hopeless
    const std::uint64_t bytes = slot.phase == Phase::kResident ? slot.charge : s.cost(want.page);
    if (want.urgency > 0 && (bytes > s.budget || kept_bytes > s.budget - bytes)) break;
    kept_bytes += bytes;
    slot.wanted = s.wants;
    slot.urgency = want.urgency;
    wants[kept++] = want;
  }
  wants.resize(kept);
}

void Pager::want(std::span<const Want> wants) {
  std::vector<Want> sorted = withColumns(wants);
  std::stable_sort(sorted.begin(), sorted.end(), [](const Want& a, const Want& b) { return a.urgency < b.urgency; });
  State& s = *state_;
  const std::scoped_lock lock(s.mutex);
  absorb();  // or it could not be dropped
  ++s.wants;
  keepWanted(sorted);
  // Not begun and no longer wanted: as if never asked for.
  std::erase_if(s.queue, [&](std::size_t page) {
    if (s.slots[page].wanted == s.wants) return false;
    s.abandon(page);
    return true;
  });
  makeRoom(0);
  for (const Want& want : sorted) {
    PageSlot& slot = s.slots[want.page];
    const bool is_now = want.urgency == 0;
    if (is_now) slot.last_frame = frame_;
    if (slot.phase == Phase::kResident) {
      if (!is_now || slot.used) continue;
      slot.used = true;
      frame_reads_.touched += s.entry(want.page).bytes;
      if (!slot.was_awaited) frame_reads_.prefetched += s.entry(want.page).bytes;
      continue;
    }
    slot.was_awaited |= is_now;
    if (slot.doomed || slot.phase == Phase::kAbsent) {
      if (!makeRoom(s.cost(want.page)) && !is_now)
        break;  // what is on the way holds the room: the next frame asks again
      slot.charge = s.cost(want.page);
      s.charged += slot.charge;
      if (slot.doomed) {
        slot.doomed = false;
        --s.doomed;
      } else {
        slot.phase = Phase::kQueued;
        s.queue.push_back(want.page);
      }
    }
  }
  std::stable_sort(s.queue.begin(), s.queue.end(),
                   [&](std::size_t a, std::size_t b) { return s.slots[a].urgency > s.slots[b].urgency; });
  s.to_read.notify_all();
}

void Pager::waitFor(std::span<const std::size_t> pages) {
  State& s = *state_;
  std::unique_lock lock(s.mutex);
  for (std::size_t i = 0; i < pages.size() * in_use_.size(); ++i) {
    const std::size_t entry = pages[i / in_use_.size()] * stride_ + in_use_[i % in_use_.size()];
    PageSlot& slot = s.slots[entry];
    assert(slot.phase != Phase::kAbsent);
    s.arrival.wait(lock, [&] { return slot.phase >= Phase::kArrived; });
    absorb();
    if (slot.phase != Phase::kResident || slot.used) continue;
    slot.used = true;
    frame_reads_.touched += s.entry(entry).bytes;
  }
}

const Fault* Pager::faultOf(std::size_t page) const {
  const std::scoped_lock lock(state_->mutex);
  for (const std::size_t part : in_use_) {
    const auto found = state_->faults.find(page * stride_ + part);
    if (found != state_->faults.end()) return &found->second;  // entries stay where they are
  }
  return nullptr;
}

std::vector<Fault> Pager::takeFaults() {
  const std::scoped_lock lock(state_->mutex);
  return std::exchange(state_->new_faults, {});
}

Pager::Totals Pager::totals() const {
  const std::scoped_lock lock(state_->mutex);
  Totals totals{state_->read, state_->unused, state_->held, state_->peak};
  for (const auto* pages : {&state_->resident, &state_->arrived}) {
    for (const std::size_t page : *pages) totals.unused += state_->slots[page].used ? 0 : state_->entry(page).bytes;
  }
  return totals;
}

}  // namespace tet4d::stream

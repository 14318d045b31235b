#include "libpreprocess/topology/vertex_reach.h"

#include <algorithm>
#include <set>

#include "libpreprocess/error.h"

namespace tet4d::topology {

VertexReach::VertexReach(const hypermesh::File& file, outofcore::Progress& progress, outofcore::MemoryBudget* memory) {
  // Two events a range, at worst two ranges of reach, and as much again while the vectors grow.
  constexpr std::uint64_t kRangeBytes = 2 * (2 * sizeof(Event) + sizeof(Reach) + sizeof(std::uint64_t));
  std::uint64_t ranges = 0;
  const std::size_t pages = file.geometryPages();
  const std::size_t stride = 1 + file.columns().size();
  std::vector<Event> events;
  progress.phase("reach", pages);
  for (std::size_t k = 0; k < pages; ++k) {
    const auto bytes = unwrap(file.pages().load(k * stride));
    const auto page =
        unwrap(hypermesh::validatePage(bytes.bytes(), file.geometryEntry(k), file.header(), file.reader().path(), k));
    ranges += 1 + page.runs.size();
    if (memory != nullptr) {
      held_ = {};
      held_ = memory->reserve(ranges * kRangeBytes, "the ranges of vertices that pages share");
    }
    const auto add = [&](std::uint64_t first, std::uint64_t count) {
      if (count == 0) return;
      events.push_back({first, k, true});
      events.push_back({first + count, k, false});
    };
    first_vertex_.push_back(page.header->first_vertex);
    add(page.header->first_vertex, page.header->owned);
    for (const hypermesh::Run& run : page.runs) add(run.first, run.count);
    progress.step(k + 1);
  }
  sweep(std::move(events));

  for (std::size_t k = 0; k < pages; ++k) {
    const std::uint64_t begin = first_vertex_[k], end = begin + file.geometryEntry(k).counts[1];
    std::uint64_t last = k;
    auto range = std::upper_bound(starts_.begin(), starts_.end(), begin) - starts_.begin();
    for (auto i = static_cast<std::size_t>(range) - (range > 0 ? 1 : 0); i < starts_.size() && starts_[i] < end; ++i) {
      last = std::max(last, reaches_[i].last);
    }
    last_use_of_owner_.push_back(last);
  }
}

void VertexReach::sweep(std::vector<Event> events) {
  std::sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.vertex < b.vertex; });
  std::multiset<std::uint64_t> using_pages;
  for (std::size_t i = 0; i < events.size();) {
    const std::uint64_t vertex = events[i].vertex;
    for (; i < events.size() && events[i].vertex == vertex; ++i) {
      // The order at one vertex does not matter: no range is empty, so an end's begin lies at a smaller vertex.
      if (events[i].begin) {
        using_pages.insert(events[i].page);
      } else {
        using_pages.erase(using_pages.find(events[i].page));
      }
    }
    if (using_pages.empty()) continue;
    const Reach reach{*using_pages.begin(), *using_pages.rbegin()};
    if (!reaches_.empty() && reaches_.back() == reach) continue;
    starts_.push_back(vertex);
    reaches_.push_back(reach);
  }
}

Reach VertexReach::of(std::uint64_t vertex) const {
  const auto after = std::upper_bound(starts_.begin(), starts_.end(), vertex);
  return reaches_[static_cast<std::size_t>(after - starts_.begin()) - 1];
}

std::uint64_t VertexReach::ownerOf(std::uint64_t vertex) const {
  // Pages without own vertices begin where the next one does; the last that begins at or before the vertex owns it.
  const auto after = std::upper_bound(first_vertex_.begin(), first_vertex_.end(), vertex);
  return static_cast<std::uint64_t>(after - first_vertex_.begin()) - 1;
}

}  // namespace tet4d::topology

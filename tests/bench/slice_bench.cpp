// Slices of a file of dynamic triangles on one thread, warm, in memory; beside the bands an interval tree over the same
// lifespans, and the cache misses a triangle of vertex caches of 16, 32 and 256 entries. Prints one JSON line. usage:
// slice_bench X.t4d [SLICES]
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "formats/core/tet_slice.h"
#include "player/render/page_slice.h"
#include "player/render/renderer.h"
#include "player/scene/dyntri_chooser.h"
#include "player/stream/page_source.h"

namespace {

using namespace tet4d;
using Clock = std::chrono::steady_clock;

double msSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

// A centred interval tree: a node holds the lives that contain its centre, once by begin and once by end, so a query
// reads what is alive and one more a node.
class IntervalTree {
 public:
  explicit IntervalTree(std::span<const dyntri::Lifespan> lives) : lives_(lives) {
    std::vector<std::uint32_t> all(lives.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    root_ = build(std::move(all));
  }
  void query(float t, std::vector<std::uint32_t>& alive) const {
    for (const Node* node = root_.get(); node != nullptr;) {
      if (t < node->centre) {
        for (const std::uint32_t i : node->by_begin) {
          if (lives_[i].begin > t) break;
          alive.push_back(i);
        }
        node = node->before.get();
      } else {
        for (const std::uint32_t i : node->by_end) {
          if (lives_[i].end <= t) break;
          alive.push_back(i);
        }
        node = node->after.get();
      }
    }
  }
  // As a file would hold it: two lists, and 24 bytes a node.
  std::uint64_t bytes() const { return 8 * lives_.size() + 24 * nodes_; }

 private:
  struct Node {
    float centre = 0;
    std::vector<std::uint32_t> by_begin, by_end;
    std::unique_ptr<Node> before, after;
  };
  std::unique_ptr<Node> build(std::vector<std::uint32_t> ids) {
    if (ids.empty()) return nullptr;
    auto node = std::make_unique<Node>();
    ++nodes_;
    const auto middle = ids.begin() + static_cast<std::ptrdiff_t>(ids.size() / 2);
    std::nth_element(ids.begin(), middle, ids.end(), [&](auto a, auto b) { return lives_[a].begin < lives_[b].begin; });
    node->centre = lives_[*middle].begin;
    std::vector<std::uint32_t> before, after;
    for (const std::uint32_t i : ids) {
      auto& list = lives_[i].end <= node->centre ? before : lives_[i].begin > node->centre ? after : node->by_begin;
      list.push_back(i);
    }
    node->by_end = node->by_begin;
    std::sort(node->by_begin.begin(), node->by_begin.end(),
              [&](auto a, auto b) { return lives_[a].begin < lives_[b].begin; });
    std::sort(node->by_end.begin(), node->by_end.end(), [&](auto a, auto b) { return lives_[a].end > lives_[b].end; });
    node->before = build(std::move(before));
    node->after = build(std::move(after));
    return node;
  }
  std::span<const dyntri::Lifespan> lives_;
  std::unique_ptr<Node> root_;
  std::uint64_t nodes_ = 0;
};

// A cache of shaded vertices, first in first out: of the page's living triangles as they are drawn, how many corners
// miss.
std::uint64_t cacheMisses(const dyntri::PageView& page, std::span<const scene::DrawItem> items, float t, float last_t,
                          std::uint64_t entries) {
  std::vector<std::uint64_t> since(page.edges.size(), 0);  // misses so far when the edge came in, 0: never
  std::uint64_t misses = 0;
  for (const scene::DrawItem& item : items) {
    for (std::uint64_t i = item.first; i < item.first + item.count; ++i) {
      if (!isAlive(page.lifespans[i].begin, page.lifespans[i].end, t, last_t)) continue;
      for (const std::uint32_t edge : page.triangles[i]) {
        if (since[edge] == 0 || misses - since[edge] >= entries) since[edge] = ++misses;
      }
    }
  }
  return misses;
}

constexpr std::array<std::uint64_t, 3> kCaches{16, 32, 256};

struct Sums {
  std::array<std::uint64_t, kCaches.size()> misses{};
  std::vector<double> choose_ms, slice_ms, tree_ms;
  std::uint64_t processed = 0, drawn = 0, triangles = 0, vertices = 0, tree_drawn = 0, tree_bytes = 0;
  std::uint64_t pages = 0, bytes = 0, all = 0;  // alive: pages, what they take in the file, their triangles
};

// The slices of the pages alive at t, once cold and three times warm; the median counts.
void sliceAt(const dyntri::File& file, stream::PageSource& source, float t, Sums& sums) {
  std::vector<std::size_t> pages;
  for (std::size_t k = 0; k < file.geometryPages(); ++k) {
    const auto& entry = file.geometryEntry(k);
    if (entry.counts[2] == 0 || !isAlive(entry.bounds.min.t, entry.bounds.max.t, t, file.header().last_time)) continue;
    if (!source.load(k).ok()) std::exit(1);
    pages.push_back(k);
    ++sums.pages;
    sums.bytes += entry.bytes;
    sums.all += entry.counts[2];
  }
  static render::PageSlicer slicer;
  static render::PageSlice slice;
  scene::DrawSurface surface;
  std::vector<double> choose, cut, tree;
  for (int run = 0; run < 4; ++run) {
    const auto start = Clock::now();
    scene::chooseTriangles(source, pages, t, file.header().last_time, surface);
    const double chosen = msSince(start);
    std::uint64_t triangles = 0, vertices = 0;
    const std::span<const scene::DrawItem> items(surface.items);
    for (std::size_t first = 0, last = 0; first < items.size(); first = last) {
      while (last < items.size() && items[last].page == items[first].page) ++last;
      slicer.slice(*source.resident(items[first].page), items.subspan(first, last - first), t, surface.last_t, slice,
                   false);
      triangles += slice.triangles.size();
      vertices += slice.positions.size();
    }
    if (run > 0) choose.push_back(chosen), cut.push_back(msSince(start));
    if (run == 3) sums.triangles += triangles, sums.vertices += vertices;
  }
  for (const auto items : render::itemsByPage(surface.items)) {
    for (std::size_t c = 0; c < kCaches.size(); ++c)
      sums.misses[c] += cacheMisses(*source.resident(items.front().page), items, t, surface.last_t, kCaches[c]);
  }
  for (const std::size_t page : pages) {
    const IntervalTree lives(source.resident(page)->lifespans);
    sums.tree_bytes += lives.bytes();
    std::vector<std::uint32_t> alive;
    for (int run = 0; run < 3; ++run) {
      alive.clear();
      const auto start = Clock::now();
      lives.query(t, alive);
      tree.push_back(msSince(start));
    }
    sums.tree_drawn += alive.size();
  }
  sums.choose_ms.push_back(median(choose));
  sums.slice_ms.push_back(median(cut));
  if (!tree.empty()) sums.tree_ms.push_back(median(tree));
  sums.processed += surface.processed;
  sums.drawn += surface.drawn;
}

// One line of JSON: means over the slices, medians of times.
void print(const dyntri::File& file, int slices, const Sums& sums) {
  const auto each = [&](std::uint64_t sum) { return static_cast<double>(sum) / slices; };
  const std::pair<const char*, double> fields[] = {{"file_triangles", static_cast<double>(file.header().triangles)},
                                                   {"file_pages", static_cast<double>(file.geometryPages())},
                                                   {"frames", static_cast<double>(file.times().size())},
                                                   {"slices", slices},
                                                   {"pages", each(sums.pages)},
                                                   {"bytes", each(sums.bytes)},
                                                   {"all", each(sums.all)},
                                                   {"processed", each(sums.processed)},
                                                   {"drawn", each(sums.drawn)},
                                                   {"triangles", each(sums.triangles)},
                                                   {"vertices", each(sums.vertices)},
                                                   {"slice_ms", median(sums.slice_ms)},
                                                   {"choose_ms", median(sums.choose_ms)},
                                                   {"acmr_16", each(sums.misses[0]) / each(sums.drawn)},
                                                   {"acmr_32", each(sums.misses[1]) / each(sums.drawn)},
                                                   {"acmr_256", each(sums.misses[2]) / each(sums.drawn)},
                                                   {"processed_per_drawn", each(sums.processed) / each(sums.drawn)},
                                                   {"active_per_all", each(sums.drawn) / each(sums.all)},
                                                   {"tree_ms", sums.tree_ms.empty() ? 0 : median(sums.tree_ms)},
                                                   {"tree_bytes_per_triangle", each(sums.tree_bytes) / each(sums.all)},
                                                   {"tree_drawn_per_drawn", each(sums.tree_drawn) / each(sums.drawn)}};
  std::printf("{\"tets\": %llu", static_cast<unsigned long long>(file.header().tets));
  for (const auto& [name, value] : fields) std::printf(", \"%s\": %.10g", name, value);
  std::printf("}\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  auto opened = dyntri::File::open(argv[1]);
  if (!opened.ok()) {
    std::fprintf(stderr, "%s: %s\n", argv[1], opened.fault().what.c_str());
    return 1;
  }
  const dyntri::File& file = opened.value();
  stream::PageSource source(file, std::uint64_t{1} << 40);
  const int slices = argc > 2 ? std::atoi(argv[2]) : 8;
  Sums sums;
  for (int i = 0; i < slices; ++i) {
    const double part = (i + 0.5) / slices;
    sliceAt(file, source, static_cast<float>(part * double{file.header().last_time}), sums);
  }
  print(file, slices, sums);
  return 0;
}

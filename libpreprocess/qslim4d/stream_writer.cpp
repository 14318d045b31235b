#include "libpreprocess/qslim4d/stream_writer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/foreign_runs.h"
#include "libpreprocess/outofcore/external_sort.h"
#include "libpreprocess/outofcore/record_files.h"
#include "libpreprocess/qslim4d/cell_files.h"
#include "libpreprocess/qslim4d/packed_mesh.h"

namespace tet4d::qslim4d {
namespace {

using outofcore::BucketFiles;
using Numbers = std::array<std::uint64_t, 4>;

constexpr std::size_t kFileBuffer = std::size_t{1} << 20;

// A vertex as a cell has it, before the mesh's are numbered.
struct Seat {
  std::uint64_t id;
  Vec4f at;
  std::uint32_t cell, local;
};
struct ByTime {
  bool operator()(const Seat& a, const Seat& b) const {
    if (a.at.t != b.at.t) return a.at.t < b.at.t;
    return a.id != b.id ? a.id < b.id : a.cell < b.cell;
  }
};

// A cell's vertex `local` is the part's `number`. A vertex that several cells have has its values from the first.
struct Numbered {
  std::uint64_t number;
  std::uint32_t local, is_first;
};

struct SortedTet {
  std::uint64_t first, sequence;  // its least vertex; its rank among all cells' tetrahedra
  Numbers vertices;
};
struct ByFirst {
  bool operator()(const SortedTet& a, const SortedTet& b) const {
    return a.first != b.first ? a.first < b.first : a.sequence < b.sequence;
  }
};

// Vertices whose values are put in order together; more of them where that would be too many files.
std::uint64_t valueRange(std::uint64_t vertices, std::size_t stride, std::size_t buffer_bytes) {
  constexpr std::uint64_t kMostRanges = 1024;
  const std::uint64_t fitting = buffer_bytes / std::max<std::size_t>(1, 2 * stride * sizeof(float));
  return std::max({fitting, (vertices + kMostRanges - 1) / kMostRanges, std::uint64_t{1024}});
}

// Vertices begin .. end - 1 of a part, and what its tetrahedra reach.
struct Page {
  std::size_t part = 0;
  std::uint64_t begin = 0, end = 0;
  std::uint64_t first_tet = 0, tets = 0;
  std::uint64_t first = 0;  // number of its first vertex in the file
  Bounds4f bounds;
};

// Tetrahedra that come one after the other, and what they reach.
struct Reach {
  std::uint64_t tets = 0;
  Bounds4f bounds;
  void add(const Reach& other) {
    tets += other.tets;
    bounds.add(other.bounds);
  }
};

// Cuts a part into pages as pack() and writeMeshes() do, from its tetrahedra in order.
class PagePlan {
 public:
  PagePlan(std::size_t part, std::span<const Vec4f> vertices) : part_(part), vertices_(vertices) {}

  void add(const SortedTet& tet) {
    if (tet.first != vertex_) closeVertex(tet.first);
    Reach one{1, {}};
    for (const std::uint64_t v : tet.vertices) one.bounds.add(vertices_[v]);
    own_.add(one);
  }

  std::vector<Page> finish() {
    closeVertex(vertices_.size());
    while (begin_ < vertices_.size()) closeAt(std::min<std::uint64_t>(vertices_.size(), begin_ + kMostPageItems));
    return std::move(pages_);
  }

 private:
  // All tetrahedra of vertex_ are known, those in front of `next` have none.
  void closeVertex(std::uint64_t next) {
    // The page may not take them, or it would end on its way here.
    if (page_.tets + own_.tets > kMostPageItems && vertex_ > begin_) closeAt(vertex_);
    page_.add(own_);
    own_ = {};
    vertex_ = next;
    if (next == vertices_.size()) return;
    // What comes first on the way to `next`: as many vertices as a page may have, or the end of a frame.
    for (;;) {
      if (const std::uint64_t full = begin_ + kMostPageItems; full <= std::min(next, end_)) {
        closeAt(full);
      } else if (end_ <= next) {
        if (end_ > begin_ && page_.tets >= kLeastPageTets) closeAt(end_);
        endFrame();
      } else {
        return;
      }
    }
  }

  void endFrame() {
    const float frame = std::floor(vertices_[end_].t);
    while (end_ < vertices_.size() && std::floor(vertices_[end_].t) == frame) ++end_;
  }

  void closeAt(std::uint64_t end) {
    for (std::uint64_t v = begin_; v < end && page_.tets == 0; ++v) page_.bounds.add(vertices_[v]);
    pages_.push_back({part_, begin_, end, tets_, page_.tets, 0, page_.bounds});
    tets_ += page_.tets;
    begin_ = end;
    page_ = {};
  }

  std::size_t part_;
  std::span<const Vec4f> vertices_;
  std::vector<Page> pages_;
  std::uint64_t begin_ = 0, end_ = 0;  // of the page; of the frame that is read
  std::uint64_t vertex_ = 0, tets_ = 0;
  Reach page_, own_;  // of the page without vertex_; of vertex_
};

// A part with its vertices numbered and all sorted, in files.
class SortedPart {
 public:
  SortedPart(std::size_t part, const PartResults& results, std::span<const SlimColumn> columns,
             const outofcore::WorkFolder& folder, std::size_t buffer_bytes)
      : part_(part),
        results_(results.paths),
        columns_(columns),
        prefix_(folder.file("write" + std::to_string(part) + ".")),
        buffer_bytes_(buffer_bytes) {}
  SortedPart(const SortedPart&) = delete;
  SortedPart& operator=(const SortedPart&) = delete;
  ~SortedPart() {
    vertices_.reset(), values_.clear();
    try {
      outofcore::removeFile(vertexPath()), outofcore::removeFile(tetPath());
      for (std::size_t c = 0; c < columns_.size(); ++c) outofcore::removeFile(columnPath(c));
    } catch (...) {  // the folder goes with its files
    }
  }

  // Calls told() after each result that is read, two times each.
  template <class Told>
  void sort(const Told& told) {
    BucketFiles numbers(prefix_ + "numbers", results_.size(), buffer_bytes_ / 4);
    const std::uint64_t count = numberVertices(numbers, told);
    vertices_ = std::make_unique<outofcore::MappedFile>(vertexPath());
    sortTets(count, told);
    for (std::size_t c = 0; c < columns_.size(); ++c)
      values_.push_back(std::make_unique<outofcore::MappedFile>(columnPath(c)));
  }

  std::vector<Page>& pages() { return pages_; }
  std::uint64_t tets() const { return tets_; }
  std::span<const Vec4f> vertices() const { return vertices_->records<Vec4f>(); }
  std::span<const float> values(std::size_t column) const { return values_[column]->records<float>(); }
  std::string tetPath() const { return BucketFiles::pathOf(prefix_ + "tets", 0); }

 private:
  std::string vertexPath() const { return BucketFiles::pathOf(prefix_ + "vertices", 0); }
  std::string columnPath(std::size_t c) const { return prefix_ + "column" + std::to_string(c); }

  // Numbers the vertices; leaves their places in a file, each cell's numbers in a bucket of `numbers`.
  template <class Told>
  std::uint64_t numberVertices(BucketFiles& numbers, const Told& told) {
    BucketFiles vertices(prefix_ + "vertices", 1, kFileBuffer);
    outofcore::ExternalSort<Seat, ByTime> seats(prefix_ + "seats", buffer_bytes_ / 2);
    for (std::uint32_t cell = 0; cell < results_.size(); ++cell) {
      const CellResult result = readResult(results_[cell], ResultWants::kMesh);
      std::vector<std::uint8_t> used(result.ids.size(), 0);
      for (const hypermesh::Tet& tet : result.tets)
        for (const std::uint32_t v : tet) used[v] = 1;
      for (std::uint32_t v = 0; v < used.size(); ++v)
        if (used[v] != 0) seats.add({result.ids[v], result.positions[v], cell, v});
      told();
    }
    std::uint64_t count = 0, last = 0;
    seats.finish([&](const Seat& seat) {
      const bool is_first = count == 0 || seat.id != last;
      if (is_first) {
        vertices.add(0, seat.at);
        ++count;
      }
      last = seat.id;
      numbers.add(seat.cell, Numbered{count - 1, seat.local, is_first ? 1U : 0U});
    });
    vertices.finish(), numbers.finish();
    return count;
  }

  // Tetrahedra by their first vertex into a file, cut into pages; values by the numbers of their vertices.
  template <class Told>
  void sortTets(std::uint64_t count, const Told& told) {
    const VertexLoad load = loadOf(columns_);
    ValueSort values(prefix_ + "values", count, load.values, buffer_bytes_ / 4);
    {
      outofcore::ExternalSort<SortedTet, ByFirst> tets(prefix_ + "sorted", buffer_bytes_);
      for (std::size_t cell = 0; cell < results_.size(); ++cell) {
        const CellResult result =
            readResult(results_[cell], load.values > 0 ? ResultWants::kValues : ResultWants::kMesh);
        std::vector<std::uint64_t> number(result.ids.size());
        const std::string path = BucketFiles::pathOf(prefix_ + "numbers", cell);
        outofcore::RecordReader<Numbered> reader(path, kFileBuffer);
        for (Numbered vertex{}; reader.next(vertex);) {
          number[vertex.local] = vertex.number;
          if (vertex.is_first != 0 && load.values > 0)
            values.add(vertex.number, std::span(result.values).subspan(vertex.local * load.values, load.values));
        }
        outofcore::removeFile(path);
        for (const hypermesh::Tet& tet : result.tets) {
          const Numbers v{number[tet[0]], number[tet[1]], number[tet[2]], number[tet[3]]};
          tets.add({std::min({v[0], v[1], v[2], v[3]}), tets_++, v});
        }
        told();
      }
      BucketFiles sorted(prefix_ + "tets", 1, kFileBuffer);
      PagePlan plan(part_, vertices());
      tets.finish([&](const SortedTet& tet) {
        plan.add(tet);
        sorted.add(0, tet.vertices);
      });
      sorted.finish();
      pages_ = plan.finish();
    }
    values.finish([&](std::size_t c) { return columnPath(c); }, columns_);
  }

  // Values to files of a column each, by the numbers of their vertices: first to ranges of these, each of which fits
  // into memory.
  class ValueSort {
   public:
    ValueSort(const std::string& prefix, std::uint64_t vertices, std::size_t stride, std::size_t buffer_bytes)
        : vertices_(vertices),
          stride_(stride),
          range_(valueRange(vertices, stride, buffer_bytes)),
          buffer_bytes_(buffer_bytes),
          ranges_(prefix, stride == 0 ? 0 : static_cast<std::size_t>((vertices + range_ - 1) / range_), buffer_bytes) {}
    void add(std::uint64_t number, std::span<const float> values) {
      const auto range = static_cast<std::size_t>(number / range_);
      ranges_.add(range, number);
      ranges_.addRun(range, values);
    }
    template <class PathOf>
    void finish(const PathOf& path_of, std::span<const SlimColumn> columns) {
      ranges_.finish();
      for (std::size_t c = 0; c < columns.size(); ++c) outofcore::writeFile(path_of(c), {});
      std::vector<float> values, column;
      for (std::size_t range = 0; range < ranges_.size(); ++range) {
        const std::uint64_t first = range * range_, count = std::min(range_, vertices_ - first);
        values.assign(count * stride_, 0);
        // A record: the number as two words, and the values.
        outofcore::RecordReader<std::uint32_t> reader(ranges_.path(range), std::min(buffer_bytes_, kFileBuffer));
        for (std::array<std::uint32_t, 2> words{}; reader.next(words[0]);) {
          reader.next(words[1]);
          const std::uint64_t at = (std::bit_cast<std::uint64_t>(words) - first) * stride_;
          for (std::size_t i = 0; i < stride_; ++i) {
            reader.next(words[0]);
            values[at + i] = std::bit_cast<float>(words[0]);
          }
        }
        outofcore::removeFile(ranges_.path(range));
        std::size_t at = 0;
        for (std::size_t c = 0; c < columns.size(); at += columns[c++].components) {
          const std::size_t n = columns[c].components;
          column.resize(count * n);
          for (std::size_t v = 0; v < count; ++v)
            std::copy_n(values.data() + v * stride_ + at, n, column.data() + v * n);
          outofcore::appendFile(path_of(c), std::as_bytes(std::span<const float>(column)));
        }
      }
    }

   private:
    std::uint64_t vertices_;
    std::size_t stride_;
    std::uint64_t range_;
    std::size_t buffer_bytes_;
    BucketFiles ranges_;
  };

  std::size_t part_;
  std::span<const std::string> results_;
  std::span<const SlimColumn> columns_;
  std::string prefix_;
  std::size_t buffer_bytes_;
  std::unique_ptr<outofcore::MappedFile> vertices_;
  std::vector<std::unique_ptr<outofcore::MappedFile>> values_;
  std::vector<Page> pages_;
  std::uint64_t tets_ = 0;
};

// The number in the file of a part's vertex; pages: of the part, ascending.
std::uint64_t numberInFile(std::span<const Page> pages, std::uint64_t v) {
  const auto page = std::prev(std::upper_bound(pages.begin(), pages.end(), v,
                                               [](std::uint64_t vertex, const Page& p) { return vertex < p.begin; }));
  return page->first + v - page->begin;
}

void writePage(const SortedPart& part, std::span<const Page> pages, const Page& page,
               std::span<const SlimColumn> columns, const PartResults& results, hypermesh::Writer& writer) {
  const std::uint64_t owned = page.end - page.begin;
  std::vector<hypermesh::Tet> local(page.tets);
  std::uint64_t last = owned;
  outofcore::RecordReader<Numbers> reader(part.tetPath(), page.first_tet, page.tets, kFileBuffer);
  for (hypermesh::Tet& tet : local) {
    Numbers numbers{};
    reader.next(numbers);
    for (std::size_t i = 0; i < 4; ++i) {
      const bool is_own = numbers[i] < page.end;
      const std::uint64_t v = is_own ? numbers[i] - page.begin : numberInFile(pages, numbers[i]) - page.first;
      if (v >= kNone)
        throw Error(FaultCode::kBadInput, "", "", "a page's tetrahedra reach over more than 2^32 vertices",
                    "crop the mesh");
      last = std::max(last, v + 1);
      tet[i] = static_cast<std::uint32_t>(v);
    }
  }
  const auto runs = exchange::nameForeign(local, owned, last, writer.nextVertex());
  std::vector<std::span<const float>> values;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::size_t n = columns[c].components;
    values.push_back(part.values(c).subspan(page.begin * n, owned * n));
  }
  writer.setPageErrors(static_cast<float>(results.error_estimated), static_cast<float>(results.error_measured));
  unwrap(writer.addPage(part.vertices().subspan(page.begin, owned), runs, local, page.bounds, values, page.part));
}

}  // namespace

std::uint64_t sortBytes(std::uint64_t vertices, const VertexLoad& load, std::size_t buffer_bytes) {
  const std::uint64_t range = load.values == 0 ? 0 : valueRange(vertices, load.values, buffer_bytes / 4);
  return 2 * buffer_bytes + range * 2 * load.values * sizeof(float) + 3 * kFileBuffer;
}

std::uint64_t writtenPageBytes(std::uint64_t vertices, std::uint64_t tets) {
  // Tetrahedra; bits for what they reach, and runs of more than 32 vertices with their local indices.
  return std::min<std::uint64_t>(kMostPageItems, tets) * sizeof(hypermesh::Tet) + vertices / 8 +
         vertices / 32 * (sizeof(hypermesh::Run) + sizeof(std::uint64_t)) + kFileBuffer;
}

WrittenMesh writeResults(std::span<const PartResults> parts, std::span<const SlimColumn> columns,
                         hypermesh::Writer& writer, const outofcore::WorkFolder& folder, std::size_t buffer_bytes,
                         outofcore::Progress& progress) {
  std::uint64_t steps = 0, done = 0;
  for (const PartResults& part : parts) steps += 2 * part.paths.size();
  progress.phase("write", steps);
  std::vector<std::unique_ptr<SortedPart>> sorted;
  WrittenMesh written;
  std::vector<std::pair<std::size_t, std::size_t>> order;  // part, page of it
  for (std::size_t p = 0; p < parts.size(); ++p) {
    sorted.push_back(std::make_unique<SortedPart>(p, parts[p], columns, folder, buffer_bytes));
    sorted.back()->sort([&] { progress.step(++done); });
    written.vertices += sorted.back()->vertices().size(), written.tets += sorted.back()->tets();
    for (std::size_t k = 0; k < sorted.back()->pages().size(); ++k) order.emplace_back(p, k);
  }
  const auto pageAt = [&](const std::pair<std::size_t, std::size_t>& at) -> Page& {
    return sorted[at.first]->pages()[at.second];
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](const auto& a, const auto& b) { return pageAt(a).bounds.min.t < pageAt(b).bounds.min.t; });
  std::uint64_t first = 0;
  for (const auto& at : order) pageAt(at).first = std::exchange(first, first + pageAt(at).end - pageAt(at).begin);
  for (const auto& at : order) {
    const SortedPart& part = *sorted[at.first];
    writePage(part, sorted[at.first]->pages(), pageAt(at), columns, parts[at.first], writer);
    progress.step(done);
  }
  return written;
}

}  // namespace tet4d::qslim4d

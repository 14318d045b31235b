#include "libpreprocess/qslim4d/stream_writer.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/foreign_runs.h"
#include "libpreprocess/outofcore/external_sort.h"
#include "libpreprocess/outofcore/record_files.h"
#include "libpreprocess/qslim4d/cell_files.h"
#include "libpreprocess/qslim4d/page_plan.h"
#include "libpreprocess/qslim4d/value_sort.h"

namespace tet4d::qslim4d {
namespace {

using outofcore::BucketFiles;

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
        plan.add(tet.first, tet.vertices);
        sorted.add(0, tet.vertices);
      });
      sorted.finish();
      pages_ = plan.finish();
    }
    std::vector<std::string> paths;
    for (std::size_t c = 0; c < columns_.size(); ++c) paths.push_back(columnPath(c));
    values.finish(columns_, paths);
  }

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
  return 2 * buffer_bytes + ValueSort::rangeBytes(vertices, load.values, buffer_bytes / 4) + 3 * kFileBuffer;
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

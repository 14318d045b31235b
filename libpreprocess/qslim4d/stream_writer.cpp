#include "libpreprocess/qslim4d/stream_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>

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

// A cell's vertex `local` is the mesh's `number`.
struct Numbered {
  std::uint64_t number;
  std::uint32_t local, reserved;
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

std::vector<std::uint8_t> usedVertices(const CellResult& result) {
  std::vector<std::uint8_t> used(result.ids.size(), 0);
  for (const hypermesh::Tet& tet : result.tets)
    for (const std::uint32_t v : tet) used[v] = 1;
  return used;
}

// Numbers the vertices; leaves their places in the file `vertices`, each cell's numbers in a bucket of `numbers`.
std::uint64_t numberVertices(const std::vector<std::string>& results, const std::string& sort_path,
                             BucketFiles& vertices, BucketFiles& numbers, std::size_t buffer_bytes,
                             outofcore::Progress& progress) {
  outofcore::ExternalSort<Seat, ByTime> seats(sort_path, buffer_bytes);
  for (std::uint32_t cell = 0; cell < results.size(); ++cell) {
    const CellResult result = readResult(results[cell], false);
    const std::vector<std::uint8_t> used = usedVertices(result);
    for (std::uint32_t v = 0; v < used.size(); ++v)
      if (used[v] != 0) seats.add({result.ids[v], result.positions[v], cell, v});
    progress.step(cell + 1);
  }
  std::uint64_t count = 0, last = 0;
  seats.finish([&](const Seat& seat) {
    if (count == 0 || seat.id != last) {
      vertices.add(0, seat.at);
      ++count;
    }
    last = seat.id;
    numbers.add(seat.cell, Numbered{count - 1, seat.local, 0});
  });
  vertices.finish(), numbers.finish();
  return count;
}

// Collects tetrahedra in order and writes a page whenever whole frames have enough of them.
class PageStream {
 public:
  PageStream(std::span<const Vec4f> vertices, double error_world, hypermesh::Writer& writer,
             const std::function<void()>& written)
      : vertices_(vertices), error_world_(error_world), writer_(writer), written_(written) {}

  void add(const SortedTet& tet) {
    while (tet.first >= end_) {
      if (tets_.size() >= kLeastPageTets) flush();
      endFrame();
    }
    tets_.push_back(tet.vertices);
  }
  void finish() {
    end_ = vertices_.size();
    if (begin_ < end_) flush();
  }

 private:
  void endFrame() {
    const float frame = std::floor(vertices_[end_].t);
    while (end_ < vertices_.size() && std::floor(vertices_[end_].t) == frame) ++end_;
  }

  void flush() {
    Bounds4f bounds;
    std::uint64_t last = end_;
    for (const Numbers& tet : tets_) {
      for (const std::uint64_t v : tet) {
        bounds.add(vertices_[v]);
        last = std::max(last, v + 1);
      }
    }
    if (last - begin_ >= kNone)
      throw Error(FaultCode::kBadInput, "", "", "a page's tetrahedra reach over more than 2^32 vertices",
                  "crop the mesh");
    std::vector<hypermesh::Tet> local(tets_.size());
    for (std::size_t t = 0; t < local.size(); ++t)
      for (std::size_t i = 0; i < 4; ++i) local[t][i] = static_cast<std::uint32_t>(tets_[t][i] - begin_);
    tets_.clear();
    const auto runs = exchange::nameForeign(local, end_ - begin_, last - begin_, writer_.nextVertex());
    writer_.setPageErrors(static_cast<float>(error_world_), -1);
    unwrap(writer_.addPage(vertices_.subspan(begin_, end_ - begin_), runs, local, bounds));
    begin_ = end_;
    written_();
  }

  std::span<const Vec4f> vertices_;
  double error_world_;
  hypermesh::Writer& writer_;
  const std::function<void()>& written_;  // called after each page
  std::vector<Numbers> tets_;
  std::uint64_t begin_ = 0, end_ = 0;  // the page's own vertices
};

}  // namespace

WrittenMesh writeResults(const std::vector<std::string>& results, double error_world, hypermesh::Writer& writer,
                         const outofcore::WorkFolder& folder, std::size_t buffer_bytes, outofcore::Progress& progress) {
  progress.phase("write", 2 * results.size());
  BucketFiles vertices(folder.file("write.vertices"), 1, std::size_t{1} << 20);
  BucketFiles numbers(folder.file("write.numbers"), results.size(), buffer_bytes / 4);
  WrittenMesh written;
  written.vertices = numberVertices(results, folder.file("write.seats"), vertices, numbers, buffer_bytes / 2, progress);
  outofcore::ExternalSort<SortedTet, ByFirst> tets(folder.file("write.sorted"), buffer_bytes);
  for (std::size_t cell = 0; cell < results.size(); ++cell) {
    const CellResult result = readResult(results[cell], false);
    std::vector<std::uint64_t> number(result.ids.size());
    outofcore::RecordReader<Numbered> reader(numbers.path(cell), std::size_t{1} << 20);
    for (Numbered vertex{}; reader.next(vertex);) number[vertex.local] = vertex.number;
    outofcore::removeFile(numbers.path(cell));
    for (const hypermesh::Tet& tet : result.tets) {
      const Numbers v{number[tet[0]], number[tet[1]], number[tet[2]], number[tet[3]]};
      tets.add({std::min({v[0], v[1], v[2], v[3]}), written.tets++, v});
    }
    progress.step(results.size() + cell + 1);
  }
  const outofcore::MappedFile mapped(vertices.path(0));
  const std::function<void()> mayStop = [&] { progress.step(2 * results.size()); };
  PageStream pages(mapped.records<Vec4f>(), error_world, writer, mayStop);
  tets.finish([&](const SortedTet& tet) { pages.add(tet); });
  pages.finish();
  outofcore::removeFile(vertices.path(0));
  return written;
}

}  // namespace tet4d::qslim4d

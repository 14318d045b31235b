#include "libpreprocess/qslim4d/scatter.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "libpreprocess/error.h"
#include "libpreprocess/outofcore/record_files.h"
#include "libpreprocess/qslim4d/slim_mesh.h"

namespace tet4d::qslim4d {
namespace {

using outofcore::BucketFiles;

// Vertex numbers that are looked at together: 16 MiB of first users. More of them where that would be too many files.
constexpr std::uint64_t kLeastRange = std::uint64_t{1} << 22, kMostRanges = 1024;

std::uint64_t rangeOf(std::uint64_t vertex_ids) {
  return std::max(std::clamp<std::uint64_t>(vertex_ids, 1, kLeastRange), (vertex_ids + kMostRanges - 1) / kMostRanges);
}

// A cell uses a vertex.
struct User {
  std::uint32_t vertex;  // from the first of its range on
  std::uint32_t cell;
};

FixedPlace sumOf(const FixedGrid& grid, const Piece& piece, const hypermesh::Tet& tet) {
  FixedPlace sum{};
  for (const std::uint32_t v : tet) {
    const FixedPlace place = grid.placeOf(piece.positions[v]);
    for (std::size_t axis = 0; axis < 4; ++axis) sum[axis] += place[axis];
  }
  return sum;
}

class Scatter {
 public:
  Scatter(const CellTree& tree, const FixedGrid& grid, std::uint64_t vertex_ids, const VertexLoad& load,
          const CellPaths& paths, std::size_t buffer_bytes)
      : tree_(tree),
        grid_(grid),
        load_(load),
        range_(rangeOf(vertex_ids)),
        sizes_(tree.cells()),
        vertices_(paths.vertices(), tree.cells(), buffer_bytes / 6),
        values_(paths.values(), load.values > 0 ? tree.cells() : 0, buffer_bytes / 6),
        tets_(paths.tets(), tree.cells(), buffer_bytes / 6),
        quadrics_(paths.quadrics(), tree.cells(), buffer_bytes / 6),
        sums_(paths.sums(), load.sums > 0 ? tree.cells() : 0, buffer_bytes / 6),
        users_(paths.users(), static_cast<std::size_t>((vertex_ids + range_ - 1) / range_), buffer_bytes / 6) {
    if (range_ > kNone) throw Error(FaultCode::kBadInput, "", "", "has more than 2^42 vertices", "crop it");
  }

  void add(const Piece& piece) {
    sortByCell(piece);
    slot_.resize(piece.ids.size());
    given_.assign(piece.ids.size(), 0);
    user_.assign(piece.ids.size(), kNone);
    for (const std::uint32_t t : order_) {
      const std::uint32_t cell = cell_[t];
      hypermesh::Tet slots{};
      for (std::size_t i = 0; i < 4; ++i) {
        const std::uint32_t v = piece.tets[t][i];
        if (user_[v] != cell) addVertex(piece, v, cell);
        slots[i] = slot_[v];
      }
      tets_.add(cell, slots);
      ++sizes_[cell].tets;
      sizes_[cell].expected += piece.expected;
    }
    addOrphans(piece);
  }

  std::vector<CellSize> finish(const CellPaths& paths, std::size_t buffer_bytes) {
    vertices_.finish(), values_.finish(), tets_.finish(), quadrics_.finish(), sums_.finish(), users_.finish();
    release(order_), release(cell_), release(user_), release(slot_), release(given_);
    BucketFiles shared(paths.shared(), tree_.cells(), buffer_bytes / 2);
    for (std::size_t range = 0; range < users_.size(); ++range) {
      if (users_.bytes(range) != 0) findShared(range, shared, buffer_bytes / 4);
      outofcore::removeFile(users_.path(range));
    }
    shared.finish();
    for (std::size_t cell = 0; cell < sizes_.size(); ++cell) {
      // A vertex comes once for each piece that has it.
      auto ids = outofcore::readRecords<std::uint64_t>(shared.path(cell));
      std::sort(ids.begin(), ids.end());
      ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
      outofcore::writeFile(shared.path(cell), std::as_bytes(std::span(ids)));
      sizes_[cell].locked = ids.size();
      sizes_[cell].vertices += ids.size();
    }
    return sizes_;
  }

 private:
  // order_: the piece's tetrahedra by cell, each cell's in their own order.
  void sortByCell(const Piece& piece) {
    cell_.resize(piece.tets.size());
    order_.resize(piece.tets.size());
    std::vector<std::uint32_t> begin(tree_.cells() + std::size_t{1});
    for (std::size_t t = 0; t < piece.tets.size(); ++t) {
      cell_[t] = tree_.cellOf(sumOf(grid_, piece, piece.tets[t]));
      ++begin[cell_[t] + std::size_t{1}];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    for (std::size_t t = 0; t < piece.tets.size(); ++t) order_[begin[cell_[t]]++] = static_cast<std::uint32_t>(t);
  }

  void addVertex(const Piece& piece, std::uint32_t v, std::uint32_t cell) {
    if (sizes_[cell].slots >= kNone)
      throw Error(FaultCode::kBadInput, "", "", "a cell is too large", "lower --cell-tets");
    const std::uint64_t id = piece.ids[v];
    user_[v] = cell;
    slot_[v] = static_cast<std::uint32_t>(sizes_[cell].slots++);
    vertices_.add(cell, CellVertex{id, piece.positions[v], piece.flags.empty() ? 0U : piece.flags[v], 0});
    if (load_.values > 0) values_.addRun(cell, piece.values.subspan(v * load_.values, load_.values));
    users_.add(static_cast<std::size_t>(id / range_), User{static_cast<std::uint32_t>(id % range_), cell});
    if (!piece.quadrics.empty() && given_[v] == 0) {
      addQuadric(piece, v, cell);
      given_[v] = 1;
    }
  }

  void addQuadric(const Piece& piece, std::size_t v, std::uint32_t cell) {
    quadrics_.add(cell, CellQuadric{piece.ids[v], piece.quadrics[v]});
    if (load_.sums > 0) sums_.addRun(cell, piece.sums.subspan(v * load_.sums, load_.sums));
  }

  // Quadrics of vertices whose tetrahedra are all in other pieces go where the vertex lies.
  void addOrphans(const Piece& piece) {
    for (std::uint32_t v = 0; v < piece.quadrics.size(); ++v) {
      if (given_[v] != 0) continue;
      FixedPlace sum = grid_.placeOf(piece.positions[v]);
      for (std::int64_t& along : sum) along *= 4;
      addQuadric(piece, v, tree_.cellOf(sum));
    }
  }

  void findShared(std::size_t range, BucketFiles& shared, std::size_t buffer_bytes) {
    constexpr std::uint32_t kSeveral = kNone - 1;
    std::vector<std::uint32_t> user(range_, kNone);
    outofcore::RecordReader<User> first(users_.path(range), buffer_bytes), second(users_.path(range), buffer_bytes);
    for (User use{}; first.next(use);) {
      std::uint32_t& known = user[use.vertex];
      if (known == kSeveral || known == use.cell) continue;
      if (known == kNone) {
        ++sizes_[use.cell].vertices;
        known = use.cell;
      } else {
        --sizes_[known].vertices;
        known = kSeveral;
      }
    }
    for (User use{}; second.next(use);) {
      if (user[use.vertex] == kSeveral) shared.add(use.cell, range * range_ + use.vertex);
    }
  }

  const CellTree& tree_;
  const FixedGrid& grid_;
  VertexLoad load_;
  std::uint64_t range_;
  std::vector<CellSize> sizes_;
  BucketFiles vertices_, values_, tets_, quadrics_, sums_, users_;
  // Of the piece in hand: by tetrahedron its cell, and their order; by vertex the cell that used it last, its slot
  // there, and whether its quadric is given away.
  std::vector<std::uint32_t> order_, cell_, user_, slot_;
  std::vector<std::uint8_t> given_;
};

}  // namespace

std::uint64_t rangeBytes(std::uint64_t vertex_ids) { return rangeOf(vertex_ids) * sizeof(std::uint32_t); }

std::vector<CellSize> scatter(const PieceSource& source, const CellTree& tree, const FixedGrid& grid,
                              std::uint64_t vertex_ids, const VertexLoad& load, const CellPaths& paths,
                              std::size_t buffer_bytes) {
  Scatter all(tree, grid, vertex_ids, load, paths, buffer_bytes);
  source([&](const Piece& piece) { all.add(piece); });
  return all.finish(paths, buffer_bytes);
}

}  // namespace tet4d::qslim4d

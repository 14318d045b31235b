// Pages of a hypermesh for the renderer of tetrahedra: the paper's baseline beside dynamic triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include "formats/hypermesh.h"
#include "player/stream/residency.h"

namespace tet4d::stream {

class TetSource final : public Residency {
 public:
  // `file` must outlive the source. budget_bytes: of gathered pages; those of one frame may exceed it.
  TetSource(const hypermesh::File& file, std::uint64_t budget_bytes) : file_(&file), budget_bytes_(budget_bytes) {}

  // A new frame begins: pages of earlier frames go until the budget holds.
  void beginFrame();
  // Brings a geometry page in if it is not resident, proved by hypermesh::File::gather(). A Fault names file and page.
  Status load(std::size_t page);
  // Stored bytes of the pages brought in since beginFrame(), without those of the owners of shared vertices.
  std::uint64_t bytesTouched() const { return bytes_touched_; }

  const dyntri::PageView* resident(std::size_t) const override { return nullptr; }
  std::optional<TetPage> residentTets(std::size_t page) const override;

 private:
  struct Slot {
    hypermesh::GatheredPage page;
    std::uint64_t bytes = 0, last_frame = 0;
  };

  const hypermesh::File* file_;
  std::uint64_t budget_bytes_, bytes_ = 0, bytes_touched_ = 0, frame_ = 0;
  std::map<std::size_t, Slot> slots_;
};

}  // namespace tet4d::stream

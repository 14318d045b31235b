// Which pages use a vertex: the ground on which a face can be judged without holding the whole mesh.
//
// A face can only be met again by a page that uses all three of its vertices. So once the last page that uses any one
// of them has passed, the face is final, whatever the mesh was made from: no wall, time order or slab shape is assumed.
#pragma once

#include <cstdint>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/outofcore/memory_budget.h"
#include "libpreprocess/outofcore/progress.h"

namespace tet4d::topology {

// The first and last geometry page that own or refer to a vertex.
struct Reach {
  std::uint64_t first, last;
  friend bool operator==(const Reach&, const Reach&) = default;
};

class VertexReach {
 public:
  // Reads every geometry page once (phase "reach"). Memory O(runs of the file); time O(file + runs log runs). Throws
  // Error where a page is damaged. If `memory` is given, what the runs need is reserved from it: 144 bytes a run.
  VertexReach(const hypermesh::File& file, outofcore::Progress& progress, outofcore::MemoryBudget* memory = nullptr);

  // vertex: below the file's count. O(log runs).
  Reach of(std::uint64_t vertex) const;
  // The last page that uses any vertex owned by geometry page `page`; `page` itself if it owns none.
  std::uint64_t lastUseOfOwner(std::uint64_t page) const { return last_use_of_owner_[page]; }
  // The geometry page that owns a vertex. O(log pages).
  std::uint64_t ownerOf(std::uint64_t vertex) const;
  std::uint64_t firstVertexOf(std::uint64_t page) const { return first_vertex_[page]; }

 private:
  struct Event {
    std::uint64_t vertex, page;
    bool begin;
  };
  void sweep(std::vector<Event> events);

  outofcore::MemoryBudget::Reservation held_;
  std::vector<std::uint64_t> starts_;  // of maximal ranges of vertices with the same reach
  std::vector<Reach> reaches_;
  std::vector<std::uint64_t> first_vertex_, last_use_of_owner_;  // by page
};

}  // namespace tet4d::topology

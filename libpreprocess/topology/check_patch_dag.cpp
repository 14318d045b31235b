#include "libpreprocess/topology/check_patch_dag.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <utility>

#include "libpreprocess/error.h"

namespace tet4d::topology {
namespace {

constexpr std::size_t kFaultsInWords = 3;  // of each kind

// A point by its bits; the two zeros are one.
using Key = std::array<std::uint32_t, 4>;

Key keyOf(const Vec4f& v) {
  // Adding zero makes -0 the other zero.
  return {std::bit_cast<std::uint32_t>(v.x + 0.0f), std::bit_cast<std::uint32_t>(v.y + 0.0f),
          std::bit_cast<std::uint32_t>(v.z + 0.0f), std::bit_cast<std::uint32_t>(v.t + 0.0f)};
}

struct Face {
  std::array<Key, 3> corners;  // ascending
  std::int64_t turn;           // how often it is passed in that order, less how often in the other
};

using Chain = std::vector<Face>;

// The corners of the face opposite to each vertex, in induced orientation: (-1)^i (v0 .. without vi .. v3).
constexpr std::array<std::array<std::uint8_t, 3>, 4> kFaceCorners{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

Face faceOf(std::array<Key, 3> corners, std::int64_t turn) {
  const auto order = [&](std::size_t i, std::size_t j) {
    if (corners[j] < corners[i]) std::swap(corners[i], corners[j]), turn = -turn;
  };
  order(0, 1), order(1, 2), order(0, 1);
  // A triangle of two equal corners is no part of a boundary: both its ways are the same.
  if (corners[0] == corners[1] || corners[1] == corners[2]) turn = 0;
  return {corners, turn};
}

// Adds up equal faces and drops what cancels.
void reduce(Chain& chain) {
  std::sort(chain.begin(), chain.end(), [](const Face& a, const Face& b) { return a.corners < b.corners; });
  std::size_t kept = 0;
  for (std::size_t i = 0, next = 0; i < chain.size(); i = next) {
    Face sum = chain[i];
    for (next = i + 1; next < chain.size() && chain[next].corners == sum.corners; ++next) sum.turn += chain[next].turn;
    if (sum.turn != 0) chain[kept++] = sum;
  }
  chain.resize(kept);
}

class Checker {
 public:
  Checker(const patch_dag::File& file, outofcore::MemoryBudget& memory, outofcore::Progress& progress)
      : file_(file), memory_(memory), progress_(progress), below_(file.nodes().size()) {
    for (std::size_t p = 0; p < file.patches(); ++p) below_[file.toOf(p)].push_back(p);
  }

  PatchDagCheck run() {
    progress_.phase("patches", file_.nodes().size());
    const bool is_whole =
        (file_.header().flags & (patch_dag::kOnGrid | patch_dag::kInnerBoundary)) == patch_dag::kOnGrid;
    if (file_.patches() != 0) {
      const Chain boundary = boundaryOf(patchesFrom(0), {});
      check_.open_faces = boundary.size();
      if (is_whole && !boundary.empty())
        say("the coarsest cut is open away from the domain's walls, in " + std::to_string(boundary.size()) +
            " triangles");
    }
    std::map<std::size_t, Chain> changes;  // by node
    for (std::size_t node = 1; node + 1 < file_.nodes().size(); ++node) {
      ++check_.nodes;
      Chain change = boundaryOf(below_[node], patchesFrom(node));
      if (!change.empty()) changes.emplace(node, std::move(change));
      progress_.step(node);
    }
    if (!is_whole && !changes.empty()) excuseBoundary(changes);
    for (const auto& [node, change] : changes) {
      if (change.empty()) continue;
      ++check_.cracked_nodes;
      check_.crack_faces += change.size();
      if (check_.cracked_nodes <= kFaultsInWords)
        say("node " + std::to_string(node) + ": refining it tears the mesh, in " + std::to_string(change.size()) +
            " triangles");
    }
    if (check_.cracked_nodes > kFaultsInWords)
      say(std::to_string(check_.cracked_nodes) + " nodes tear the mesh in all");
    return std::move(check_);
  }

 private:
  void say(std::string fault) { check_.faults.push_back(std::move(fault)); }

  std::vector<std::size_t> patchesFrom(std::size_t node) const {
    std::vector<std::size_t> patches(file_.nodes()[node].patches);
    for (std::size_t i = 0; i < patches.size(); ++i) patches[i] = file_.nodes()[node].first_patch + i;
    return patches;
  }

  // The boundary of some patches less that of others, away from the walls.
  Chain boundaryOf(const std::vector<std::size_t>& plus, const std::vector<std::size_t>& minus) {
    std::uint64_t tets = 0;
    for (const std::size_t p : plus) tets += file_.patchEntry(p).counts[1];
    for (const std::size_t p : minus) tets += file_.patchEntry(p).counts[1];
    const auto held = memory_.reserve(tets * 4 * sizeof(Face), "triangles of a node's patches");
    Chain chain;
    chain.reserve(tets * 4);
    for (const std::size_t p : plus) addPatch(p, 1, chain);
    for (const std::size_t p : minus) addPatch(p, -1, chain);
    reduce(chain);
    std::erase_if(chain, [&](const Face& face) { return isOnWall(face); });
    chain.shrink_to_fit();
    return chain;
  }

  void addPatch(std::size_t p, std::int64_t sign, Chain& chain) const {
    const patch_dag::LoadedPatch patch = unwrap(file_.loadPatch(p));
    for (const patch_dag::LocalTet& tet : patch.view.tets) {
      std::array<Key, 4> corners;
      for (std::size_t i = 0; i < 4; ++i) corners[i] = keyOf(patch.view.vertices[tet[i]]);
      for (const auto& [a, b, c] : kFaceCorners) {
        const Face face = faceOf({corners[a], corners[b], corners[c]}, sign);
        if (face.turn != 0) chain.push_back(face);
      }
    }
  }

  bool isOnWall(const Face& face) const {
    const Bounds4f& domain = file_.header().domain;
    const Key low = keyOf(domain.min), high = keyOf(domain.max);
    for (std::size_t axis = 0; axis < 4; ++axis) {
      const auto on = [&](std::uint32_t wall) {
        return std::all_of(face.corners.begin(), face.corners.end(), [&](const Key& k) { return k[axis] == wall; });
      };
      if (on(low[axis]) || on(high[axis])) return true;
    }
    return false;
  }

  // Takes out of the changes what is boundary of the whole mesh at the level of the node or the one below.
  void excuseBoundary(std::map<std::size_t, Chain>& changes) {
    std::map<std::uint32_t, Chain> boundaries;  // of the cut that refines all above a level
    for (auto& [node, change] : changes) {
      for (const std::uint32_t level : {file_.nodes()[node].level, file_.nodes()[node].level - 1}) {
        if (boundaries.find(level) == boundaries.end()) boundaries.emplace(level, boundaryAt(level));
        const Chain& boundary = boundaries[level];
        std::erase_if(change, [&](const Face& face) {
          const auto at = std::lower_bound(boundary.begin(), boundary.end(), face,
                                           [](const Face& a, const Face& b) { return a.corners < b.corners; });
          return at != boundary.end() && at->corners == face.corners;
        });
      }
    }
  }

  Chain boundaryAt(std::uint32_t level) {
    std::vector<std::size_t> cut;
    for (std::size_t p = 0; p < file_.patches(); ++p) {
      if (file_.nodes()[file_.fromOf(p)].level > level && file_.nodes()[file_.toOf(p)].level <= level) cut.push_back(p);
    }
    return boundaryOf(cut, {});
  }

  const patch_dag::File& file_;
  outofcore::MemoryBudget& memory_;
  outofcore::Progress& progress_;
  std::vector<std::vector<std::size_t>> below_;  // by node: the patches that end in it
  PatchDagCheck check_;
};

}  // namespace

PatchDagCheck checkPatchDag(const patch_dag::File& file, outofcore::MemoryBudget& memory,
                            outofcore::Progress& progress) {
  return Checker(file, memory, progress).run();
}

}  // namespace tet4d::topology

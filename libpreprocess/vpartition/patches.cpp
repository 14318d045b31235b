#include "libpreprocess/vpartition/patches.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <unordered_map>
#include <utility>

namespace tet4d::vpartition {
namespace {

// Halves order[begin .. end) until each part is small enough, and appends the parts.
void halve(std::span<std::uint32_t> order, std::span<const Place> places, std::uint64_t most, PatchRange range,
           std::vector<PatchRange>& parts) {
  const std::uint32_t count = range.end - range.begin;
  if (count <= most) {
    parts.push_back(range);
    return;
  }
  const auto part = order.subspan(range.begin, count);
  Place low = places[part[0]], high = low;
  for (const std::uint32_t t : part) {
    for (std::size_t axis = 0; axis < 4; ++axis) {
      low[axis] = std::min(low[axis], places[t][axis]);
      high[axis] = std::max(high[axis], places[t][axis]);
    }
  }
  std::size_t axis = 0;
  for (std::size_t other = 1; other < 4; ++other)
    if (high[other] - low[other] > high[axis] - low[axis]) axis = other;
  // Equal places fall in by number, so that even tetrahedra at one point are cut.
  std::nth_element(part.begin(), part.begin() + count / 2, part.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(places[a][axis], a) < std::pair(places[b][axis], b);
  });
  const std::uint32_t middle = range.begin + count / 2;
  halve(order, places, most, {range.begin, middle, range.lower}, parts);
  halve(order, places, most, {middle, range.end, range.lower}, parts);
}

}  // namespace

std::vector<PatchRange> cutPatches(std::span<std::uint32_t> order, std::span<const std::uint32_t> left_by,
                                   std::span<const Place> places, std::uint64_t most) {
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return std::pair(left_by[a], a) < std::pair(left_by[b], b); });
  std::vector<PatchRange> parts;
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    const std::uint32_t lower = left_by[order[begin]];
    while (end < order.size() && left_by[order[end]] == lower) ++end;
    halve(order, places, most, {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end), lower}, parts);
  }
  for (const PatchRange& part : parts) std::sort(order.begin() + part.begin, order.begin() + part.end);
  return parts;
}

StoredPatch makePatch(std::span<const std::uint32_t> chosen, std::span<const hypermesh::Tet> tets,
                      std::span<const Vec4f> positions, std::span<const std::uint32_t> users) {
  StoredPatch patch;
  std::unordered_map<std::uint32_t, std::uint16_t> local;  // only looked up, never walked: its order does not show
  local.reserve(chosen.size());
  for (const bool is_shared : {true, false}) {
    for (const std::uint32_t t : chosen) {
      for (const std::uint32_t v : tets[t]) {
        if ((users[v] == kSeveral) != is_shared) continue;
        if (!local.try_emplace(v, static_cast<std::uint16_t>(patch.vertices.size())).second) continue;
        patch.vertices.push_back(positions[v]);
      }
    }
    if (is_shared) patch.shared = static_cast<std::uint32_t>(patch.vertices.size());
  }
  patch.tets.reserve(chosen.size());
  for (const std::uint32_t t : chosen) {
    patch_dag::LocalTet& tet = patch.tets.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) tet[i] = local.find(tets[t][i])->second;
  }
  return patch;
}

}  // namespace tet4d::vpartition

#include "libpreprocess/exchange/foreign_runs.h"

#include <algorithm>
#include <bit>

namespace tet4d::exchange {
namespace {

constexpr std::uint64_t kBridge = 32;  // vertices a run may hold in vain between two it needs

}  // namespace

std::vector<hypermesh::Run> nameForeign(std::vector<hypermesh::Tet>& tets, std::uint64_t owned, std::uint64_t end,
                                        std::uint64_t first_vertex) {
  const std::uint64_t foreign = end - owned, words = foreign / 64 + 1;
  std::vector<std::uint64_t> bits(words);
  for (const hypermesh::Tet& tet : tets) {
    for (const std::uint32_t i : tet)
      if (i >= owned) bits[(i - owned) / 64] |= std::uint64_t{1} << (i - owned) % 64;
  }
  std::vector<hypermesh::Run> runs;
  for (std::uint64_t w = 0; w < words; ++w) {
    for (std::uint64_t rest = bits[w]; rest != 0; rest &= rest - 1) {
      const std::uint64_t number = first_vertex + owned + w * 64 + static_cast<std::uint64_t>(std::countr_zero(rest));
      if (!runs.empty() && number - (runs.back().first + runs.back().count) <= kBridge) {
        runs.back().count = number - runs.back().first + 1;
      } else {
        runs.push_back({number, 1});
      }
    }
  }
  // Local indices: a word's own first, then by the runs' order.
  std::vector<std::uint64_t> locals(runs.size());
  for (std::size_t r = 1; r < runs.size(); ++r) locals[r] = locals[r - 1] + runs[r - 1].count;
  for (hypermesh::Tet& tet : tets) {
    for (std::uint32_t& i : tet) {
      if (i < owned) continue;
      const std::uint64_t number = first_vertex + i;
      const auto run = std::upper_bound(runs.begin(), runs.end(), number,
                                        [](std::uint64_t n, const hypermesh::Run& r) { return n < r.first; }) -
                       1;
      i = static_cast<std::uint32_t>(owned + locals[static_cast<std::size_t>(run - runs.begin())] + number -
                                     run->first);
    }
  }
  return runs;
}

}  // namespace tet4d::exchange

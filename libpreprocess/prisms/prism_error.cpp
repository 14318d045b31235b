#include "libpreprocess/prisms/prism_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "formats/core/tet_slice.h"

namespace tet4d::prisms {
namespace {

constexpr std::size_t kBlock = 4096;  // tetrahedra a task

}  // namespace

double measurePrisms(const Window& window, std::span<const hypermesh::Tet> tets, const KeptNumbers& numbers,
                     unsigned frame, const WorldLength& length, outofcore::Executor& executor) {
  const std::size_t blocks = (tets.size() + kBlock - 1) / kBlock;
  const std::uint64_t base = numbers.begin(frame);
  std::vector<double> worst(blocks, 0);
  executor.run(blocks, [&](std::size_t b) {
    for (const hypermesh::Tet& tet : tets.subspan(b * kBlock, std::min(kBlock, tets.size() - b * kBlock))) {
      // Nothing lies between a frame and the next.
      if (std::ranges::all_of(tet, [&](std::uint32_t i) { return base + i < numbers.begin(frame + 2); })) continue;
      std::array<KeptNumbers::Place, 4> place;
      for (std::size_t i = 0; i < 4; ++i) place[i] = numbers.placeOf(base + tet[i]);
      for (const auto& [i, j] : kTetEdges) {
        const bool forward = place[i].frame < place[j].frame;
        const auto& from = forward ? place[i] : place[j];
        const auto& to = forward ? place[j] : place[i];
        for (unsigned f = from.frame + 1; f < to.frame; ++f)
          worst[b] = std::max(worst[b], missSquared(window, length, from.vertex, from.frame, to.vertex, to.frame, f));
      }
    }
  });
  return blocks == 0 ? 0 : std::sqrt(*std::max_element(worst.begin(), worst.end()));
}

}  // namespace tet4d::prisms

#include "libpreprocess/prisms/prism_pages.h"

#include <algorithm>
#include <bit>

#include "libpreprocess/prisms/staircase.h"

namespace tet4d::prisms {
namespace {

constexpr std::size_t kBlock = 4096;  // triangles a task

std::array<Kept, 3> keptOf(const Triangle& t, std::span<const Kept> kept) {
  return {kept[t[0]], kept[t[1]], kept[t[2]]};
}

}  // namespace

KeptNumbers::KeptNumbers(const Window& window, std::span<const Kept> kept) {
  planes_.resize(window.steps + 1);
  begin_.assign(window.steps + 2, 0);
  const std::size_t words = kept.size() / 64 + 1;
  for (unsigned f = 0; f <= window.steps; ++f) {
    Plane& plane = planes_[f];
    plane.bits.resize(words);
    plane.prefix.resize(words);
    for (std::size_t v = 0; v < kept.size(); ++v) plane.bits[v / 64] |= (kept[v] >> f & 1) << v % 64;
    std::uint64_t count = 0;
    for (std::size_t w = 0; w < words; ++w) {
      plane.prefix[w] = count;
      count += static_cast<std::uint64_t>(std::popcount(plane.bits[w]));
    }
    begin_[f + 1] = begin_[f] + count;
  }
}

std::uint64_t KeptNumbers::numberOf(std::uint32_t vertex, unsigned frame) const {
  const Plane& plane = planes_[frame];
  const std::uint64_t below = plane.bits[vertex / 64] & ((std::uint64_t{1} << vertex % 64) - 1);
  return begin_[frame] + plane.prefix[vertex / 64] + static_cast<std::uint64_t>(std::popcount(below));
}

KeptNumbers::Place KeptNumbers::placeOf(std::uint64_t number) const {
  const auto frame = static_cast<unsigned>(std::upper_bound(begin_.begin(), begin_.end(), number) - begin_.begin() - 1);
  const Plane& plane = planes_[frame];
  const std::uint64_t rank = number - begin_[frame];
  const auto word = static_cast<std::size_t>(std::upper_bound(plane.prefix.begin(), plane.prefix.end(), rank) -
                                             plane.prefix.begin() - 1);
  std::uint64_t rest = plane.bits[word];
  for (std::uint64_t skip = rank - plane.prefix[word]; skip > 0; --skip) rest &= rest - 1;
  return {static_cast<std::uint32_t>(word * 64 + static_cast<std::size_t>(std::countr_zero(rest))), frame};
}

void KeptNumbers::appendVertices(const Window& window, unsigned frame, std::vector<Vec4f>& out) const {
  const Plane& plane = planes_[frame];
  const auto t = static_cast<float>(window.begin + frame);
  out.reserve(out.size() + count(frame));
  for (std::size_t w = 0; w < plane.bits.size(); ++w) {
    for (std::uint64_t rest = plane.bits[w]; rest != 0; rest &= rest - 1) {
      const Vec3f& p = window.frames[frame][w * 64 + static_cast<std::size_t>(std::countr_zero(rest))];
      out.push_back({p.x, p.y, p.z, t});
    }
  }
}

PrismPage prismPage(const Window& window, std::span<const Triangle> triangles, std::span<const Kept> kept,
                    const KeptNumbers& numbers, unsigned frame, outofcore::Executor& executor) {
  const std::size_t blocks = (triangles.size() + kBlock - 1) / kBlock;
  const auto blockOf = [&](std::size_t b) {
    return triangles.subspan(b * kBlock, std::min(kBlock, triangles.size() - b * kBlock));
  };
  std::vector<std::uint64_t> first(blocks + 1, 0);
  executor.run(blocks, [&](std::size_t b) {
    for (const Triangle& t : blockOf(b))
      forEachTetAt(t, keptOf(t, kept), frame, [&](const auto&, unsigned, unsigned) { ++first[b + 1]; });
  });
  for (std::size_t b = 0; b < blocks; ++b) first[b + 1] += first[b];
  PrismPage page;
  page.tets.resize(first.back());
  std::vector<Bounds4f> bounds(blocks);
  const std::uint64_t base = numbers.begin(frame);
  executor.run(blocks, [&](std::size_t b) {
    hypermesh::Tet* out = page.tets.data() + first[b];
    for (const Triangle& t : blockOf(b)) {
      forEachTetAt(t, keptOf(t, kept), frame, [&](const auto& front, unsigned corner, unsigned to) {
        const auto put = [&](std::size_t i, std::uint32_t vertex, unsigned f) {
          (*out)[i] = static_cast<std::uint32_t>(numbers.numberOf(vertex, f) - base);
          const Vec3f& p = window.frames[f][vertex];
          bounds[b].add(Vec4f{p.x, p.y, p.z, static_cast<float>(window.begin + f)});
        };
        for (std::size_t i = 0; i < 3; ++i) put(i, t[i], front[i]);
        put(3, t[corner], to);
        ++out;
      });
    }
  });
  for (const Bounds4f& box : bounds) page.bounds.add(box);
  return page;
}

}  // namespace tet4d::prisms

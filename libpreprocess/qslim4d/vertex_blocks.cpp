#include "libpreprocess/qslim4d/vertex_blocks.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <iterator>
#include <numeric>
#include <tuple>

namespace tet4d::qslim4d {
namespace {

constexpr std::size_t kGrain = 64;  // blocks begin at multiples of it
constexpr std::size_t kChunkTets = std::size_t{1} << 16, kMostChunks = 64;
// Where a sweep cuts, as a share of the blocks.
constexpr std::array<double, 4> kCuts{1.0 / 2, 1.0 / 3, 3.0 / 5, 2.0 / 5};

struct Entry {
  std::array<std::uint16_t, 4> at;  // within the mesh's box
  std::uint32_t vertex;
};

struct Node {
  std::size_t begin, end, blocks;
};

// The used vertices, their coordinates as shares of the mesh's box, and how long its sides are.
struct Places {
  std::vector<Entry> entries;
  std::array<double, 4> sides{};
};

Places placesOf(const SlimMesh& mesh) {
  Bounds4f box;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
    if (mesh.isUsed(v)) box.add(mesh.positions[v]);
  const std::array<double, 4> low{box.min.x, box.min.y, box.min.z, box.min.t};
  const std::array<double, 4> high{box.max.x, box.max.y, box.max.z, box.max.t};
  Places places;
  places.entries.reserve(mesh.live_vertices);
  std::array<double, 4> scale{};
  for (std::size_t c = 0; c < 4; ++c) {
    const double unit = c == 3 ? mesh.space.speed : glm::length(mesh.space.axes[static_cast<int>(c)]);
    places.sides[c] = (high[c] - low[c]) * unit;
    scale[c] = high[c] > low[c] ? 65535 / (high[c] - low[c]) : 0;
  }
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    if (!mesh.isUsed(v)) continue;
    const Vec4f& p = mesh.positions[v];
    const std::array<double, 4> at{p.x, p.y, p.z, p.t};
    Entry entry{{}, v};
    for (std::size_t c = 0; c < 4; ++c) entry.at[c] = static_cast<std::uint16_t>((at[c] - low[c]) * scale[c]);
    places.entries.push_back(entry);
  }
  return places;
}

std::size_t longestSide(std::span<const Entry> entries, const std::array<double, 4>& sides) {
  std::array<std::uint16_t, 4> low = entries[0].at, high = entries[0].at;
  for (const Entry& entry : entries) {
    for (std::size_t c = 0; c < 4; ++c)
      low[c] = std::min(low[c], entry.at[c]), high[c] = std::max(high[c], entry.at[c]);
  }
  std::array<double, 4> lengths{};
  for (std::size_t c = 0; c < 4; ++c) lengths[c] = (high[c] - low[c]) * sides[c];
  return static_cast<std::size_t>(std::distance(lengths.begin(), std::max_element(lengths.begin(), lengths.end())));
}

// The first of two halves; `node` becomes the second.
Node splitOff(std::span<Entry> all, Node& node, double cut, const std::array<double, 4>& sides) {
  const std::span<Entry> entries = all.subspan(node.begin, node.end - node.begin);
  const std::size_t axis = longestSide(entries, sides);
  const auto wish = static_cast<std::size_t>(std::lround(static_cast<double>(node.blocks) * cut));
  const std::size_t blocks = std::clamp<std::size_t>(wish, 1, node.blocks - 1);
  const std::size_t count = entries.size() * blocks / node.blocks / kGrain * kGrain;
  std::nth_element(entries.begin(), entries.begin() + static_cast<std::ptrdiff_t>(count), entries.end(),
                   [axis](const Entry& a, const Entry& b) {
                     return std::tie(a.at[axis], a.vertex) < std::tie(b.at[axis], b.vertex);
                   });
  const Node first{node.begin, node.begin + count, blocks};
  node = {node.begin + count, node.end, node.blocks - blocks};
  return first;
}

std::vector<Node> cutTree(Places& places, std::size_t block_vertices, double cut, outofcore::Executor& executor) {
  const std::size_t most = std::max(block_vertices, kGrain) / kGrain * kGrain;
  std::vector<Node> nodes{{0, places.entries.size(), (places.entries.size() + most - 1) / most}};
  for (bool is_done = false; !is_done;) {
    std::vector<Node> firsts(nodes.size());
    executor.run(nodes.size(), [&](std::size_t i) {
      if (nodes[i].blocks > 1) firsts[i] = splitOff(places.entries, nodes[i], cut, places.sides);
    });
    std::vector<Node> next;
    is_done = true;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      for (const Node& node : {firsts[i], nodes[i]}) {
        if (node.end == node.begin) continue;
        next.push_back(node);
        is_done &= node.blocks <= 1;
      }
    }
    nodes = std::move(next);
  }
  return nodes;
}

// Deals out the tetrahedra to the blocks, and finds what blocks share.
void dealTets(const SlimMesh& mesh, VertexBlocks& blocks, outofcore::Executor& executor) {
  std::vector<std::uint32_t> by_grain(blocks.order.size() / kGrain + 1);
  for (std::size_t b = 0; b < blocks.count(); ++b)
    for (std::size_t at = blocks.begins[b]; at < blocks.begins[b + 1]; at += kGrain)
      by_grain[at / kGrain] = static_cast<std::uint32_t>(b);
  const std::size_t chunk = std::max(kChunkTets, (mesh.tets.size() + kMostChunks - 1) / kMostChunks);
  const std::size_t chunks = (mesh.tets.size() + chunk - 1) / chunk;
  const auto inChunks = [&](const auto& visit) {
    executor.run(chunks, [&](std::size_t i) {
      for (std::size_t t = i * chunk; t < std::min(mesh.tets.size(), (i + 1) * chunk); ++t) visit(i, t);
    });
  };
  std::vector<std::uint32_t> block_of(mesh.tets.size(), kNone);  // by tetrahedron; kNone: dead, or of several
  inChunks([&](std::size_t, std::size_t t) {
    const hypermesh::Tet& tet = mesh.tets[t];
    if (tet[0] == kNone) return;
    const std::uint32_t block = by_grain[blocks.places[tet[0]] / kGrain];
    if (std::all_of(tet.begin() + 1, tet.end(),
                    [&](std::uint32_t v) { return by_grain[blocks.places[v] / kGrain] == block; })) {
      block_of[t] = block;
      return;
    }
    for (const std::uint32_t v : tet)
      std::atomic_ref(blocks.is_shared[blocks.places[v]]).store(1, std::memory_order_relaxed);
  });
  // Where each chunk's tetrahedra of each block begin.
  std::vector<std::uint32_t> begins(chunks * blocks.count());
  inChunks([&](std::size_t i, std::size_t t) {
    if (block_of[t] == kNone) return;
    const hypermesh::Tet& tet = mesh.tets[t];
    if (std::all_of(tet.begin(), tet.end(), [&](std::uint32_t v) { return blocks.is_shared[blocks.places[v]] != 0; }))
      block_of[t] = kNone;
    else
      ++begins[i * blocks.count() + block_of[t]];
  });
  std::uint32_t next = 0;
  for (std::size_t b = 0; b < blocks.count(); ++b) {
    blocks.tet_begins.push_back(next);
    for (std::size_t i = 0; i < chunks; ++i) {
      const std::uint32_t count = begins[i * blocks.count() + b];
      begins[i * blocks.count() + b] = next;
      next += count;
    }
  }
  blocks.tet_begins.push_back(next);
  blocks.tets.resize(next);
  inChunks([&](std::size_t i, std::size_t t) {
    if (block_of[t] != kNone) blocks.tets[begins[i * blocks.count() + block_of[t]]++] = static_cast<std::uint32_t>(t);
  });
}

}  // namespace

VertexBlocks cutBlocks(const SlimMesh& mesh, std::size_t block_vertices, std::size_t sweep,
                       outofcore::Executor& executor) {
  VertexBlocks blocks;
  {
    Places places = placesOf(mesh);
    blocks.order.resize(places.entries.size());
    blocks.places.assign(mesh.positions.size(), kNone);
    const std::vector<Node> nodes = places.entries.empty()
                                        ? std::vector<Node>{}
                                        : cutTree(places, block_vertices, kCuts[sweep % kCuts.size()], executor);
    for (const Node& node : nodes) blocks.begins.push_back(static_cast<std::uint32_t>(node.begin));
    blocks.begins.push_back(static_cast<std::uint32_t>(places.entries.size()));
    executor.run(nodes.size(), [&](std::size_t i) {
      const auto begin = blocks.order.begin() + static_cast<std::ptrdiff_t>(nodes[i].begin),
                 end = blocks.order.begin() + static_cast<std::ptrdiff_t>(nodes[i].end);
      for (std::size_t at = nodes[i].begin; at < nodes[i].end; ++at) blocks.order[at] = places.entries[at].vertex;
      std::sort(begin, end);
      for (std::size_t at = nodes[i].begin; at < nodes[i].end; ++at)
        blocks.places[blocks.order[at]] = static_cast<std::uint32_t>(at);
    });
  }
  blocks.is_shared.assign(blocks.order.size(), 0);
  dealTets(mesh, blocks, executor);
  return blocks;
}

std::uint64_t blockListBytes(std::uint64_t vertices, std::uint64_t tets) {
  // Places are gone before tetrahedra are dealt out.
  const std::uint64_t list = vertices * (2 * sizeof(std::uint32_t) + 1);
  return list + std::max(vertices * sizeof(Entry), tets * 2 * sizeof(std::uint32_t));
}

}  // namespace tet4d::qslim4d

// Pieces of cells against a search of their own.
#include "libpreprocess/vpartition/orphans.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <random>
#include <set>

#include "tests/formats/support/samples.h"

namespace tet4d::vpartition {
namespace {

using hypermesh::Tet;

struct Mesh {
  std::vector<Tet> tets;
  std::size_t vertices = 0;
};

// Sheets beside each other that do not touch.
Mesh sheets(std::size_t count, std::size_t cells, std::size_t slabs) {
  Mesh mesh;
  for (std::size_t i = 0; i < count; ++i) {
    const test::Sheet sheet = test::makeSheet(cells, slabs);
    const std::size_t layer = (cells + 1) * (cells + 1);
    for (std::size_t k = 0; k < slabs; ++k) {
      for (Tet tet : sheet.pages[k].tets) {
        for (std::uint32_t& v : tet) v += static_cast<std::uint32_t>(mesh.vertices + k * layer);
        mesh.tets.push_back(tet);
      }
    }
    mesh.vertices += (slabs + 1) * layer;
  }
  return mesh;
}

// For each key the number of pieces that hang together by vertices, by flooding.
std::map<std::pair<std::size_t, std::uint32_t>, std::size_t> pieces(const Mesh& mesh,
                                                                    const std::vector<std::uint32_t>& owners,
                                                                    const std::vector<std::size_t>& parts) {
  std::vector<std::vector<std::uint32_t>> stars(mesh.vertices);
  for (std::uint32_t t = 0; t < mesh.tets.size(); ++t)
    for (const std::uint32_t v : mesh.tets[t]) stars[v].push_back(t);
  std::map<std::pair<std::size_t, std::uint32_t>, std::size_t> count;
  std::vector<bool> seen(mesh.tets.size());
  for (std::uint32_t first = 0; first < mesh.tets.size(); ++first) {
    if (seen[first]) continue;
    ++count[{parts[first], owners[first]}];
    std::vector<std::uint32_t> open{first};
    seen[first] = true;
    while (!open.empty()) {
      const std::uint32_t t = open.back();
      open.pop_back();
      for (const std::uint32_t v : mesh.tets[t]) {
        for (const std::uint32_t next : stars[v]) {
          if (seen[next] || owners[next] != owners[t]) continue;
          seen[next] = true;
          open.push_back(next);
        }
      }
    }
  }
  return count;
}

TEST(Orphans, WhatACellHasOfAPartHangsTogetherWhateverTheOwnersWere) {
  const Mesh mesh = sheets(3, 5, 4);
  std::vector<std::size_t> parts(mesh.tets.size());
  for (std::size_t t = 0; t < parts.size(); ++t) parts[t] = t / (mesh.tets.size() / 3);
  std::mt19937 random(4);
  for (const std::uint32_t cells : {2U, 3U, 9U, 200U}) {
    std::vector<std::uint32_t> owners(mesh.tets.size());
    for (std::uint32_t& owner : owners) owner = static_cast<std::uint32_t>(random()) % cells;
    const std::vector<std::uint32_t> before = owners;
    std::size_t apart = 0;
    for (const auto& [key, count] : pieces(mesh, owners, parts)) apart += count - 1;
    const std::uint64_t merged = mergeOrphans(mesh.tets, mesh.vertices, owners);
    EXPECT_EQ(merged > 0, apart > 0);
    EXPECT_LE(merged, apart) << "a piece moves once, or what it waits for comes to it";
    for (const auto& [key, count] : pieces(mesh, owners, parts)) EXPECT_EQ(count, 1U) << "cell " << key.second;
    for (const std::uint32_t owner : owners) EXPECT_NE(std::find(before.begin(), before.end(), owner), before.end());
  }
}

TEST(Orphans, TheLargestPieceStaysAndThePieceGoesToWhomItTouchesMost) {
  // A row of cubes of six tetrahedra: 0 0 0 1 0 1 1 1 2 2
  const Mesh mesh = sheets(1, 10, 1);
  constexpr std::array<std::uint32_t, 10> kRow{0, 0, 0, 1, 0, 1, 1, 1, 2, 2};
  constexpr std::array<std::uint32_t, 10> kMerged{0, 0, 0, 0, 1, 1, 1, 1, 2, 2};
  std::vector<std::uint32_t> owners(mesh.tets.size());
  for (std::size_t t = 0; t < owners.size(); ++t) owners[t] = kRow[t / 6 % 10];
  // The rows of cubes lie side by side, so the pattern is one of stripes.
  EXPECT_EQ(mergeOrphans(mesh.tets, mesh.vertices, owners), 2U);
  std::size_t wrong = 0;
  for (std::size_t t = 0; t < owners.size(); ++t) wrong += owners[t] != kMerged[t / 6 % 10] ? 1 : 0;
  EXPECT_EQ(wrong, 0U);
}

TEST(Orphans, WholeCellsAndSpecksStayWhereTheyAre) {
  const Mesh mesh = sheets(40, 1, 1);
  std::vector<std::uint32_t> owners(mesh.tets.size());
  for (std::size_t t = 0; t < owners.size(); ++t) owners[t] = static_cast<std::uint32_t>(t / 6 % 7);
  const std::vector<std::uint32_t> before = owners;
  EXPECT_EQ(mergeOrphans(mesh.tets, mesh.vertices, owners), 0U) << "a speck is a part of its own";
  EXPECT_EQ(owners, before);
  EXPECT_EQ(mergeOrphans({}, 0, {}), 0U);
}

}  // namespace
}  // namespace tet4d::vpartition

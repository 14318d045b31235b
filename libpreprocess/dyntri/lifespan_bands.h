// Which band a triangle belongs to, and where in it: lifespans about as long stand together, sorted by begin.
//
// Ponchio & Hormann 2008, sec. 7.1, draw all triangles that begin before t and may live until t: of lives of very
// different lengths most are dead by then. In a band whose longest life is L those that can be alive at t begin within
// L before t, so about L / (mean life) are processed for one drawn. The bands are chosen to make the sum of triangles *
// longest over them least, among bounds that are quarter octaves of the page's time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/dynamic_triangles.h"

namespace tet4d::dyntri {

inline constexpr std::uint32_t kMostBands = 16;
inline constexpr std::uint32_t kDefaultBands = 6;

// The bands of a page, and a place for each triangle.
struct BandPlan {
  std::vector<Band> bands;
  std::vector<std::uint32_t> bucket;  // of each triangle; they stand in the order of their buckets
  std::size_t buckets = 0;
};

// Plans at most `bands` (1 .. kMostBands) bands; bands and index take at most `bytes`, but there is one band with one
// interval at least. O(triangles + bytes).
BandPlan planBands(std::span<const Lifespan> lives, const Lifespan& whole, std::uint32_t bands, std::uint64_t bytes);

// The index of triangles that stand in the order of their buckets. O(triangles + intervals).
std::vector<Alive> indexBands(std::span<const Band> bands, std::span<const Lifespan> lives, const Lifespan& whole);

}  // namespace tet4d::dyntri

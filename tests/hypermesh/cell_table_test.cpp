// The two cell tables: published counts, agreement of neighbours across every wall, closed cells, orientation.
#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <set>

#include "libpreprocess/hypermesh/hull_facets.h"
#include "libpreprocess/hypermesh/hull_table.h"
#include "libpreprocess/hypermesh/kuhn_table.h"
#include "tests/hypermesh/cell_faces.h"

namespace tet4d::hypermesh {
namespace {

using testing::facesOf;
using testing::FaceTriangle;
using testing::sortedTriangle;
using testing::wallSigns;
using testing::wallTriangles;

TEST(CellEdges, HullNumbersAreDirectionTimesEightPlusRank) {
  const CellTable& table = hullTable();
  ASSERT_EQ(table.edges.size(), 32U);
  for (unsigned e = 0; e < 32; ++e) {
    const unsigned direction = e / 8, rank = e % 8;
    const unsigned low = rank & ((1U << direction) - 1), high = rank >> direction;
    EXPECT_EQ(table.edges[e], (CellEdge{static_cast<std::uint8_t>(1U << direction),
                                        static_cast<std::uint8_t>(high << (direction + 1) | low)}));
  }
}

TEST(CellEdges, PullingRanksAreDistinct) {
  for (const CellTable* table : {&hullTable(), &kuhnTable()}) {
    std::set<int> ranks;
    for (const CellEdge edge : table->edges) ranks.insert(pullingRank(edge));
    EXPECT_EQ(ranks.size(), table->edges.size());
  }
}

TEST(HullTable, HasThePublishedCounts) {
  std::size_t facets = 0, most_facets = 0, most_points = 0;
  for (const auto& entry : allHullFacets()) {
    facets += entry.size();
    most_facets = std::max(most_facets, entry.size());
    for (const HullFacet& facet : entry)
      most_points = std::max(most_points, static_cast<std::size_t>(std::popcount(facet.edges)));
  }
  EXPECT_EQ(facets, 484'928U);
  EXPECT_EQ(most_facets, 17U);
  EXPECT_EQ(most_points, 12U);
  EXPECT_EQ(hullTable().tets.size(), 847'760U);
  EXPECT_EQ(hullTable().max_tets, 24U);
}

TEST(HullTable, EmbeddedBytesAreTheGenerators) {
  const std::vector<std::uint8_t> bytes = serializeHullTable();
  const CellTable& table = hullTable();
  ASSERT_EQ(bytes.size(), table.offsets.size_bytes() + table.tets.size_bytes());
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(table.offsets.size_bytes()),
                         reinterpret_cast<const std::uint8_t*>(table.offsets.data())));
  EXPECT_TRUE(std::equal(bytes.end() - static_cast<std::ptrdiff_t>(table.tets.size_bytes()), bytes.end(),
                         reinterpret_cast<const std::uint8_t*>(table.tets.data())));
}

TEST(HullTable, SymmetricImagesEqualDirectComputation) {
  const auto all = allHullFacets();
  for (unsigned c = 1; c < kConfigurations; c += 331) ASSERT_EQ(all[c], hullFacets(c)) << "configuration " << c;
}

TEST(KuhnTable, HasThePublishedCounts) {
  EXPECT_EQ(kuhnTable().edges.size(), 65U);
  EXPECT_EQ(kuhnTable().tets.size(), 3'440'640U);
  EXPECT_EQ(kuhnTable().max_tets, 72U);
}

class EveryTable : public ::testing::TestWithParam<const CellTable* (*)()> {
 protected:
  const CellTable& table = *GetParam()();
};

TEST_P(EveryTable, UsesExactlyTheCutEdges) {
  for (unsigned c = 0; c < kConfigurations; ++c) {
    std::array<bool, 65> used{};
    for (const CellTet& tet : table.of(c))
      for (const std::uint8_t e : tet) used[e] = true;
    for (std::size_t e = 0; e < table.edges.size(); ++e) {
      const CellEdge edge = table.edges[e];
      const bool cut = ((c >> edge.base) ^ (c >> (edge.base | edge.direction))) & 1U;
      ASSERT_EQ(used[e], cut) << "configuration " << c << " edge " << e;
    }
  }
}

// Both sides of every wall see the same triangles, wound oppositely, and these depend on the wall's eight signs alone.
TEST_P(EveryTable, NeighboursAgreeAcrossEveryWall) {
  std::size_t mismatches = 0;
  for (unsigned axis = 0; axis < 4; ++axis) {
    std::array<std::vector<FaceTriangle>, 256> expected;
    std::array<bool, 256> known{};
    for (unsigned c = 0; c < kConfigurations; ++c) {
      for (unsigned side = 0; side < 2; ++side) {
        std::vector<FaceTriangle> triangles = wallTriangles(table, c, axis, side);
        if (side == 1) {
          for (FaceTriangle& triangle : triangles) triangle.odd = !triangle.odd;
          std::sort(triangles.begin(), triangles.end());
        }
        const unsigned signs = wallSigns(c, axis, side);
        if (!known[signs]) known[signs] = true, expected[signs] = triangles;
        mismatches += triangles != expected[signs];
      }
    }
  }
  EXPECT_EQ(mismatches, 0U);
}

// Inside a cell every triangle that is not in a wall lies in exactly two tetrahedra, wound oppositely.
TEST_P(EveryTable, CellsAreClosedUpToTheirWalls) {
  for (unsigned c = 0; c < kConfigurations; ++c) {
    std::vector<FaceTriangle> faces;
    for (const CellTet& tet : table.of(c))
      for (const auto& face : facesOf(tet)) faces.push_back(sortedTriangle({face[0], face[1], face[2]}, false));
    std::sort(faces.begin(), faces.end());
    for (std::size_t i = 0; i < faces.size();) {
      if (i + 1 < faces.size() && faces[i].edges == faces[i + 1].edges) {
        ASSERT_NE(faces[i].odd, faces[i + 1].odd) << "configuration " << c;
        ASSERT_TRUE(i + 2 == faces.size() || faces[i + 2].edges != faces[i].edges) << "configuration " << c;
        i += 2;
        continue;
      }
      bool in_wall = false;
      for (unsigned axis = 0; axis < 4; ++axis)
        for (const int side : {0, 2})
          in_wall |= std::all_of(faces[i].edges.begin(), faces[i].edges.end(), [&](int e) {
            return doubledMidpoint(table.edges[static_cast<std::size_t>(e)])[axis] == side;
          });
      ASSERT_TRUE(in_wall) << "configuration " << c;
      ++i;
    }
  }
}

// No tetrahedron is flat, and no inside corner lies beyond its hyperplane (the hull's facets; the simplices' own
// corners).
TEST_P(EveryTable, TetrahedraAreNotFlat) {
  for (unsigned c = 0; c < kConfigurations; ++c) {
    for (const CellTet& tet : table.of(c)) {
      const auto a = doubledMidpoint(table.edges[tet[0]]);
      std::array<std::array<int, 4>, 4> rows{};
      for (std::size_t k = 1; k < 4; ++k)
        for (std::size_t i = 0; i < 4; ++i) rows[k][i] = doubledMidpoint(table.edges[tet[k]])[i] - a[i];
      int length2 = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        rows[0] = {};
        rows[0][i] = 1;
        length2 += determinant4(rows) * determinant4(rows);
      }
      ASSERT_GT(length2, 0) << "configuration " << c;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Splits, EveryTable,
                         ::testing::Values(
                             +[] { return &hullTable(); }, +[] { return &kuhnTable(); }),
                         [](const auto& split) { return split.index == 0 ? "Hull" : "Kuhn"; });

TEST(HullTable, OrientationPointsAwayFromTheInsideCorners) {
  for (unsigned c = 0; c < kConfigurations; ++c) {
    for (const CellTet& tet : hullTable().of(c)) {
      const auto a = doubledMidpoint(hullTable().edges[tet[0]]);
      std::array<std::array<int, 4>, 4> rows{};
      for (std::size_t k = 1; k < 4; ++k)
        for (std::size_t i = 0; i < 4; ++i) rows[k][i] = doubledMidpoint(hullTable().edges[tet[k]])[i] - a[i];
      for (std::uint8_t corner = 0; corner < 16; ++corner) {
        if (!(c >> corner & 1U)) continue;
        for (std::size_t i = 0; i < 4; ++i) rows[0][i] = doubledMidpoint({0, corner})[i] - a[i];
        ASSERT_LT(determinant4(rows), 0) << "configuration " << c << " corner " << int{corner};
      }
    }
  }
}

// What is left in a frame's wall is a 3D hull table: the slice at a frame's time.
TEST(HullTable, RestrictsToTheThreeDimensionalTable) {
  std::size_t triangles = 0, most = 0;
  for (unsigned signs = 0; signs < 256; ++signs) {
    const std::size_t count = wallTriangles(hullTable(), signs, 3, 0).size();
    triangles += count, most = std::max(most, count);
  }
  EXPECT_EQ(triangles, 836U);
  EXPECT_EQ(most, 6U);
}

}  // namespace
}  // namespace tet4d::hypermesh

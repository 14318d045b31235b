// Corners of STL, binary and text. OpenMesh welds corners within a file and drops facets that are degenerate in it;
// either would tear a sequence apart, so STL is read here alone.
#include <cmath>
#include <cstring>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/surface_scan.h"

namespace tet4d::exchange {
namespace {

constexpr std::size_t kHeaderBytes = 84, kFacetBytes = 50, kNormalBytes = 12;
constexpr std::uint64_t kMostFacets = (std::uint64_t{1} << 32) / 3;

void addFacets(PolygonMesh& mesh, const std::string& path) {
  if (mesh.points.empty()) throw Error(FaultCode::kBadInput, path, "", "the file has no facets", "make it again");
  if (mesh.points.size() / 3 > kMostFacets)
    throw Error(FaultCode::kBadInput, path, "", "has more corners than 2^32", "cut the mesh into parts");
  for (std::uint32_t i = 0; i < mesh.points.size(); ++i) {
    mesh.corners.push_back(i);
    if (i % 3 == 2) mesh.ends.push_back(i + std::uint64_t{1});
  }
}

PolygonMesh scanBinary(std::string_view bytes, const std::string& path) {
  PolygonMesh mesh;
  mesh.points.reserve((bytes.size() - kHeaderBytes) / kFacetBytes * 3);
  for (std::size_t at = kHeaderBytes; at < bytes.size(); at += kFacetBytes) {
    std::array<float, 9> corners;
    std::memcpy(corners.data(), bytes.data() + at + kNormalBytes, sizeof corners);
    for (std::size_t c = 0; c < 9; c += 3) {
      const std::array<double, 3> p{corners[c], corners[c + 1], corners[c + 2]};
      if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) {
        throw Error(FaultCode::kBadInput, path,
                    "facet " + std::to_string(mesh.points.size() / 3) + ", byte " + std::to_string(at),
                    "a coordinate is not finite", "make the file again");
      }
      mesh.points.push_back(p);
    }
  }
  return mesh;
}

PolygonMesh scanText(std::string_view text, const std::string& path) {
  PolygonMesh mesh;
  TextLines lines(text, path);
  std::uint64_t in_facet = 0;
  bool ended = false;
  while (lines.next()) {
    const std::string_view key = lines.word();
    if (key == "vertex") {
      const double x = lines.real("x"), y = lines.real("y"), z = lines.real("z");
      mesh.points.push_back({x, y, z});
      ++in_facet;
    } else if (key == "endloop") {
      if (in_facet != 3) lines.fail("the facet has " + std::to_string(in_facet) + " corners, expected 3");
      in_facet = 0;
    } else if (key == "endsolid") {
      ended = true;
    }
  }
  if (in_facet != 0 || !ended) lines.fail("the file ends before \"endsolid\"");
  return mesh;
}

}  // namespace

PolygonMesh scanStl(std::string_view bytes, const std::string& path) {
  std::uint32_t facets = 0;
  if (bytes.size() >= kHeaderBytes) std::memcpy(&facets, bytes.data() + 80, sizeof facets);
  // A binary file may begin with "solid" too, so its size decides.
  const bool is_binary = bytes.size() >= kHeaderBytes && bytes.size() == kHeaderBytes + facets * kFacetBytes;
  if (!is_binary && !bytes.starts_with("solid")) {
    throw Error(FaultCode::kBadInput, path, "header",
                "is neither text (\"solid\") nor binary: " + std::to_string(bytes.size()) + " bytes for " +
                    std::to_string(facets) + " facets",
                "make the file again");
  }
  PolygonMesh mesh = is_binary ? scanBinary(bytes, path) : scanText(bytes, path);
  addFacets(mesh, path);
  return mesh;
}

}  // namespace tet4d::exchange

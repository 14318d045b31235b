// One file of a surface: OBJ, OFF, PLY or STL, as it stands there. `surface_source.h` makes sequences of these.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tet4d::exchange {

// Vertices and faces in the file's order, no vertex merged, no face changed. STL has no connectivity: every corner is a
// vertex of its own.
struct PolygonMesh {
  std::vector<std::array<double, 3>> points;  // finite, as the file writes them
  std::vector<std::uint32_t> corners;         // vertices of all faces, one face behind the other, all in range
  std::vector<std::uint64_t> ends;            // ends[f]: where face f ends in `corners`; at least three corners each
  std::span<const std::uint32_t> face(std::size_t f) const {
    const std::uint64_t begin = f == 0 ? 0 : ends[f - 1];
    return std::span(corners).subspan(begin, ends[f] - begin);
  }
};

// A face for messages: "0 4 2", cut behind eight corners; "no corners".
std::string faceText(std::span<const std::uint32_t> face);

// "OBJ", "OFF", "PLY", "STL" by a file's suffix, or empty. No file is opened.
std::string surfaceFormatOf(const std::string& path);

// Reads a file whole. Coordinates come from our own scan of the file, in double, so that nothing is lost far from the
// origin; faces of OBJ, OFF and PLY come from OpenMesh and must be those the scan has seen, one by one. Throws Error:
// kBadInput naming the line, vertex or face (a coordinate that is no finite number, a corner out of range, a face that
// has a vertex twice, a count beyond the file, a face that OpenMesh left out or changed), kNotBuilt for faces of those
// three without OpenMesh. Memory: the file and a small multiple of it.
PolygonMesh readSurfaceFile(const std::string& path);

}  // namespace tet4d::exchange
